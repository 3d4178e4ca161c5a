#!/usr/bin/env bash
# Installs missing dependencies, configures a preset of CMakePresets.json and builds it.
# Usage: build.sh [PRESET [TARGET...]]       default: release, all targets; demo: the program without tests;
#                                            installs fewer packages, none of ROS 2
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
shift || true
if [[ $preset == demo ]]; then
  scripts/install-dependencies.sh demo
else
  scripts/install-dependencies.sh
fi
cmake --preset "$preset"
cmake --build --preset "$preset" ${1:+--target "$@"}
