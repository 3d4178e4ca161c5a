#!/usr/bin/env bash
# Installs the files of the ROS package with colcon, around a program that is already built, and uses the workspace.
# Usage: run_colcon_test.sh BYRE       Exit code 77: skipped, because colcon is missing
set -euo pipefail

byre=${1:?usage: run_colcon_test.sh BYRE}
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
command -v colcon >/dev/null || { echo "Skipped: no colcon on this system"; exit 77; }
grep -q "ros.cmake" <(colcon --log-base /dev/null list --base-paths "$source_dir" 2>/dev/null) || { echo "Skipped: no colcon-ros on this system"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() { echo "run_colcon_test.sh: $1" >&2; exit 1; }

package=$work/src/byre
mkdir -p "$package"
cp -r "$source_dir/package.xml" "$source_dir/colcon.pkg" "$source_dir/cmake" "$source_dir/ros2" "$package"
cat >"$package/CMakeLists.txt" <<CMAKE
cmake_minimum_required(VERSION 3.22)
project(byre LANGUAGES NONE)
list(APPEND CMAKE_MODULE_PATH \${CMAKE_CURRENT_SOURCE_DIR}/cmake)
include(GNUInstallDirs)
include(ByreInstall)
byre_install_ros_package()
install(PROGRAMS $byre DESTINATION bin)
CMAKE
cd "$work"
# An environment of ROS would hide missing hooks.
unset AMENT_PREFIX_PATH COLCON_PREFIX_PATH CMAKE_PREFIX_PATH
colcon build >build.log 2>&1 || { cat build.log log/latest_build/byre/*.log; exit 1; }

set +u # scripts of colcon use unset variables
# shellcheck disable=SC1091
source install/setup.bash
set -u
[[ :${AMENT_PREFIX_PATH:-}: == *:$work/install/byre:* ]] || fail "AMENT_PREFIX_PATH is ${AMENT_PREFIX_PATH:-unset}"
prefix=$work/install/byre
[[ -f $prefix/share/ament_index/resource_index/packages/byre ]] || fail "missing in the index of ROS packages"
"$prefix/lib/byre/node" --print-config >/dev/null || fail "lib/byre/node does not run the program"
[[ -z $(find "$prefix" -name '*.pyc' -o -name node.sh) ]] || fail "files that do not belong there"
if /usr/bin/python3 -c "import ament_index_python" 2>/dev/null; then
  found=$(/usr/bin/python3 -c "
from ament_index_python.packages import get_package_share_directory
print(get_package_share_directory('byre'))")
  [[ $found == "$prefix/share/byre" ]] || fail "the index has byre at $found"
fi
echo "colcon installs the ROS package"
