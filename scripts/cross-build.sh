#!/usr/bin/env bash
# Cross-compiles program, libraries and unit tests for 64-bit ARM on another Debian architecture, and runs the tests in
# QEMU with --test. Dependencies are unpacked once from Debian packages into build/sysroot-aarch64 (1.3 GB), or into the
# folder in the environment variable BYRE_SYSROOT.
# Usage: cross-build.sh [--test | --processor]
#   --test        runs the unit tests of all rooms except the slowest (see the preset aarch64)
#   --processor   builds only the unit tests of rooms with processor-specific code and of the rooms they depend on, for
#                 scripts/test.sh --arm64, which runs them
# Exit code 77: a download is needed, and Debian's mirror is unreachable.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

test=false
preset=aarch64
case ${1:-} in
  "") ;;
  --test) test=true ;;
  --processor) preset=aarch64_tests ;;
  *) echo "usage: cross-build.sh [--test | --processor]" >&2; exit 2 ;;
esac

tools=(g++-aarch64-linux-gnu mmdebstrap qemu-user-static)
# The linked packages of scripts/install-dependencies.sh. libblas-dev and liblapack-dev are explicit, because otherwise
# ATLAS is selected, which SuiteSparse is not built for.
packages=(
  libc6-dev libstdc++-12-dev libblas-dev liblapack-dev
  libeigen3-dev libopencv-dev libceres-dev libfmt-dev libyaml-cpp-dev nlohmann-json3-dev libxxhash-dev libhwy-dev
  libtinyxml2-dev libdeflate-dev libjpeg-dev libembree-dev libboost-dev libsqlite3-dev libzstd-dev liblz4-dev libbz2-dev zlib1g-dev
  libcli11-dev cyclonedds-dev libsystemd-dev libmosquitto-dev libapriltag-dev libpq-dev libgtest-dev libgmock-dev
)
export BYRE_SYSROOT=${BYRE_SYSROOT:-$PWD/build/sysroot-aarch64}

mirror=http://deb.debian.org/debian
release=$(. /etc/os-release && echo "$VERSION_CODENAME")

missing=()
for tool in "${tools[@]}"; do
  [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$tool" 2>/dev/null) == installed ]] || missing+=("$tool")
done
if ((${#missing[@]})) || [[ ! -e $BYRE_SYSROOT/complete ]]; then
  reached=$(mktemp)
  /usr/lib/apt/apt-helper -o Acquire::Retries=1 -o Acquire::http::Timeout=20 \
    download-file "$mirror/dists/$release/Release" "$reached" >/dev/null 2>&1 || {
    rm -f "$reached"
    echo "cross-build.sh: $mirror is unreachable, packages for arm64 cannot be downloaded" >&2
    exit 77
  }
  rm -f "$reached"
fi
scripts/install-dependencies.sh
if ((${#missing[@]})); then
  as_root=()
  ((EUID == 0)) || as_root=(sudo)
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --quiet --yes --no-install-recommends "${missing[@]}"
fi

if [[ ! -e $BYRE_SYSROOT/complete ]]; then
  echo "Unpacking Debian packages for arm64 into $BYRE_SYSROOT"
  rm -rf "$BYRE_SYSROOT"
  mkdir -p "$(dirname "$BYRE_SYSROOT")"
  mmdebstrap --quiet --variant=extract --architectures=arm64 --include="$(IFS=,; echo "${packages[*]}")" \
    "$release" "$BYRE_SYSROOT" "$mirror"
  libraries=$BYRE_SYSROOT/usr/lib/aarch64-linux-gnu
  for name in blas lapack; do # links that an installation would create
    ln -sf "$name/lib$name.so" "$libraries/lib$name.so"
    ln -sf "$name/lib$name.so.3" "$libraries/lib$name.so.3"
  done
  # Ceres refers to the dependencies of its static library by their installed paths.
  sed -i "s#;/usr/lib/aarch64-linux-gnu/#;$libraries/#g" "$libraries/cmake/Ceres/CeresTargets.cmake"
  touch "$BYRE_SYSROOT/complete"
fi

cmake --preset "$preset"
cmake --build --preset "$preset"
! $test || ctest --preset aarch64 --parallel "$(nproc)"
