#!/usr/bin/env bash
# Builds Debian packages in build/packages: program, data, shared library, development files, and Python package.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh release byre_packaged
rm -rf build/packages
cpack --config build/release/CPackConfig.cmake -B build/packages >build/packages.log || { cat build/packages.log; exit 1; }
rm -rf build/packages/_CPack_Packages
for package in build/packages/*.deb; do
  printf '%s  %s KB\n' "$package" "$(($(stat --format=%s "$package") / 1024))"
done
