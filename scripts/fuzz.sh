#!/usr/bin/env bash
# Fuzzes the reading of map files, and of bags and their messages, under the address and undefined-behaviour sanitizers,
# which needs Clang.
# Usage: fuzz.sh [SECONDS]        of each, 30 unless given; inputs that reach new code are kept in build/fuzz/corpus
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-30}
[[ $seconds =~ ^[0-9]+$ ]] || { echo "usage: fuzz.sh [SECONDS]" >&2; exit 2; }
clang=$(command -v clang++-16 || command -v clang++) || { echo "fuzz.sh: Clang is not installed" >&2; exit 1; }

cmake -S fuzz -B build/fuzz -G Ninja -DCMAKE_CXX_COMPILER="$clang" -DCMAKE_BUILD_TYPE=None >/dev/null
cmake --build build/fuzz
# The sanitizers cannot start where the kernel spreads addresses wider than they expect.
runner=()
! setarch --addr-no-randomize true 2>/dev/null || runner=(setarch --addr-no-randomize)

# Runs a fuzzer, with so many megabytes in one piece allowed: what a chunk of a bag may claim to hold is far more than a
# map.
fuzz() {
  mkdir -p "build/fuzz/corpus/$1"
  "${runner[@]}" "build/fuzz/$1" "build/fuzz/corpus/$1" -max_total_time="$seconds" -max_len=20000 -timeout=5 \
    -malloc_limit_mb="$2" -rss_limit_mb=2048 -artifact_prefix=build/fuzz/ -print_final_stats=1
}
# Side by side, and each tells what it found when both are done.
fuzz map_file_fuzzer 16 >build/fuzz/map_file.log 2>&1 &
maps=$!
failed=0
fuzz bag_fuzzer 512 >build/fuzz/bag.log 2>&1 || failed=1
wait "$maps" || failed=1
cat build/fuzz/map_file.log build/fuzz/bag.log
exit "$failed"
