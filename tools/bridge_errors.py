#!/usr/bin/env python3
"""Prints the error of dead reckoning by wheels or gyroscope, one line per gap of a run.

Usage: bridge_errors.py STATS RECORDING
  STATS       file of byre map or byre run --stats
  RECORDING   EuRoC folder with ground truth

Errors are those of the last frame of a gap, after alignment with the truth at the last frame before it. in_95_%:
whether the error is within the 95 % bound of the covariance of the run. Needs numpy.
"""
import json
import pathlib
import sys

import numpy as np

BOUND = 12.59  # 95 % quantile of chi-squared with six degrees of freedom


def pose(position, quaternion_xyzw) -> np.ndarray:
    x, y, z, w = quaternion_xyzw
    matrix = np.eye(4)
    matrix[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                      [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                      [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    matrix[:3, 3] = position
    return matrix


def rotation_vector(matrix: np.ndarray) -> np.ndarray:
    twice = np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]])
    sine = 0.5 * np.linalg.norm(twice)
    angle = np.arctan2(sine, 0.5 * (np.trace(matrix) - 1))
    return 0.5 * twice * (angle / sine if sine > 1e-9 else 1.0)


def read_truth(recording: pathlib.Path) -> dict:
    rows = np.genfromtxt(recording / "mav0" / "state_groundtruth_estimate0" / "data.csv", delimiter=",",
                         comments="#", dtype=np.float64)
    times = np.genfromtxt(recording / "mav0" / "state_groundtruth_estimate0" / "data.csv", delimiter=",",
                          comments="#", dtype=np.int64, usecols=0)
    return {int(time): pose(row[1:4], [*row[5:8], row[4]]) for time, row in zip(times, rows)}


def is_bridged(frame) -> bool:
    return "position_m" in frame and frame["health"]["doubt"].startswith("bridged")


def gaps_of(frames):
    """Pairs of indices: last frame before a gap, last frame in it."""
    begin = None
    for i, frame in enumerate(frames):
        if is_bridged(frame):
            begin = i if begin is None else begin
        elif begin is not None:
            yield begin - 1, i - 1
            begin = None


def main(arguments) -> int:
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 1
    frames = json.loads(pathlib.Path(arguments[0]).read_text())["frames"]
    truth = read_truth(pathlib.Path(arguments[1]))
    print("from_s   to_s  way_m  off_m  off_%  off_deg  in_95_%  seen_after_s  worst_verdict")
    for before, last in gaps_of(frames):
        known = [pose(frames[i]["position_m"], frames[i]["quaternion_xyzw"]) for i in (before, last)]
        true = [truth[frames[i]["time_ns"]] for i in (before, last)]
        error = np.linalg.inv(np.linalg.inv(known[0]) @ known[1]) @ (np.linalg.inv(true[0]) @ true[1])
        path = [truth[frame["time_ns"]][:3, 3] for frame in frames[before:last + 1]]
        way = sum(np.linalg.norm(b - a) for a, b in zip(path, path[1:]))
        delta = np.concatenate([error[:3, 3], rotation_vector(error[:3, :3])])
        covariance = np.array(frames[last]["body_covariance"]).reshape(6, 6)
        inside = delta @ np.linalg.solve(covariance, delta) <= BOUND
        off = np.linalg.norm(delta[:3])
        seen = frames[last + 1]["time_s"] - frames[last]["time_s"] if last + 1 < len(frames) else float("nan")
        verdicts = [frame["health"]["verdict"] for frame in frames[before + 1:last + 1]]
        start = frames[0]["time_s"]
        print(f"{frames[before]['time_s'] - start:6.1f} {frames[last]['time_s'] - start:6.1f} {way:6.2f} {off:6.3f} "
              f"{100 * off / max(way, 1e-9):6.2f} {np.degrees(np.linalg.norm(delta[3:])):8.2f}  {'yes' if inside else 'NO':7}  "
              f"{seen:12.2f}  {verdicts[-1]}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
