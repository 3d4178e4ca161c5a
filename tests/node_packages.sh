# Sourced by tests that run in Node: skips them when it is missing, and installs their packages.

skip() {
  echo "Skipped: $1"
  exit 77
}

# fetch_packages SOURCE FOLDER PACKAGE: copies the test's files from SOURCE to FOLDER, installs their packages there and
# changes to it. npm installs packages next to the files that use them, so not in the source tree. PACKAGE is named in
# the skip message.
fetch_packages() {
  command -v node >/dev/null || skip "Node is not installed"
  command -v npm >/dev/null || skip "npm is not installed"
  mkdir -p "$2"
  cp "$1"/*.mjs "$1"/package.json "$1"/package-lock.json "$2"
  cd "$2"
  cmp -s package-lock.json node_modules/installed-lock.json && return
  npm ci --no-audit --no-fund --fetch-retries=1 >npm.log 2>&1 || skip "npm cannot fetch $3, see $2/npm.log"
  cp package-lock.json node_modules/installed-lock.json
}
