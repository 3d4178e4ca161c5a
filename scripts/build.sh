#!/usr/bin/env bash
# Installs missing dependencies, configures a preset of CMakePresets.json and builds it.
# Usage: build.sh [PRESET [TARGET...]]       default: release, all targets
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
shift || true
scripts/install-dependencies.sh
cmake --preset "$preset"
cmake --build --preset "$preset" ${1:+--target "$@"}
