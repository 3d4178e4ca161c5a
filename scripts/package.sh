#!/usr/bin/env bash
# Makes Debian packages of byre in build/packages: the program, its data, the shared library, what programs are built
# with, and the package for Python.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build.sh release byre_packaged
rm -rf build/packages
cpack --config build/release/CPackConfig.cmake -B build/packages >build/packages.log || { cat build/packages.log; exit 1; }
rm -rf build/packages/_CPack_Packages
for package in build/packages/*.deb; do
  printf '%s  %s KB\n' "$package" "$(($(stat --format=%s "$package") / 1024))"
done
