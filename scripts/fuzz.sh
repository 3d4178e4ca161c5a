#!/usr/bin/env bash
# Fuzzes the readers of map files, bags, messages, URDF, tags and sites with address and undefined-behaviour sanitizers, on the
# objects of the preset dev. Needs Clang.
# Usage: fuzz.sh [SECONDS]        per fuzzer, 30 by default; inputs with new coverage are stored in build/fuzz/corpus
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-30}
[[ $seconds =~ ^[0-9]+$ ]] || { echo "usage: fuzz.sh [SECONDS]" >&2; exit 2; }
scripts/build.sh dev byre_fuzzers
mkdir -p build/fuzz
# Sanitizers fail to start if the kernel randomises addresses beyond their expected range.
runner=()
! setarch --addr-no-randomize true 2>/dev/null || runner=(setarch --addr-no-randomize)

# Runs a fuzzer. Second argument: limit of one allocation in megabytes; a chunk of a bag may claim far more than a map.
fuzz() {
  mkdir -p "build/fuzz/corpus/$1"
  "${runner[@]}" "build/dev/fuzz/$1" "build/fuzz/corpus/$1" -max_total_time="$seconds" -max_len=20000 -timeout=5 \
    -malloc_limit_mb="$2" -rss_limit_mb=2048 -artifact_prefix=build/fuzz/ -print_final_stats=1
}
# All run in parallel; their reports are printed at the end.
fuzz map_file_fuzzer 16 >build/fuzz/map_file.log 2>&1 &
maps=$!
fuzz urdf_fuzzer 16 >build/fuzz/urdf.log 2>&1 &
urdfs=$!
fuzz tag_file_fuzzer 16 >build/fuzz/tag_file.log 2>&1 &
tags=$!
fuzz site_file_fuzzer 16 >build/fuzz/site_file.log 2>&1 &
sites=$!
failed=0
fuzz bag_fuzzer 512 >build/fuzz/bag.log 2>&1 || failed=1
wait "$maps" || failed=1
wait "$urdfs" || failed=1
wait "$tags" || failed=1
wait "$sites" || failed=1
cat build/fuzz/map_file.log build/fuzz/bag.log build/fuzz/urdf.log build/fuzz/tag_file.log build/fuzz/site_file.log
exit "$failed"
