#!/usr/bin/env bash
# Builds the site of docs/ in build/site, as configured in mkdocs.yml. Needs mkdocs; installs nothing, uses no network.
# Usage: docs.sh [--check]        --check fails on a broken link in the repository or a missing page of the navigation
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

check=false
options=(--quiet)
case ${1:-} in
  "") ;;
  --check) check=true; options=(--strict) ;;
  *) echo "usage: docs.sh [--check]" >&2; exit 2 ;;
esac
[[ $# -le 1 ]] || { echo "usage: docs.sh [--check]" >&2; exit 2; }

if ! command -v mkdocs >/dev/null; then
  echo "docs.sh: mkdocs is not installed: sudo apt-get install mkdocs" >&2
  exit 1
fi
if $check; then python3 tools/check_links.py; fi
mkdocs build --clean "${options[@]}"
echo "build/site/index.html"
