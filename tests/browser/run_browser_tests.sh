#!/usr/bin/env bash
# Shows a small recording in a headless browser and tests what the viewer's page does.
# Usage: run_browser_tests.sh BYRE RENDER_ROOM FOLDER
# FOLDER holds the packages, the recording and the screenshots. Exit code 77: skipped, for lack of a browser, Node or
# the registry of its packages.
set -euo pipefail

byre=${1:?usage: run_browser_tests.sh BYRE RENDER_ROOM FOLDER}
render_room=${2:?usage: run_browser_tests.sh BYRE RENDER_ROOM FOLDER}
folder=${3:?usage: run_browser_tests.sh BYRE RENDER_ROOM FOLDER}
source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

skip() {
  echo "Skipped: $1"
  exit 77
}

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) ||
  skip "no Chromium is installed"
command -v node >/dev/null || skip "Node is not installed"
command -v npm >/dev/null || skip "npm is not installed"

# npm puts packages beside the files that use them: not into the source tree.
mkdir -p "$folder/screenshots"
cp "$source"/*.mjs "$source"/package.json "$source"/package-lock.json "$folder"
cd "$folder"
if ! cmp -s package-lock.json node_modules/installed-lock.json; then
  npm ci --no-audit --no-fund --fetch-retries=1 >npm.log 2>&1 || skip "npm cannot fetch playwright-core, see $folder/npm.log"
  cp package-lock.json node_modules/installed-lock.json
fi

rm -rf room
"$render_room" room --frames 60 --rate 3 --laps 0.4 2>/dev/null # twenty seconds
"$byre" map room -o room.byre --quiet >/dev/null
"$byre" map room --end 12 -o part.byre --quiet >/dev/null # the rest of the way is new to it
BYRE=$byre BROWSER=$browser node --test --test-concurrency=1 viewer_test.mjs
