#!/usr/bin/env bash
# Looks for functions of Eigen that allocate or free memory and that the compiler did not inline. byre is compiled for
# AVX, Debian's Ceres is not, and Eigen aligns memory otherwise then: where the linker lets Ceres call such a function
# of byre's, Ceres frees what it never allocated. Such a file is to be compiled apart, see cmake/ByreUnity.cmake.
# Usage: check_allocations.sh BUILD        BUILD is a folder that was built, such as build/release
# Exit code: 0 none, 1 some, which are listed; 2 nothing to look at.
set -euo pipefail

functions='(conditional_)?aligned_(malloc|realloc|free|new|delete)|handmade_aligned'
functions+='|PlainObjectBase<.*>::resize|DenseStorage<'
symbols=$(find "$1" -name '*.o' -print0 | xargs -0 --no-run-if-empty nm --demangle --print-file-name --defined-only)
grep -q 'byre::' <<<"$symbols" || { echo "check_allocations.sh: no objects of byre in $1: build it first" >&2; exit 2; }
if grep -E " [WV] ([^(]* )?Eigen::(internal::)?($functions)" <<<"$symbols"; then exit 1; fi
