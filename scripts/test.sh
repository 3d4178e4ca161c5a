#!/usr/bin/env bash
# Checks everything: builds the release, runs all tests, checks the formatting, then runs the unit tests under the
# address and undefined-behaviour sanitizers and those of the threads under the thread sanitizer.
# Usage: test.sh [--quick]        --quick leaves the sanitizers out
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

quick=false
case ${1:-} in
  "") ;;
  --quick) quick=true ;;
  *) echo "usage: test.sh [--quick]" >&2; exit 2 ;;
esac

passed=0
failed=0

# The sanitizers of GCC 12 cannot start where the kernel spreads addresses wider than they expect.
runner=()
! setarch --addr-no-randomize true 2>/dev/null || runner=(setarch --addr-no-randomize)

headline() { printf '\n== %s\n' "$1"; }

# Runs the tests of a preset and adds up what ctest's closing line says.
run_tests() {
  local preset=$1 log=build/$1/tests.log closing
  "${runner[@]}" ctest --preset "$preset" --parallel "$(nproc)" | tee "$log" || true
  closing=$(grep -E 'tests? failed out of' "$log") || { echo "test.sh: no tests ran under $preset" >&2; exit 1; }
  [[ $closing =~ ([0-9]+)\ tests?\ failed\ out\ of\ ([0-9]+) ]]
  failed=$((failed + BASH_REMATCH[1]))
  passed=$((passed + BASH_REMATCH[2] - BASH_REMATCH[1]))
}

check_format() {
  local folders=()
  for folder in src tests examples benchmarks; do
    [[ ! -d $folder ]] || folders+=("$folder")
  done
  if find "${folders[@]}" \( -name '*.h' -o -name '*.cc' \) -print0 | xargs -0 clang-format --dry-run --Werror; then
    passed=$((passed + 1))
  else
    echo "Mend with: clang-format -i FILE..."
    failed=$((failed + 1))
  fi
}

headline "Release: all tests"
scripts/build.sh release
run_tests release

headline "Formatting"
check_format

if ! $quick; then
  headline "Address and undefined-behaviour sanitizers: unit tests"
  scripts/build.sh dev byre_unit_tests
  run_tests dev

  headline "Thread sanitizer: tests of the session"
  scripts/build.sh tsan byre_session_tests
  run_tests tsan
fi

printf '\n%d passed, %d failed\n' "$passed" "$failed"
((failed == 0))
