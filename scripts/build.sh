#!/usr/bin/env bash
# Installs what is missing, configures a preset of CMakePresets.json and builds it.
# Usage: build.sh [PRESET [TARGET...]]       release and everything unless given
# With BYRE_PRECOMPILE=ON in the environment headers are precompiled, see cmake/ByrePrecompile.cmake.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
shift || true
scripts/install-dependencies.sh
cmake --preset "$preset" -DBYRE_PRECOMPILE="${BYRE_PRECOMPILE:-OFF}"
cmake --build --preset "$preset" ${1:+--target "$@"}
