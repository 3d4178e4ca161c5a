#!/usr/bin/env bash
# Installs the packages of byre on a bare Debian and uses them, without the source tree. Run by
# scripts/test_packages.sh inside a chroot, in a folder with packages/, consumer/, docs/ and tools/.
set -euo pipefail
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8

fail() { echo "use_packages.sh: $1" >&2; exit 1; }
step() { echo "==== $1"; }
install() { apt-get install --quiet=2 --yes --no-install-recommends "$@" >apt.log 2>&1 || { tail -n 40 apt.log; fail "apt cannot install $*"; }; }

step "Installation"
apt-get update --quiet=2
install ./packages/*.deb
dpkg-query --show --showformat='${Package} ${Version}\n' 'byre*' 'libbyre*' 'python3-byre'

step "Program"
byre --version
shown=$(byre vocabulary show)
[[ $shown == "vocabulary   /usr/share/byre/default.vocabulary"* ]] || fail "the vocabulary is not found: $shown"
small=(--duration 10 --rate 10 --divide 2 --quiet)
byre simulate cowshed "${small[@]}" -o day_1
byre simulate cowshed --mission 2 "${small[@]}" -o day_2
byre map day_1 -o barn.byre --quiet
byre validate barn.byre
byre run day_2 --map barn.byre --trajectory day_2.txt --quiet
(($(grep -vc '^#' day_2.txt) >= 50)) || fail "fewer than 50 of 100 frames of the mission have a pose"
byre node --print-config >node.yaml || fail "byre node does not start"

step "C++ programs with the shared library: CMake and pkg-config"
install g++ cmake make pkg-config
cmake -S consumer -B consumer_cmake -DCMAKE_BUILD_TYPE=Release -DBYRE_COMPONENT=shared
cmake --build consumer_cmake
consumer_cmake/consumer >cmake.txt
[[ $(sed -n 21p cmake.txt) == "tracking, none, "* ]] || fail "the program built by CMake does not track"
# shellcheck disable=SC2046
g++ -O2 consumer/consumer.cc $(pkg-config --cflags --libs byre) -o consumer_pkg_config
./consumer_pkg_config >pkg_config.txt
cmp cmake.txt pkg_config.txt || fail "the programs built by CMake and by pkg-config give different poses"

step "C++ programs with the static libraries: examples"
mapfile -t recommended < <(dpkg-query --show --showformat='${Recommends}' libbyre-dev | tr ',' '\n' | tr -d ' ')
install "${recommended[@]}"
cmake -S /usr/share/doc/byre-doc/examples -B examples -DCMAKE_BUILD_TYPE=Release
cmake --build examples
examples/02_map_a_recording day_1 example.byre example.txt
examples/03_mission_on_a_map day_2 barn.byre | tail -n 2

step "Python"
python3 - <<'END'
import byre
recording = byre.Recording("day_1")
slam = byre.Slam.mapping(recording.calibration)
states = [str(slam.process(images).state) for images in recording]
assert "tracking" in states[-1], states
print("byre for Python", byre.__version__, len(states), "frames, the last one", states[-1])
END

step "Documentation"
[[ -s /usr/share/doc/byre/README.md && -s /usr/share/doc/byre/copyright ]] || fail "byre has no README.md or copyright"
[[ -s /usr/share/doc/byre-doc/html/index.html || -s /usr/share/doc/byre-doc/docs/index.md ]] || fail "byre-doc has no pages"
python3 tools/run_tutorials.py --installed docs/tutorials/*.md docs/how-to/register_floor_plan.md \
  docs/reference/floor_plan.md
