#!/usr/bin/env bash
# Installs a built byre into a new folder and builds and runs a project that finds it there.
# Usage: run_install_test.sh BUILD_DIR
set -euo pipefail

build_dir=${1:?usage: run_install_test.sh BUILD_DIR}
consumer_source=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build_dir" --prefix "$work/prefix" >"$work/install.log" || { cat "$work/install.log"; exit 1; }
cmake -S "$consumer_source" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix"
cmake --build "$work/build"

said=$("$work/build/consumer")
echo "$said"
[[ $said == "moved by 1.000 2.000 3.000" ]]

# The installed program uses what was installed with it.
if [[ -x $work/prefix/bin/byre ]]; then
  shown=$("$work/prefix/bin/byre" vocabulary show)
  echo "$shown"
  [[ $shown == "vocabulary   $work/prefix/share/byre/default.vocabulary"* ]]
fi
