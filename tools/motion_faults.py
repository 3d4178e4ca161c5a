#!/usr/bin/env python3
"""Measures the effect of faulty wheels and IMUs on poses, one row per fault.

Usage: motion_faults.py RECORDING --map MAP --map-truth RECORDING [options]      missions on a map (byre run)
       motion_faults.py RECORDING --task map [options]                           mapping (byre map)

RECORDING is an EuRoC folder with ground truth, wheel.txt and mav0/imu0/data.csv, as written by
byre simulate cowshed --motion. Each fault is applied to a copy whose images are links. Columns:

  frames     frames of the run
  trusted    frames with the verdict "trusted" (missions)
  wrong      trusted frames more than 0.2 m off (missions); limit 0
  worst m    largest error of a trusted frame, and of any frame (missions)
  jump mm    largest error of an odometry step from frame to frame
  of bound   jump as a multiple of the 95 % bound of the odometry; limit 1
  RMSE mm    root mean square error of frames with a pose (missions), or ATE of the final trajectory (mapping)
  ratio      RMSE relative to a run without wheels and IMU; over frames with a pose in both runs (missions)
  warnings   number of warnings about wheels, gyroscope or accelerometer

Exit code: 0 within the limits (wrong, of bound), 1 beyond them, 2 a run failed. Needs numpy.
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

WRONG = 0.2    # metres
BOUND = 7.815  # 95 % quantile of chi-squared with three degrees of freedom
NOISE = 1e-3   # metres, of a step: rounding of truth and noise of visual odometry


def rotation(quaternion_xyzw) -> np.ndarray:
    x, y, z, w = quaternion_xyzw
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def product(a, b) -> np.ndarray:
    """Quaternion product; x, y, z, w."""
    vector = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(vector, a[3] * b[3] - a[:3] @ b[:3])


def relative(reference, pose) -> np.ndarray:
    """A wheel pose (x, y, z and quaternion) relative to another one."""
    turned = np.append(-reference[3:6], reference[6])
    return np.append(rotation(turned) @ (pose[:3] - reference[:3]), product(turned, pose[3:]))


# Faults of wheels: functions of rows of time and pose. Seconds are from the first row.

def reset_at(seconds):
    def change(rows):
        later = rows[:, 0] - rows[0, 0] >= seconds
        reference = rows[later][0, 1:]
        rows[later, 1:] = [relative(reference, row[1:]) for row in rows[later]]
        return rows
    return change


def every_25th_from(seconds, offset):
    def change(rows):
        chosen = np.flatnonzero(rows[:, 0] - rows[0, 0] >= seconds)[::25]
        rows[chosen, 1:4] = offset(rows[chosen, 1:4])
        return rows
    return change


def frozen_from(seconds):
    def change(rows):
        later = rows[:, 0] - rows[0, 0] >= seconds
        rows[later, 1:] = rows[later][0, 1:]
        return rows
    return change


def scaled(factor):
    def change(rows):
        rows[:, 1:4] *= factor
        return rows
    return change


def mirrored(rows):
    rows[:, [2, 6]] *= -1  # y, and rotation about z
    return rows


def reversed_way(rows):
    rows[:, 1:3] *= -1
    return rows


def shifted(seconds):
    def change(rows):
        rows[:, 0] += seconds
        return rows
    return change


def clock_jump_at(at, seconds):
    def change(rows):
        rows[rows[:, 0] - rows[0, 0] >= at, 0] += seconds
        return rows
    return change


# Faults of the IMU: functions of rows of time in nanoseconds, three rates and three accelerations.

def degrees(rows):
    rows[:, 1:4] *= 180 / np.pi
    rows[:, 4:7] /= 9.81
    return rows


def no_rates(rows):
    rows[:, 1:4] = 0
    return rows


def no_rates_from(seconds):
    def change(rows):
        rows[(rows[:, 0] - rows[0, 0]) * 1e-9 >= seconds, 1:4] = 0
        return rows
    return change


def faults(resets, dark):
    begin = dark[0] if dark else 5.0
    inside = begin + 0.5 * (dark[1] - begin) if dark else 10.0
    table = {"without": (None, None), "sound": (lambda rows: rows, lambda rows: rows)}
    same = table["sound"][0]
    for seconds in resets:
        table[f"reset at {seconds:g} s"] = (reset_at(seconds), same)
    table.update({
        "spikes of 50 m": (every_25th_from(begin, lambda p: p + [50, 0, 0]), same),
        "spikes of 1e256": (every_25th_from(begin, lambda p: p * 0 + [1e256, 5e-54, 0]), same),
        f"frozen from {inside:g} s": (frozen_from(inside), same),
        "centimetres": (scaled(100), same),
        "millimetres": (scaled(1000), same),
        "30 % too long": (scaled(1.3), same),
        "mirrored": (mirrored, same),
        "backwards": (reversed_way, same),
        "0.5 s late": (shifted(0.5), same),
        f"clock +1.5 s at {inside:g} s": (clock_jump_at(inside, 1.5), same),
        "degrees and g": (same, degrees),
        "rates of zero": (same, no_rates),
        f"rates of zero from {inside:g} s": (same, no_rates_from(inside)),
        "reset, no gyroscope": (reset_at(inside), None),
        "frozen, no gyroscope": (frozen_from(inside), None),
    })
    return table


def link_tree(source: pathlib.Path, target: pathlib.Path, left_out: set) -> None:
    target.mkdir()
    for entry in source.iterdir():
        if entry.name not in left_out:
            os.symlink(entry.resolve(), target / entry.name)


def write_wheels(source: pathlib.Path, target: pathlib.Path, change) -> None:
    rows = np.loadtxt(source)
    with target.open("w") as file:
        for row in change(rows.copy()):
            file.write(f"{row[0]:.9f} " + " ".join(f"{value:.12g}" for value in row[1:]) + "\n")


def write_imu(source: pathlib.Path, target: pathlib.Path, change) -> None:
    times = np.loadtxt(source, delimiter=",", usecols=0, dtype=np.int64)
    rows = np.loadtxt(source, delimiter=",", dtype=np.float64)
    rows[:, 0] = times - times[0]
    with target.open("w") as file:
        file.write("#timestamp [ns],rates,accelerations\n")
        for time, row in zip(times, change(rows)):
            file.write(f"{time}," + ",".join(f"{value:.12g}" for value in row[1:]) + "\n")


def spoilt(recording: pathlib.Path, copy: pathlib.Path, wheels, imu) -> None:
    link_tree(recording, copy, {"wheel.txt", "mav0"})
    link_tree(recording / "mav0", copy / "mav0", {"imu0"})
    if wheels:
        write_wheels(recording / "wheel.txt", copy / "wheel.txt", wheels)
    if imu:
        link_tree(recording / "mav0" / "imu0", copy / "mav0" / "imu0", {"data.csv"})
        write_imu(recording / "mav0" / "imu0" / "data.csv", copy / "mav0" / "imu0" / "data.csv", imu)


def read_truth(recording: pathlib.Path):
    path = recording / "mav0" / "state_groundtruth_estimate0" / "data.csv"
    times = np.loadtxt(path, delimiter=",", usecols=0, dtype=np.int64)
    rows = np.loadtxt(path, delimiter=",", usecols=range(1, 8))
    return times, rows[:, :3], rows[:, [4, 5, 6, 3]]


def true_steps(truth, times_ns):
    """True position and body axes at each time, from the nearest sample."""
    times, positions, quaternions = truth
    seconds, at = (times - times[0]) * 1e-9, (np.array(times_ns) - times[0]) * 1e-9
    interpolated = np.stack([np.interp(at, seconds, positions[:, axis]) for axis in range(3)], axis=1)
    nearest = np.abs(times[:, None] - np.array(times_ns)[None, :]).argmin(axis=0)
    return interpolated, [rotation(quaternions[i]) for i in nearest]


def odometry_jump(frames, truth):
    """Largest error of an odometry step, metres, and largest ratio to its 95 % bound."""
    kept = [(i, f) for i, f in enumerate(frames) if f.get("odometry")]
    if len(kept) < 2:
        return 0.0, 0.0
    positions, axes = true_steps(truth, [f["time_ns"] for _, f in kept])
    worst = worst_of_bound = 0.0
    for k in range(1, len(kept)):
        if kept[k][0] != kept[k - 1][0] + 1:
            continue
        before, after = kept[k - 1][1]["odometry"], kept[k][1]["odometry"]
        if None in before["position_m"] + after["position_m"]:  # JSON null for NaN
            return float("inf"), float("inf")
        step = rotation(before["quaternion_xyzw"]).T @ (np.array(after["position_m"]) - before["position_m"])
        error = step - axes[k - 1].T @ (positions[k] - positions[k - 1])
        covariance = np.array(after["body_covariance"]).reshape(6, 6)[:3, :3] + NOISE ** 2 * np.eye(3)
        worst = max(worst, float(np.linalg.norm(error)))
        worst_of_bound = max(worst_of_bound, float(np.sqrt(error @ np.linalg.solve(covariance, error) / BOUND)))
    return worst, worst_of_bound


def rms(values) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")


def parse_stats(path: pathlib.Path) -> dict:
    text = re.sub(r"(?<![\w\"])-?nan\b", "NaN", path.read_text())
    return json.loads(text)


class Runs:
    def __init__(self, options):
        self.options = options
        self.truth = read_truth(options.recording)
        self.errors_without = None

    def run(self, name, wheels, imu, folder: pathlib.Path) -> dict:
        options = self.options
        copy, stats, final = folder / "recording", folder / "stats.json", folder / "final.txt"
        spoilt(options.recording, copy, wheels, imu)
        command = [options.byre, options.task, copy, "--pace", "paced", "--stats", stats, "--trajectory", final]
        command += ["--gyroscope"] if imu else []
        command += [] if wheels else ["--no-wheels"]
        command += ["--frames", options.frames] if options.frames else []
        command += ["--camera", options.camera] if options.camera else []
        if options.task == "run":
            command += ["--map", options.map, "--truth", options.recording, "--map-truth", options.map_truth]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        if done.returncode != 0 and not stats.exists():
            print(f"{name}: exit code {done.returncode}: {done.stderr.strip().splitlines()[-1:]}", file=sys.stderr)
            return {}
        frames = parse_stats(stats)["frames"]
        jump, of_bound = odometry_jump(frames, self.truth)
        row = {"frames": len(frames), "jump": jump, "of_bound": of_bound,
               "warnings": [line for line in done.stderr.splitlines()
                            if re.search(r"warning: (wheels|gyroscope|accelerometer)", line)]}
        if options.task == "run":
            self.judge_mission(frames, row)
        else:
            self.judge_map(final, row)
        return row

    def judge_mission(self, frames, row) -> None:
        errors = {f["time_ns"]: (f["error"]["position_m"], f["health"]["verdict"]) for f in frames if f.get("error")}
        errors = {t: (float("inf") if e is None else e, verdict) for t, (e, verdict) in errors.items()}
        trusted = [e for e, verdict in errors.values() if verdict == "trusted"]
        row.update(trusted=len(trusted), wrong=sum(e > WRONG for e in trusted), worst=max(trusted, default=0.0),
                   worst_any=max((e for e, _ in errors.values()), default=0.0),
                   rmse=rms([e for e, _ in errors.values()]))
        if self.errors_without is None:
            self.errors_without = {t: e for t, (e, _) in errors.items()}
        both = [t for t in errors if t in self.errors_without]
        row["ratio"] = rms([errors[t][0] for t in both]) / rms([self.errors_without[t] for t in both])

    def judge_map(self, final, row) -> None:
        command = [self.options.byre, "evaluate", "--estimate", final, "--truth", self.options.recording]
        if self.options.camera:
            command += ["--align", "sim3"]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        found = re.search(r"ATE +m +([0-9.e+-]+)", done.stdout)
        row["rmse"] = float(found.group(1)) if found else float("nan")
        if self.errors_without is None:
            self.errors_without = row["rmse"]
        row["ratio"] = row["rmse"] / self.errors_without


def describe(name: str, row: dict) -> str:
    if not row:
        return f"{name:28} failed"
    mission = f"{row['trusted']:7d} {row['wrong']:5d} {row['worst']:7.3f} {row['worst_any']:7.3f} " if "wrong" in row else ""
    return (f"{name:28} {row['frames']:6d} {mission}{1e3 * row['jump']:8.1f} {row['of_bound']:8.2f} "
            f"{1e3 * row['rmse']:8.1f} {row['ratio']:6.2f} {len(row['warnings']):8d}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("--task", choices=["run", "map"], default="run")
    parser.add_argument("--map", type=pathlib.Path)
    parser.add_argument("--map-truth", type=pathlib.Path)
    parser.add_argument("--camera")
    parser.add_argument("--frames")
    parser.add_argument("--dark", help="FROM:TO, time in which the lens is covered (cover_lens.py), seconds")
    parser.add_argument("--resets", type=float, nargs="*", default=[0.5, 1, 2, 3, 5, 7, 9, 12, 15, 18])
    parser.add_argument("--only", help="run only faults whose names match this regular expression")
    parser.add_argument("--byre", default="build/release/src/byre/cli/byre")
    parser.add_argument("--show-warnings", action="store_true")
    options = parser.parse_args()
    if options.task == "run" and not (options.map and options.map_truth):
        parser.error("missions need --map and --map-truth")
    options.recording = options.recording.resolve()
    dark = [float(second) for second in options.dark.split(":")] if options.dark else None
    runs, is_reached, has_failed = Runs(options), True, False
    mission = "trusted wrong  worst m  (any)  " if options.task == "run" else ""
    print(f"{'fault':28} frames {mission}jump mm of bound  RMSE mm  ratio warnings")
    for name, (wheels, imu) in faults(options.resets, dark).items():
        if name != "without" and options.only and not re.search(options.only, name):
            continue
        folder = pathlib.Path(tempfile.mkdtemp(prefix="motion_faults."))
        try:
            row = runs.run(name, wheels, imu, folder)
        finally:
            shutil.rmtree(folder)
        print(describe(name, row), flush=True)
        for warning in row.get("warnings", []) if options.show_warnings else []:
            print(f"    {warning}")
        has_failed = has_failed or not row
        is_reached = is_reached and row.get("wrong", 0) == 0 and row.get("of_bound", 0.0) <= 1.0
    return 2 if has_failed else 0 if is_reached else 1


if __name__ == "__main__":
    sys.exit(main())
