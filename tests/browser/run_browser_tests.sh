#!/usr/bin/env bash
# Tests the viewer's page in a headless browser on a small recording.
# Usage: run_browser_tests.sh BYRE RENDER_ROOM FOLDER
# FOLDER is for packages, recording and screenshots. Exit code 77: skipped, because a browser, Node or its package
# registry is unavailable.
set -euo pipefail

byre=${1:?usage: run_browser_tests.sh BYRE RENDER_ROOM FOLDER}
render_room=${2:?usage: run_browser_tests.sh BYRE RENDER_ROOM FOLDER}
folder=${3:?usage: run_browser_tests.sh BYRE RENDER_ROOM FOLDER}
source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

source "$source/../node_packages.sh"

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) ||
  skip "no Chromium is installed"
mkdir -p "$folder/screenshots"
fetch_packages "$source" "$folder" "playwright-core and axe-core"

rm -rf room
"$render_room" room --frames 60 --rate 3 --laps 0.4 2>/dev/null # twenty seconds
"$byre" map room -o room.byre --quiet >/dev/null
"$byre" map room -o plain.byre --no-pictures --quiet >/dev/null
"$byre" map room --end 12 -o part.byre --quiet >/dev/null # the rest of the recording is outside this map
"$byre" cut room.byre --box 0 -9 -9 9 9 9 -o cut.byre >/dev/null
rm -rf barn_1 barn_2
"$byre" simulate cowshed --divide 2 --rate 8 --duration 25 -o barn_1 --quiet
"$byre" simulate cowshed --divide 2 --rate 8 --duration 5 --mission 2 -o barn_2 --quiet
"$byre" map barn_1 -o barn_1.byre --quiet >/dev/null
tests=(run_test.mjs viewer_test.mjs registration_test.mjs)

export REGISTRY_SCRIPT=$source/../../scripts/registry.sh
REGISTRY=$(mktemp -d /tmp/byre_browser.XXXXXX) # short, as a socket's name is, and open to the account of the server
export REGISTRY
chmod 711 "$REGISTRY"
started=0
settings=$("$REGISTRY_SCRIPT" "$REGISTRY") || started=$?
if ((started == 0)); then
  trap '"$REGISTRY_SCRIPT" "$REGISTRY" kill; rm -rf "$REGISTRY"' EXIT
  eval "$settings"
  "$byre" run barn_2 --map barn_1.byre --save-session all.session --quiet >/dev/null
  "$byre" update barn_1.byre all.session -o updated.byre --quiet >/dev/null
  "$byre" run barn_2 --end 4 --map barn_1.byre --save-session part.session --quiet >/dev/null
  "$byre" update barn_1.byre part.session -o updated_by_part.byre --quiet >/dev/null
  tests+=(registry_test.mjs)
else
  rm -rf "$REGISTRY"
  ((started == 77)) || exit "$started"
  echo "Skipped without PostgreSQL: tests of the registry's page"
fi
BYRE=$byre BROWSER=$browser node --test --test-concurrency=3 "${tests[@]}"
