#!/usr/bin/env bash
# Tests the Debian packages in a bare Debian, in a chroot without the source tree: installs them by apt, then simulates,
# maps and runs a recording, builds C++ programs, and uses Python and the tutorials (tests/install/use_packages.sh).
# Needs root or sudo, Debian's mirror, and mmdebstrap, which it installs. Base systems are kept in
# ${XDG_CACHE_HOME:-~/.cache}/byre; all else is removed.
# Usage: test_packages.sh [--release bookworm|trixie | --build bookworm|trixie]
#   (none)      tests build/packages, made by scripts/package.sh
#   --release   tests in this release; packages of another release than this computer's are built as by --build
#   --build     builds the packages of HEAD in a chroot of this release, then tests them
# Exit code 77: skipped, because root, mmdebstrap or the mirror is unavailable.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
  echo "usage: test_packages.sh [--release bookworm|trixie | --build bookworm|trixie]" >&2
  exit 2
}
skip() { echo "Skipped: $1"; exit 77; }

own_release=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
release=$own_release
builds=false
case ${1:-} in
  "") (($# == 0)) || usage ;;
  --release | --build)
    (($# == 2)) || usage
    release=$2
    [[ $1 == --release && $release == "$own_release" ]] || builds=true
    ;;
  *) usage ;;
esac
[[ $release == bookworm || $release == trixie ]] || usage
$builds || compgen -G 'build/packages/byre_*.deb' >/dev/null || {
  echo "test_packages.sh: no packages in build/packages; make them with scripts/package.sh" >&2
  exit 1
}

cache=${XDG_CACHE_HOME:-$HOME/.cache}/byre
if ((EUID != 0)); then
  command -v sudo >/dev/null || skip "chroots need root, and there is no sudo"
  exec sudo --preserve-env=http_proxy,https_proxy XDG_CACHE_HOME="${cache%/byre}" scripts/test_packages.sh "$@"
fi
mirror=http://deb.debian.org/debian
reached=$(mktemp)
/usr/lib/apt/apt-helper -o Acquire::Retries=1 -o Acquire::http::Timeout=20 \
  download-file "$mirror/dists/$release/Release" "$reached" >/dev/null 2>&1 ||
  { rm -f "$reached"; skip "$mirror is unreachable"; }
rm -f "$reached"
command -v mmdebstrap >/dev/null || { apt-get update --quiet=2 && apt-get install --quiet=2 --yes --no-install-recommends mmdebstrap; } ||
  skip "mmdebstrap cannot be installed"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

base=$cache/$release.tar
if [[ ! -f $base ]]; then
  echo "Making a base system of $release in $base"
  mkdir -p "$cache"
  mmdebstrap --quiet --variant=apt "$release" "$work/base.tar" "deb $mirror $release main" \
    "deb $mirror $release-updates main" "deb http://deb.debian.org/debian-security $release-security main"
  mv "$work/base.tar" "$base"
fi

make_root() { # FOLDER
  mkdir "$1"
  tar --extract --file "$base" --directory "$1" --numeric-owner
  cp --dereference /etc/resolv.conf /etc/hosts "$1/etc/"
  echo force-unsafe-io >"$1/etc/dpkg/dpkg.cfg.d/unsafe-io" # faster, and the chroot is temporary
}

# Runs a command in the chroot, in its folder /test. The kernel ends its processes and mounts with it.
run_in() { # FOLDER COMMAND...
  unshare --mount --pid --fork --kill-child --mount-proc="$1/proc" \
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp TERM=dumb ${http_proxy:+http_proxy="$http_proxy"} \
    chroot "$1" sh -c 'cd /test && exec "$@"' - "${@:2}"
}

packages=build/packages
if $builds; then
  echo "Building packages of HEAD in $release"
  make_root "$work/build"
  mkdir "$work/build/test"
  git -c safe.directory="$PWD" archive HEAD | tar --extract --directory "$work/build/test"
  run_in "$work/build" scripts/install-dependencies.sh packages
  run_in "$work/build" cmake --preset demo
  run_in "$work/build" cmake --build --preset demo --target byre_packaged
  run_in "$work/build" cpack --config build/demo/CPackConfig.cmake -B /test/build/packages
  packages=$work/build/test/build/packages
fi

echo "Testing packages in $release"
make_root "$work/chroot"
mkdir -p "$work/chroot/test/packages" "$work/chroot/test/consumer" "$work/chroot/test/tools"
cp "$packages"/*.deb "$work/chroot/test/packages"
cp tests/install/CMakeLists.txt tests/install/consumer.cc "$work/chroot/test/consumer"
cp tests/install/use_packages.sh "$work/chroot/test"
cp -r docs "$work/chroot/test"
cp tools/run_tutorials.py "$work/chroot/test/tools"
run_in "$work/chroot" ./use_packages.sh
echo "The packages work in $release"
