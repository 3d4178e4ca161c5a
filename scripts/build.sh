#!/usr/bin/env bash
# Installs what is missing, configures a preset of CMakePresets.json and builds it.
# Usage: build.sh [PRESET [TARGET...]]       release and everything unless given
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
shift || true
scripts/install-dependencies.sh
cmake --preset "$preset"
cmake --build --preset "$preset" ${1:+--target "$@"}
