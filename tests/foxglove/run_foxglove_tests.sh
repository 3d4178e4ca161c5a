#!/usr/bin/env bash
# Watches a run with the reference client of Foxglove's protocol, and compares the received messages with the recorded
# ones.
# Usage: run_foxglove_tests.sh BYRE RENDER_ROOM FOLDER
# FOLDER is for packages and the recording. Exit code 77: skipped, because Node or its package registry is unavailable.
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
