#!/usr/bin/env bash
# Renders the recordings of start_case_test.cc into $BYRE_BARNS, or into ~/.cache/byre/barns: 1.5 GB, half an hour on
# two cores. Complete recordings are reused.
# Usage: render_barns.sh        BYRE: path of the program (default: build/release/src/byre/cli/byre)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
byre=${BYRE:-build/release/src/byre/cli/byre}
folder=${BYRE_BARNS:-$HOME/.cache/byre/barns}

render() {
  local recording=$folder/$1
  [[ ! -e $recording/complete ]] || return 0
  echo "rendering $1"
  "$byre" simulate cowshed --rate 10 --quiet "${@:2}" -o "$recording"
  touch "$recording/complete"
}

mkdir -p "$folder"
render visit_1
render gate_open --mission 2 --motion --duration 45
render swapped_things --mission 3 --change 0.8 --motion
for size in 376x240 320x240 640x480 1280x720; do
  render "visit_1_$size" --size "$size" --motion
  render "visit_2_$size" --size "$size" --mission 2 --motion
done
