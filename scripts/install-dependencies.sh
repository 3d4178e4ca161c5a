#!/usr/bin/env bash
# Installs what building and testing byre needs, on Debian 12 or anything with the same package names. Packages that
# are there are left alone; when all are, nothing is asked and nothing is changed. Needs root or sudo otherwise.
set -euo pipefail

packages=(
  # building
  g++ cmake ninja-build ccache git
  # the library. OpenCV's CMake files are in libopencv-dev alone, the packages of single modules lack them.
  libeigen3-dev libopencv-dev libceres-dev libyaml-cpp-dev nlohmann-json3-dev libxxhash-dev libembree-dev
  # the program
  libcli11-dev
  # tests, fuzzing, benchmarks, rules
  libgtest-dev libgmock-dev clang libbenchmark-dev clang-format python3
)

is_installed() {
  [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install-dependencies: this is no Debian system; install by hand what corresponds to: ${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
((${#missing[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || {
    echo "install-dependencies: neither root nor sudo at hand; ask an administrator for: ${missing[*]}" >&2
    exit 1
  }
  as_root=(sudo)
fi

echo "Installing: ${missing[*]}"
"${as_root[@]}" apt-get update --quiet
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install --quiet --yes --no-install-recommends "${missing[@]}"
