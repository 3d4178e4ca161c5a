#!/usr/bin/env bash
# Searches for Eigen functions that allocate or free memory and were not inlined. byre is compiled for AVX, Debian's
# Ceres is not, and Eigen's allocation depends on that: if the linker lets Ceres call byre's version of such a function,
# Ceres frees memory that it did not allocate. Files with such functions must compile separately, see
# cmake/ByreUnity.cmake.
# Usage: check_allocations.sh BUILD        BUILD: build folder, such as build/release
# Exit code: 0 none; 1 some, which are listed; 2 no objects found.
set -euo pipefail

functions='(conditional_)?aligned_(malloc|realloc|free|new|delete)|handmade_aligned'
functions+='|PlainObjectBase<.*>::resize|DenseStorage<'
symbols=$(find "$1" -name '*.o' -print0 | xargs -0 --no-run-if-empty nm --demangle --print-file-name --defined-only)
grep -q 'byre::' <<<"$symbols" || { echo "check_allocations.sh: no objects of byre in $1: build byre first" >&2; exit 2; }
if grep -E " [WV] ([^(]* )?Eigen::(internal::)?($functions)" <<<"$symbols"; then exit 1; fi
