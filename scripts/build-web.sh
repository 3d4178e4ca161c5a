#!/usr/bin/env bash
# Builds the viewer's page, web/dist/index.html, from web/src. Only needed after changes, as the built page is in the
# repository. Needs Node 20.19 or newer with npm.
# Usage: build-web.sh [--check]        --check compares the page with its source, changes nothing, fails on a difference
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../web"

check=false
case ${1:-} in
  "") ;;
  --check) check=true ;;
  *) echo "usage: build-web.sh [--check]" >&2; exit 2 ;;
esac

npm ci --no-audit --no-fund
npm run check
if $check; then
  built=$(mktemp -d)
  trap 'rm -rf "$built"' EXIT
  npm run build -- --outDir "$built" --emptyOutDir
  cmp "$built/index.html" dist/index.html || {
    echo "build-web.sh: web/dist/index.html is outdated: run scripts/build-web.sh and commit it" >&2
    exit 1
  }
else
  npm run build
fi
