#!/usr/bin/env bash
# Installs a build into a new folder, and runs the code blocks of the tutorials and of the pages on floor plans with it.
# Usage: run_tutorials_test.sh BUILD_DIR
set -euo pipefail

build_dir=${1:?usage: run_tutorials_test.sh BUILD_DIR}
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build_dir" --prefix "$work/prefix" >"$work/install.log" || { cat "$work/install.log"; exit 1; }
pages=(tutorials/demo tutorials/first_map_and_mission tutorials/program_in_cpp how-to/register_floor_plan
       reference/floor_plan)
help=$("$work/prefix/bin/byre" node --help)
if [[ $help == *"Not available"* ]]; then
  echo "left out: tutorials/robot_with_ros2, as this build has no byre node"
else
  pages+=(tutorials/robot_with_ros2)
fi
if compgen -G "$work/prefix/lib/python3*/*/byre/__init__.py" >/dev/null; then
  pages+=(tutorials/program_in_python)
else
  echo "left out: tutorials/program_in_python, as this build has no Python package"
fi
help=$("$work/prefix/bin/byre" registry --help)
if [[ $help == *"Not available"* ]]; then
  echo "left out: tutorials/registry, as this build has no byre registry"
else
  pages+=(tutorials/registry)
fi
pages=("${pages[@]/#/docs/}")
cd "$source_dir"
/usr/bin/python3 tools/run_tutorials.py --prefix "$work/prefix" "${pages[@]/%/.md}"
