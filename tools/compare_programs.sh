#!/usr/bin/env bash
# Compares maps and trajectories of two builds of byre byte by byte, for changes that must not change results.
# Usage: compare_programs.sh OLD NEW [DATA]
#   OLD, NEW  the programs
#   DATA      folder of recordings: euroc/MH_01_easy, tum/freiburg1_desk, kitti/sequences/00, wheeled/box; those present
#             are mapped. Without it only simulated recordings are compared.
# Covers stereo, one camera and depth; mapping, extension and missions; with and without wheels; inline and paced.
# Prints a line per file that differs. Exit code: 0 equal, 1 different or failed, 2 wrong usage.
set -euo pipefail
(($# >= 2 && $# <= 3)) || { sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2; }
old=$(realpath "$1") new=$(realpath "$2") data=$(realpath "${3:-/nonexistent}" 2>/dev/null || true)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

"$old" simulate cowshed --duration 30 --rate 8 --divide 2 --motion -o "$work/day" --quiet >/dev/null
"$old" simulate cowshed --mission 2 --duration 25 --rate 8 --divide 2 --motion --imperfection good -o "$work/dusk" \
  --quiet >/dev/null

# Runs both programs with the same arguments, each in a folder of its own, and compares the files that they wrote.
compare() {
  local name=$1 program
  shift
  for program in old new; do
    mkdir -p "$work/$program"
    (cd "$work/$program" && "${!program}" "$@" --quiet >/dev/null) || { echo "$name: $program failed"; failed=1; }
  done
  (cd "$work/old" && find . -type f -newer "$work/mark" -print0 | sort -z) |
    while IFS= read -r -d '' file; do
      cmp -s "$work/old/$file" "$work/new/$file" || { echo "$name: ${file#./} differs"; touch "$work/different"; }
    done
  touch "$work/mark"
  echo "compared: $name" >&2
}
touch -d '1 hour ago' "$work/mark"

compare "stereo and wheels" map "$work/day" -o day.byre --trajectory day.txt --causal-trajectory day_causal.txt
compare "stereo, inline" map "$work/day" --no-wheels --pace inline -o inline.byre --trajectory inline.txt
compare "one camera" map "$work/day" --camera left -o left.byre --trajectory left.txt
compare "extension" map "$work/dusk" --extend day.byre --frames :80 -o extended.byre
compare "mission" run "$work/dusk" --map day.byre --trajectory dusk.txt --causal-trajectory dusk_causal.txt \
  --odometry dusk_odometry.txt --save-online dusk.byre
compare "mission of one camera, inline" run "$work/dusk" --map day.byre --camera left --pace inline \
  --causal-trajectory dusk_left.txt
compare "localisation only" run "$work/dusk" --map inline.byre --no-wheels --localise-only \
  --causal-trajectory localised.txt
if [[ -d $data/euroc/MH_01_easy ]]; then
  compare "EuRoC" map "$data/euroc/MH_01_easy" --frames :300 -o euroc.byre --trajectory euroc.txt
  compare "EuRoC, one camera" map "$data/euroc/MH_01_easy" --camera left --frames :500 --trajectory euroc_left.txt
fi
[[ ! -d $data/tum/freiburg1_desk ]] ||
  compare "depth" map "$data/tum/freiburg1_desk" --frames :200 -o desk.byre --trajectory desk.txt
[[ ! -d $data/kitti/sequences/00 ]] ||
  compare "KITTI" map "$data/kitti/sequences/00" --frames :60 --trajectory kitti.txt
[[ ! -d $data/wheeled/box ]] ||
  compare "wheels of a real robot" map "$data/wheeled/box" --wheels "$data/wheeled/box/wheel.txt" \
    --calibration "$data/wheeled/box/calibration.yaml" --pace inline -o box.byre --trajectory box.txt

[[ ! -e $work/different ]] || failed=1
((failed)) || echo "all files are equal"
exit "$failed"
