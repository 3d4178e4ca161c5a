# Sourced by the scripts of colcon, which define the function and the prefix.
_colcon_prepend_unique_value AMENT_PREFIX_PATH "$COLCON_CURRENT_PREFIX"
