#!/usr/bin/env python3
"""Plots an estimated trajectory and the ground truth from above, and the position error over time.

    tools/plot_trajectory.py --estimate out.txt --truth data.csv --time-offset -0.0075 -o plot.svg

Both files are in TUM format; the truth may be EuRoC's state_groundtruth_estimate0/data.csv. Errors are after rigid
alignment, as those of `byre evaluate`. Needs python3-numpy and python3-matplotlib.
"""
import argparse
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np


def read(path):
    """Times (s) and positions (m) of a trajectory."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    rows = [line.replace(",", " ").split() for line in text.splitlines() if line and not line.startswith("#")]
    data = np.array([[float(value) for value in row[:4]] for row in rows])
    times = data[:, 0] * (1e-9 if data[0, 0] > 1e12 else 1.0)
    return times, data[:, 1:4]


def align(source, target):
    """Rotation and translation of the least-squares fit of source onto target (Umeyama 1991)."""
    source_mean, target_mean = source.mean(0), target.mean(0)
    u, _, vt = np.linalg.svd((target - target_mean).T @ (source - source_mean))
    rotation = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
    return rotation, target_mean - rotation @ source_mean


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--estimate", required=True)
    parser.add_argument("--truth", required=True)
    parser.add_argument("--time-offset", type=float, default=0.0, help="added to the time stamps of the truth, seconds")
    parser.add_argument("--title", default="")
    parser.add_argument("-o", "--output", required=True, help="SVG file")
    arguments = parser.parse_args()

    times, estimate = read(arguments.estimate)
    true_times, truth = read(arguments.truth)
    true_times = true_times + arguments.time_offset
    inside = (times >= true_times[0]) & (times <= true_times[-1])
    if inside.sum() < 3:
        sys.exit("estimate and truth have fewer than three common times")
    times, estimate = times[inside], estimate[inside]
    truth = np.stack([np.interp(times, true_times, truth[:, axis]) for axis in range(3)], axis=1)
    rotation, translation = align(estimate, truth)
    estimate = estimate @ rotation.T + translation
    errors = np.linalg.norm(estimate - truth, axis=1) * 1e3

    figure, (above, over_time) = plt.subplots(1, 2, figsize=(10, 4))
    above.plot(truth[:, 0], truth[:, 1], color="0.6", linewidth=3, label="truth")
    above.plot(estimate[:, 0], estimate[:, 1], color="tab:green", linewidth=1, label="byre")
    above.plot(*estimate[0, :2], "o", color="black", markersize=4, label="start")
    above.set_aspect("equal")
    above.set(xlabel="x [m]", ylabel="y [m]", title=arguments.title)
    above.legend()
    over_time.plot(times - times[0], errors, color="tab:green", linewidth=1)
    rmse = np.sqrt((errors**2).mean())
    over_time.axhline(rmse, color="0.3", linewidth=0.8, linestyle="--")
    over_time.set(xlabel="time [s]", ylabel="position error [mm]", title=f"ATE {rmse:.2f} mm over {len(errors)} frames")
    over_time.set_ylim(bottom=0)
    figure.tight_layout()
    figure.savefig(arguments.output)


if __name__ == "__main__":
    main()
