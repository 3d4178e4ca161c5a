#!/usr/bin/env bash
# Compiles the program, the libraries and their unit tests for 64-bit ARM, on a Debian of another kind, and with --test
# runs the unit tests by QEMU. What they are linked with is unpacked once from Debian's packages into
# build/sysroot-aarch64 (1.3 GB), or into the folder that the environment names as BYRE_SYSROOT.
# Usage: cross-build.sh [--test]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

test=false
case ${1:-} in
  "") ;;
  --test) test=true ;;
  *) echo "usage: cross-build.sh [--test]" >&2; exit 2 ;;
esac

tools=(g++-aarch64-linux-gnu mmdebstrap qemu-user-static)
# Those of scripts/install-dependencies.sh that are linked with. libblas-dev and liblapack-dev are named, as ATLAS
# would be taken otherwise, which SuiteSparse is not made for.
packages=(
  libc6-dev libstdc++-12-dev libblas-dev liblapack-dev
  libeigen3-dev libopencv-dev libceres-dev libyaml-cpp-dev nlohmann-json3-dev libxxhash-dev libhwy-dev libdeflate-dev
  libembree-dev libboost-dev libsqlite3-dev libzstd-dev liblz4-dev libbz2-dev zlib1g-dev
  libcli11-dev cyclonedds-dev libsystemd-dev libmosquitto-dev libgtest-dev libgmock-dev
)
export BYRE_SYSROOT=${BYRE_SYSROOT:-$PWD/build/sysroot-aarch64}

scripts/install-dependencies.sh
missing=()
for tool in "${tools[@]}"; do
  [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$tool" 2>/dev/null) == installed ]] || missing+=("$tool")
done
if ((${#missing[@]})); then
  as_root=()
  ((EUID == 0)) || as_root=(sudo)
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --quiet --yes --no-install-recommends "${missing[@]}"
fi

if [[ ! -e $BYRE_SYSROOT/complete ]]; then
  echo "Unpacking Debian's packages for arm64 into $BYRE_SYSROOT"
  rm -rf "$BYRE_SYSROOT"
  mkdir -p "$(dirname "$BYRE_SYSROOT")"
  release=$(. /etc/os-release && echo "$VERSION_CODENAME")
  mmdebstrap --quiet --variant=extract --architectures=arm64 --include="$(IFS=,; echo "${packages[*]}")" \
    "$release" "$BYRE_SYSROOT" http://deb.debian.org/debian
  libraries=$BYRE_SYSROOT/usr/lib/aarch64-linux-gnu
  for name in blas lapack; do # links that installing the packages would have made
    ln -sf "$name/lib$name.so" "$libraries/lib$name.so"
    ln -sf "$name/lib$name.so.3" "$libraries/lib$name.so.3"
  done
  # Ceres names what its static library is linked with by where it would lie once installed.
  sed -i "s#;/usr/lib/aarch64-linux-gnu/#;$libraries/#g" "$libraries/cmake/Ceres/CeresTargets.cmake"
  touch "$BYRE_SYSROOT/complete"
fi

cmake --preset aarch64
cmake --build --preset aarch64
! $test || ctest --preset aarch64 --parallel "$(nproc)"
