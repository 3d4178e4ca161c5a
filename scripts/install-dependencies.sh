#!/usr/bin/env bash
# Installs the dependencies for building and testing byre, on Debian 12 or systems with the same package names.
# Keeps installed packages; does nothing if none is missing. Installation needs root or sudo.
set -euo pipefail

packages=(
  # build
  g++ cmake ninja-build ccache git
  # library. OpenCV's CMake files are only in libopencv-dev, not in the packages of single modules.
  libeigen3-dev libopencv-dev libceres-dev libfmt-dev libyaml-cpp-dev nlohmann-json3-dev libxxhash-dev libhwy-dev
  libdeflate-dev libembree-dev libboost-dev
  # bags
  libsqlite3-dev libzstd-dev liblz4-dev libbz2-dev zlib1g-dev
  # program
  libcli11-dev python3
  # byre node, and its tests with an MQTT broker and another DDS, whose type generator needs Java
  cyclonedds-dev libsystemd-dev libmosquitto-dev
  mosquitto
  libfastrtps-dev libfastcdr-dev fastddsgen default-jre-headless
  # Python package
  pybind11-dev python3-dev python3-numpy python3-pytest python3-pip python3-wheel
  # Debian packages
  dpkg-dev file
  # tests, fuzzing, benchmarks, rules
  libgtest-dev libgmock-dev libbenchmark-dev valgrind clang-format zsh
  # sanitizers and fuzzing; sanitized tests take less than half the time of those by g++ 12
  clang-16 libclang-rt-16-dev
  # tests of bags written by other software
  python3-rosbag python3-sensor-msgs python3-tf2-msgs
)
# Packages for browser tests, which are skipped without them. Node may come from another source: Debian's npm conflicts with other
# Node packages.
browser_packages=(chromium)
command -v node >/dev/null || browser_packages+=(nodejs)
command -v npm >/dev/null || browser_packages+=(npm)

is_installed() {
  [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install-dependencies: not a Debian system; install packages equivalent to: ${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
missing_for_browser=()
for package in "${browser_packages[@]}"; do
  is_installed "$package" || missing_for_browser+=("$package")
done
((${#missing[@]} + ${#missing_for_browser[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || {
    echo "install-dependencies: neither root nor sudo available; missing packages:" \
      "${missing[@]}" "${missing_for_browser[@]}" >&2
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
((${#missing_for_browser[@]} == 0)) || install "${missing_for_browser[@]}" ||
  echo "install-dependencies: cannot install ${missing_for_browser[*]}: browser tests will be skipped" >&2
