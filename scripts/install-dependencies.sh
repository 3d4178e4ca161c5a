#!/usr/bin/env bash
# Installs dependencies of byre, on Debian 12 and 13 or systems with the same package names. Keeps installed packages;
# does nothing if none is missing. Installation needs root or sudo.
# Usage: install-dependencies.sh [all | packages | demo]
#   all        for building and testing everything (default)
#   packages   for building the Debian packages
#   demo       for building and running the program; none of ROS 2
set -euo pipefail

scope=${1:-all}
if (($# > 1)) || [[ ! $scope =~ ^(all|packages|demo)$ ]]; then
  echo "usage: install-dependencies.sh [all | packages | demo]" >&2
  exit 2
fi

packages=(
  # build
  g++ cmake ninja-build
  # library. OpenCV's CMake files are only in libopencv-dev, not in the packages of single modules. libembree-dev is
  # Embree 3 in Debian 12, and Embree 4 in Debian 13.
  libeigen3-dev libopencv-dev libceres-dev libfmt-dev libyaml-cpp-dev nlohmann-json3-dev libxxhash-dev libhwy-dev
  libtinyxml2-dev libdeflate-dev libjpeg-dev libembree-dev libboost-dev
  # bags
  libsqlite3-dev libzstd-dev liblz4-dev libbz2-dev zlib1g-dev
  # program
  libcli11-dev python3
)
if [[ $scope != demo ]]; then
  packages+=(
    # byre node
    cyclonedds-dev libsystemd-dev libmosquitto-dev libapriltag-dev
    # byre registry, byre worker
    libpq-dev
    # Python package
    pybind11-dev python3-dev
    # Debian packages
    dpkg-dev file mkdocs
  )
fi
# Packages without which some tests are left out or skipped; installed if apt knows them.
test_packages=()
if [[ $scope == all ]]; then
  packages+=(
    ccache git
    # tests, fuzzing, benchmarks, rules
    python3-numpy python3-pytest python3-pip python3-wheel pkg-config
    libgtest-dev libgmock-dev libbenchmark-dev valgrind clang-format zsh
    # sanitizers and fuzzing; sanitized tests take less than half the time of those by g++ 12. llvm-16 adds names and
    # lines to reports.
    clang-16 libclang-rt-16-dev llvm-16 lld
  )
  test_packages+=(
    # byre node with an MQTT broker and another DDS, whose type generator needs Java
    mosquitto libfastrtps-dev libfastcdr-dev fastddsgen default-jre-headless cyclonedds-tools
    # bags written by other software
    python3-rosbag python3-sensor-msgs python3-nav-msgs python3-tf2-msgs
    # browser
    chromium
    # registry
    postgresql
  )
  # Node may come from another source: Debian's npm conflicts with other Node packages.
  command -v node >/dev/null || test_packages+=(nodejs)
  command -v npm >/dev/null || test_packages+=(npm)
fi

is_installed() {
  [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

is_known() { # to apt
  [[ $(LC_ALL=C LANGUAGE= apt-cache policy "$1") == *"Candidate: "[^\(]* ]]
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install-dependencies: not a Debian system; install packages equivalent to: ${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
missing_for_tests=()
for package in "${test_packages[@]}"; do
  is_installed "$package" || { is_known g++ && ! is_known "$package"; } || missing_for_tests+=("$package")
done
((${#missing[@]} + ${#missing_for_tests[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || {
    echo "install-dependencies: neither root nor sudo available; missing packages:" \
      "${missing[@]}" "${missing_for_tests[@]}" >&2
    ((${#missing[@]})) && exit 1 || exit 0
  }
  as_root=(sudo)
fi

install() {
  echo "Installing: $*"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --quiet --yes --no-install-recommends "$@"
}

"${as_root[@]}" apt-get update --quiet
((${#missing[@]} == 0)) || install "${missing[@]}"
for package in "${missing_for_tests[@]}"; do # one by one, as some may conflict with installed packages
  if ! is_known "$package"; then
    echo "install-dependencies: no package $package in this release: some tests are left out or skipped" >&2
  elif ! install "$package"; then
    echo "install-dependencies: cannot install $package: some tests are left out or skipped" >&2
  fi
done
