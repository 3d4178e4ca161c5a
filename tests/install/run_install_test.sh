#!/usr/bin/env bash
# Installs a build into a new folder, builds a project and the examples against it, and runs them.
# Usage: run_install_test.sh BUILD_DIR
set -euo pipefail

build_dir=${1:?usage: run_install_test.sh BUILD_DIR}
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix

fail() { echo "run_install_test.sh: $1" >&2; exit 1; }

build() { # FOLDER NAME OPTION...
  cmake -S "$1" -B "$work/$2" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$prefix" "${@:3}"
  cmake --build "$work/$2"
}

cmake --install "$build_dir" --prefix "$prefix" >"$work/install.log" || { cat "$work/install.log"; exit 1; }

for component in core shared; do
  build "$source_dir/tests/install" "$component" -DBYRE_COMPONENT="$component"
  (cd "$work" && "$component/consumer") >"$work/$component.txt"
done
cat "$work/core.txt"
[[ $(head -n 1 "$work/core.txt") == "initialising, no image" ]] || fail "a frame without images was not rejected"
[[ $(sed -n 21p "$work/core.txt") == "tracking, none, "* ]] || fail "the consumer does not track"
[[ $(tail -n 1 "$work/core.txt") == "no-such.byre" ]] || fail "an error does not name its file"
cmp "$work/core.txt" "$work/shared.txt" || fail "byre::core and byre::shared give different poses"
! ldd "$work/core/consumer" "$work/shared/consumer" | grep -E "embree|imgcodecs|videoio|boost|sqlite|lz4|zstd|bz2" ||
  fail "a consumer is linked with unused libraries"
grep -q "libbyre\.so\.0 => $prefix/" <(ldd "$work/shared/consumer") || fail "byre::shared is not the library that was installed"
"$source_dir/tests/install/check_exports.py" "$(find "$prefix" -name libbyre.so)" "$prefix/include/byre" ||
  fail "exports are wrong"

# The installed program must use the installed data.
byre=$prefix/bin/byre
[[ -x $byre ]] || { echo "no program was built: the examples are not run"; exit 0; }
shown=$("$byre" vocabulary show)
echo "$shown"
[[ $shown == "vocabulary   $prefix/share/byre/default.vocabulary"* ]]

if [[ $("$byre" node --help) != *"Not available: "* ]]; then
  [[ -f $prefix/share/ament_index/resource_index/packages/byre ]] || fail "missing in the index of ROS packages"
  [[ -f $prefix/share/byre/package.xml && -f $prefix/share/byre/ros2/launch/mission.launch.py ]] ||
    fail "missing files of the ROS package"
  ln -s "$prefix/lib/byre/node" "$work/linked_node"
  for node in "$prefix/lib/byre/node" "$work/linked_node"; do
    "$node" --check --ros-args --params-file "$prefix/share/byre/ros2/sensors/realsense_d435.yaml" \
      -p slam.task:=map -p slam.save:=made.byre || fail "$node does not run the program"
  done
fi

for package in "$prefix"/lib/python3*/dist-packages/byre; do
  [[ -d $package ]] || continue # was not built
  PYTHONPATH=${package%/byre} /usr/bin/python3 -c 'import byre; print("byre for Python", byre.__version__)'
done

build "$source_dir/examples" examples
cd "$work"
"$build_dir/tests/recordings/render_room" room --frames 60 --rate 10 --laps 0.4 2>/dev/null

examples/02_map_a_recording room room.byre room.txt
"$byre" map room --trajectory program.txt --quiet >/dev/null
cmp room.txt program.txt || fail "02_map_a_recording and the program give different poses"

examples/03_mission_on_a_map room room.byre | tee mission.log
grep -q "localised" mission.log || fail "03_mission_on_a_map did not localise in its map"
trusted=$(sed -n 's/^\([0-9]*\) of 60 frames trusted$/\1/p' mission.log)
((trusted >= 50)) || fail "only $trusted of 60 frames are trusted on the map of the same recording"

examples/01_live_stereo room | tail -n 3 | tee live.log
grep -qE "^[0-9]+ frames, [0-9]+ missed, [0-9]+ keyframes$" live.log || fail "01_live_stereo did not finish"
grep -q "tracking" live.log || fail "01_live_stereo does not track"

examples/04_own_features | tee features.log
grep -qE "^400 of 400 frames have a pose; the worst is off by [0-9]\.[0-9] mm$" features.log ||
  fail "04_own_features has an error above a centimetre"

! examples/03_mission_on_a_map room no-such.byre 2>refused.log || fail "a missing map was accepted"
grep -q "no-such.byre" refused.log || fail "the message does not name the missing map"
