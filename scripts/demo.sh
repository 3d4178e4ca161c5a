#!/usr/bin/env bash
# Demonstrates byre. Without a recording: two visits to a simulated cowshed, as an HTML page (byre demo). With a
# recording: maps it, saves and inspects the map, localises frames in it, and evaluates the accuracy with ground truth.
# Usage: demo.sh [RECORDING]
# RECORDING is a folder in EuRoC or KITTI format. Results go to $BYRE_DEMO_DIR, or to ~/.cache/byre/demo.
set -euo pipefail

if (($# > 1)) || [[ ${1:-} == -* ]]; then
  echo "usage: demo.sh [RECORDING]" >&2
  exit 2
fi
recording=${1:-}
if [[ -n $recording ]]; then
  [[ -d $recording ]] || { echo "demo.sh: $recording: no such folder" >&2; exit 1; }
  recording=$(cd "$recording" && pwd)
fi
results=${BYRE_DEMO_DIR:-$HOME/.cache/byre/demo}
mkdir -p "$results"
results=$(cd "$results" && pwd)

cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/build.sh demo byre_cli
byre=build/demo/src/byre/cli/byre

if [[ -z $recording ]]; then
  rm -rf "$results/cowshed" # written only by the command below
  exec "$byre" demo --output "$results/cowshed"
fi

echo "Mapping $recording"
"$byre" map "$recording" -o "$results/map.byre" --trajectory "$results/trajectory.txt" \
  --causal-trajectory "$results/causal_trajectory.txt" --stats "$results/stats.json"

echo "Inspecting the map"
"$byre" inspect "$results/map.byre" --points "$results/points.ply" | tee "$results/map.txt"

echo "Localising every twentieth frame in the map, without tracking"
"$byre" localise "$results/map.byre" "$recording" --stride 20 --trajectory "$results/found.txt" |
  tee "$results/localisation.txt"

# Ground truth is inside a recording in EuRoC, and next to the sequences in KITTI.
has_truth=false
for truth in "$recording"/{mav0/,}state_groundtruth_estimate0/data.csv "$recording/../../poses/${recording##*/}.txt"; do
  [[ ! -f $truth ]] || has_truth=true
done
if $has_truth; then
  echo "Evaluating against ground truth"
  "$byre" evaluate --estimate "$results/trajectory.txt" --truth "$recording" --frames-of "$recording" --label final |
    tee "$results/evaluation.txt"
fi

echo
echo "Map:                                $results/map.byre"
echo "Contents of the map:                $results/map.txt"
echo "Map points, PLY file:               $results/points.ply"
echo "Localised frames:                   $results/found.txt, $results/localisation.txt"
echo "Final trajectory:                   $results/trajectory.txt"
echo "Causal trajectory:                  $results/causal_trajectory.txt"
echo "Statistics of the run:              $results/stats.json"
! $has_truth || echo "Accuracy:                           $results/evaluation.txt"
