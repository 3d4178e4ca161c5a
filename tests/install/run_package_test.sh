#!/usr/bin/env bash
# Builds packages, installs them into a new folder with a separate package database, uses them without the source tree,
# and removes them.
# Usage: run_package_test.sh BUILD_DIR       Exit code 77: skipped, because dpkg is missing
set -euo pipefail

build_dir=${1:?usage: run_package_test.sh BUILD_DIR}
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
for tool in dpkg dpkg-deb dpkg-shlibdeps cpack pkg-config; do
  command -v "$tool" >/dev/null || { echo "Skipped: no $tool on this system"; exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
root=$work/root
packages=$work/packages

fail() { echo "run_package_test.sh: $1" >&2; exit 1; }

# The system's packages are not in this database, and maintainer scripts run outside the folder.
dpkg_here() {
  dpkg --root="$root" --log=/dev/null --force-not-root --force-depends --force-script-chrootless "$@"
}

field() { # PACKAGE FIELD
  dpkg-deb --field "$packages/$1"_*.deb "$2"
}

require_depends() { # PACKAGE NEEDED...
  local needed depends
  depends=$(field "$1" Depends)
  for needed in "${@:2}"; do
    [[ ", $depends" == *", $needed"* ]] || fail "$1 does not depend on $needed but on: $depends"
  done
}

cpack --config "$build_dir/CPackConfig.cmake" -B "$packages" >"$work/cpack.log" 2>&1 || { cat "$work/cpack.log"; exit 1; }
names=(byre byre-data byre-doc libbyre0 libbyre-dev)
[[ ! -f $build_dir/python/byre/__init__.py ]] || names+=(python3-byre)
for name in "${names[@]}"; do
  [[ -f $(echo "$packages/$name"_*.deb) ]] || fail "missing package $name"
done
version=$(field byre Version)
require_depends byre "byre-data (= $version)" libyaml-cpp libtinyxml2 libfmt libopencv-videoio libsqlite3-0 libzstd1 liblz4-1 libbz2
require_depends libbyre0 "byre-data (= $version)" libyaml-cpp libtinyxml2 libfmt libopencv-core
[[ $(field libbyre0 Depends) != *videoio* ]] || fail "the shared library needs videos"
[[ $(field libbyre0 Depends) != *sqlite* ]] || fail "the shared library needs bags"
require_depends libbyre-dev "libbyre0 (= $version)" libeigen3-dev

mkdir -p "$root/var/lib/dpkg/updates" "$root/var/lib/dpkg/info"
touch "$root/var/lib/dpkg/status" "$root/var/lib/dpkg/available"
dpkg_here --install "$packages"/*.deb >"$work/dpkg.log" 2>&1 || { cat "$work/dpkg.log"; exit 1; }
unset BYRE_DATA BYRE_VOCABULARY
usr=$root/usr
byre=$usr/bin/byre

if [[ $("$byre" node --help) != *"Not available: "* ]]; then
  [[ -f $usr/lib/systemd/system/byre.service ]] || fail "missing service"
  [[ -f $usr/share/ament_index/resource_index/packages/byre ]] || fail "missing in the index of ROS packages"
  "$usr/lib/byre/node" --print-config >/dev/null || fail "the executable of the ROS package does not start"
  "$byre" node --print-config >/dev/null || fail "byre node does not start"
fi
if [[ $("$byre" worker --help) != *"Not available: "* ]]; then
  [[ -f $usr/lib/systemd/system/byre-worker@.service ]] || fail "missing service of workers"
  [[ -f $usr/share/byre/registry/worker.sbatch ]] || fail "missing script of workers"
fi
"$byre" --version
[[ "$("$byre" --version) " == "byre ${version%-*} " ]] || fail "the program has another version than its package, $version"
[[ $("$byre" vocabulary show) == "vocabulary   $usr/share/byre/default.vocabulary"* ]] || fail "the vocabulary is not found"
"$build_dir/tests/recordings/render_room" "$work/room" --frames 20 --rate 10 --laps 0.1 2>/dev/null
"$byre" map "$work/room" -o "$work/room.byre" --quiet >/dev/null
"$byre" validate "$work/room.byre"

pages=$usr/share/man/man1
for command in $("$byre" --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\) .*/\1/p'); do
  page=$pages/byre-$command.1.gz
  [[ -f $page ]] || fail "byre $command has no manual page"
  grep -q "^byre\\\\-${command//-/\\\\-} \\\\- " <(zcat "$page") || fail "$page has no name"
done
grep -qF '\fB\-o,\-\-output MAP\fR' <(zcat "$pages/byre-map.1.gz") || fail "byre-map(1) does not contain the option --output"
if command -v man >/dev/null; then
  shown=$(MANPATH=$usr/share/man man byre-map 2>&1 | cat)
  [[ $shown == *"byre-map - make a map and a trajectory"* ]] || fail "man does not show byre-map(1): $shown"
fi
# shellcheck disable=SC2016
completed=$(bash -c 'source "$1"; COMP_WORDS=(byre map --pac); COMP_CWORD=2; _byre; echo "${COMPREPLY[@]}"' - \
  "$usr/share/bash-completion/completions/byre")
[[ $completed == "--pace" ]] || fail "bash completes --pac as: $completed"
[[ -f $usr/share/zsh/vendor-completions/_byre ]] || fail "missing completion for zsh"

{
  cmake -S "$source_dir/tests/install" -B "$work/consumer" -G Ninja -DCMAKE_PREFIX_PATH="$usr" -DBYRE_COMPONENT=shared
  cmake --build "$work/consumer"
} >"$work/consumer.log" 2>&1 || { cat "$work/consumer.log"; exit 1; }
grep -q "libbyre\.so\.0 => $usr/" <(ldd "$work/consumer/consumer") || fail "the consumer does not use the package's library"
said=$("$work/consumer/consumer")
[[ $(sed -n 21p <<<"$said") == "tracking, none, "* ]] || fail "the consumer does not track: $said"

if [[ -d $usr/lib/python3/dist-packages/byre ]]; then
  require_depends python3-byre "byre-data (= $version)" python3-numpy "python3 (>= 3."
  PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$usr/lib/python3/dist-packages /usr/bin/python3 - "$work/room" "$root" <<'PYTHON'
import sys
import byre
assert byre.__file__.startswith(sys.argv[2]), byre.__file__
recording = byre.Recording(sys.argv[1])
slam = byre.Slam.mapping(recording.calibration)
print("byre for Python", byre.__version__, "has", [slam.process(images).state for images in recording][-1])
PYTHON
fi

flags=$(PKG_CONFIG_PATH=$usr/lib/pkgconfig pkg-config --cflags --libs byre)
[[ " $flags " == *"pkgconfig/../../include"* && " $flags " == *" -lbyre "* ]] || fail "pkg-config gives for byre: $flags"
[[ -f $usr/share/doc/byre/README.md ]] || fail "byre has no README.md"
[[ -f $usr/share/doc/byre-doc/examples/CMakeLists.txt ]] || fail "byre-doc has no examples"
for name in "${names[@]}"; do
  [[ -f $usr/share/doc/$name/copyright ]] || fail "$name has no licence"
done
dpkg_here --purge "${names[@]}" >"$work/dpkg.log" 2>&1 || { cat "$work/dpkg.log"; exit 1; }
left=$(find "$root" -mindepth 1 -path "$root/var" -prune -o -print)
[[ -z $left ]] || fail "left over after removal: $left"
echo "${#names[@]} packages of byre $version were made, used and removed"
