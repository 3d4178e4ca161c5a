#!/usr/bin/env bash
# Watches a run by the client of those who made Foxglove's protocol, and compares what it is sent with what is recorded.
# Usage: run_foxglove_tests.sh BYRE RENDER_ROOM FOLDER
# FOLDER holds the packages and the recording. Exit code 77: skipped, for lack of Node or the registry of its packages.
set -euo pipefail

byre=${1:?usage: run_foxglove_tests.sh BYRE RENDER_ROOM FOLDER}
render_room=${2:?usage: run_foxglove_tests.sh BYRE RENDER_ROOM FOLDER}
folder=${3:?usage: run_foxglove_tests.sh BYRE RENDER_ROOM FOLDER}
source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

source "$source/../node_packages.sh"
fetch_packages "$source" "$folder" @foxglove/ws-protocol

rm -rf room record.mcap
"$render_room" room --frames 30 --rate 10 --laps 0.15 2>/dev/null
BYRE=$byre node --test foxglove_test.mjs
