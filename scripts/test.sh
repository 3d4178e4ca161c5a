#!/usr/bin/env bash
# Runs the checks of continuous integration: builds the release, runs its default suite (unit tests, accuracy on whole
# recordings, every benchmark once), checks the formatting, runs unit tests of the library under address and
# undefined-behaviour sanitizers and those of folders with threads under the thread sanitizer, and fuzzes the file
# readers. Reports tests skipped for missing recordings, and the slowest tests.
# Usage: test.sh [--quick | --long | --arm64]
#   --quick   skips sanitizers and fuzzing
#   --long    also runs the tests with the label long: further seeds, calibration errors, starts and missions. The
#             default suite has at least one test for each kind of fault among them.
#   --arm64   also runs unit tests for 64-bit ARM in QEMU, of rooms with processor-specific code and the rooms they
#             depend on; the first time downloads 1.3 GB of Debian packages for arm64
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

quick=false
long=false
arm64=false
case ${1:-} in
  "") ;;
  --quick) quick=true ;;
  --long) long=true ;;
  --arm64) arm64=true ;;
  *) echo "usage: test.sh [--quick | --long | --arm64]" >&2; exit 2 ;;
esac

passed=0
failed=0
skipped=0
failures=()
failure_logs=()

# The sanitizers of GCC 12 fail to start if the kernel randomises addresses beyond their expected range.
runner=()
! setarch --addr-no-randomize true 2>/dev/null || runner=(setarch --addr-no-randomize)

headline() { printf '\n== %s\n' "$1"; }

# Duration of each part since the previous call, "<seconds> s  <part>", printed at the end.
parts=()
part_began=$SECONDS
end_part() {
  parts+=("$(printf '%5d s  %s' $((SECONDS - part_began)) "$1")")
  part_began=$SECONDS
}

# Folder of a preset's build. The preset long tests the release.
folder_of() { [[ $1 == long ]] && echo build/release || echo "build/$1"; }

# Prints the skip messages of a preset's tests, including those of tests within a program that ran others.
print_skips() {
  local output
  output=$(folder_of "$1")/Testing/Temporary/LastTest.log
  grep -A1 -E ': Skipped$' "$output" | grep -vE '^--$|: Skipped$' | sort -u | sed 's/^/Skipped: /' || true
}

# Prints the slowest tests of a preset, in seconds.
print_slowest() {
  sed -nE 's/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: ([^ ]+) .* ([0-9.]+) sec.*$/\2 s  \1/p' "$(folder_of "$1")/tests.log" |
    sort -rn | head -n 8 | sed '1s/^/Slowest: /; 2,$s/^/         /'
}

# Stores names and last output of a preset's failed tests, without passed cases, for the summary at the end.
keep_failures() {
  local preset=$1 name reason folder
  folder=$(folder_of "$preset")
  while read -r name reason; do
    failures+=("$preset: $name $reason")
    awk -v name="$name" '$2 == "Testing:" { mine = $3 == name } mine' "$folder/Testing/Temporary/LastTest.log" |
      grep -vE '^\[ +(RUN|OK) +\]' | tail -n 60 >"build/failed_${preset}_$name.log"
    failure_logs+=("build/failed_${preset}_$name.log")
  done < <(sed -nE 's/^[[:space:]]+[0-9]+ - ([^ ]+) \((.*)\)$/\1 (\2)/p' "$folder/tests.log" | grep -v '(Skipped)$')
}

# Runs the tests of a preset and sums ctest's closing lines, which count skipped tests as passed. Runs two tests more
# than there are processors, because some tests mostly wait.
run_tests() {
  local preset=$1 log closing skips
  log=$(folder_of "$preset")/tests.log
  "${runner[@]}" ctest --preset "$preset" --parallel $(($(nproc) + 2)) | tee "$log" || true
  closing=$(grep -E 'tests? failed out of' "$log") || { echo "test.sh: no tests ran under $preset" >&2; exit 1; }
  [[ $closing =~ ([0-9]+)\ tests?\ failed\ out\ of\ ([0-9]+) ]]
  failed=$((failed + BASH_REMATCH[1]))
  keep_failures "$preset"
  skips=$(grep -cE '^[[:space:]]+[0-9]+ - .* \(Skipped\)$' "$log" || true)
  passed=$((passed + BASH_REMATCH[2] - BASH_REMATCH[1] - skips))
  skipped=$((skipped + skips))
  print_skips "$preset"
  print_slowest "$preset"
}

# Builds a preset in the background, at the lowest priority, with the processor time that foreground parts leave. With
# automatic groups, Linux compares only the priorities of the groups, one for each session.
background=
begin_build() { # PRESET TARGET...
  setsid bash -c 'echo 19 >/proc/self/autogroup; exec nice -n 19 scripts/build.sh "$@"' build "$@" \
    >"build/$1.log" 2>&1 &
  background=$!
}
trap '[[ -z $background ]] || kill -- "-$background" 2>/dev/null || true' EXIT

# Waits for the build of a preset. Prints the end of its log if it failed.
end_build() { # PRESET
  local build=$background
  { renice -n 0 -g "$build" && echo 0 >"/proc/$build/autogroup"; } >/dev/null 2>&1 || true # only root may
  if wait "$build"; then background=; return; fi
  echo "test.sh: the build of $1 failed" >&2
  tail -n 60 "build/$1.log" >&2
  exit 1
}

check_format() {
  local folders=()
  for folder in include src tests examples benchmarks python; do
    [[ ! -d $folder ]] || folders+=("$folder")
  done
  if find "${folders[@]}" \( -name '*.h' -o -name '*.cc' \) -print0 |
    xargs -0 -P "$(nproc)" -n 50 clang-format --dry-run --Werror; then
    passed=$((passed + 1))
  else
    echo "Fix the formatting: clang-format -i FILE..."
    failed=$((failed + 1))
    failures+=("formatting")
  fi
}

headline "Release: default suite"
scripts/build.sh release
end_part "release: build"
$quick || begin_build dev byre_unit_tests byre_fuzzers
run_tests release
end_part "release: default suite"

if $long; then
  headline "Release: long suite"
  run_tests long
  end_part "release: long suite"
fi

headline "Formatting"
check_format
end_part "formatting"

if ! $quick; then
  headline "Address and undefined-behaviour sanitizers: unit tests of the library"
  end_build dev
  end_part "address and undefined-behaviour sanitizers: rest of the build"
  begin_build tsan
  run_tests dev
  end_part "address and undefined-behaviour sanitizers: unit tests"

  headline "Thread sanitizer: tests of folders with threads"
  end_build tsan
  end_part "thread sanitizer: rest of the build"
  run_tests tsan
  end_part "thread sanitizer: tests"

  headline "Fuzzing: map files and bags, 20 s each"
  if scripts/fuzz.sh 20 >build/fuzz.log 2>&1; then
    grep -E 'stat::number_of_executed_units' build/fuzz.log || true
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    failures+=("fuzzing")
    failure_logs+=(build/fuzz.log)
  fi
  end_part "fuzzing"
fi

test_arm64() {
  local status=0
  export BYRE_SYSROOT=${BYRE_SYSROOT:-$PWD/build/sysroot-aarch64}
  scripts/cross-build.sh --processor || status=$?
  end_part "64-bit ARM: build"
  if ((status == 77)); then
    echo "Skipped: tests for 64-bit ARM, because the Debian mirror is unreachable"
    skipped=$((skipped + 1))
  elif ((status)); then
    failed=$((failed + 1))
    failures+=("build for 64-bit ARM")
  else
    run_tests aarch64_tests
    end_part "64-bit ARM: unit tests in QEMU"
  fi
}

if $arm64; then
  headline "64-bit ARM: unit tests of rooms with processor-specific code, in QEMU"
  test_arm64
fi

for log in "${failure_logs[@]}"; do
  headline "$log"
  tail -n 60 "$log"
done
echo
printf '%s\n' "${parts[@]}"
python3 tools/product_size.py
$long || echo "Not run: tests with the label long (scripts/test.sh --long)"
$arm64 || echo "Not run: unit tests for 64-bit ARM (scripts/test.sh --arm64)"
((failed == 0)) || printf 'Failed: %s\n' "${failures[@]}"
((skipped == 0)) || echo "$skipped skipped"
echo "$passed passed, $failed failed"
((failed == 0))
