#!/usr/bin/env bash
# Records a run in an MCAP file and reads it with the reference implementation of the format.
# Usage: run_record_tests.sh BYRE RENDER_ROOM FOLDER
# FOLDER is for packages and the recording. Exit code 77: skipped, because Node or its package registry is unavailable.
set -euo pipefail

byre=${1:?usage: run_record_tests.sh BYRE RENDER_ROOM FOLDER}
render_room=${2:?usage: run_record_tests.sh BYRE RENDER_ROOM FOLDER}
folder=${3:?usage: run_record_tests.sh BYRE RENDER_ROOM FOLDER}
source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

source "$source/../node_packages.sh"
fetch_packages "$source" "$folder" @mcap/core

rm -rf room record.mcap
"$render_room" room --frames 24 --rate 10 --laps 0.15 2>/dev/null
"$byre" map room --pace inline --quiet --record record.mcap --record-images --trajectory final.txt \
  --causal-trajectory causal.txt >/dev/null
RECORD=record.mcap TRAJECTORY=causal.txt node --test record_test.mjs
"$byre" bag info record.mcap
"$byre" map record.mcap --pace inline --quiet --trajectory again.txt >/dev/null
[[ $(wc -l <again.txt) == $(wc -l <final.txt) ]] || { echo "the record gives another number of poses" >&2; exit 1; }

# The same messages, rewritten by the reference implementation, must give the same poses.
node rewrite_mcap.mjs record.mcap rewritten.mcap
"$byre" bag info rewritten.mcap
"$byre" map rewritten.mcap --pace inline --quiet --trajectory rewritten.txt >/dev/null
cmp again.txt rewritten.txt
