#!/usr/bin/env python3
"""Maps a recording, reports the trajectory error if ground truth exists, and plots the trajectory from above.

    map_and_plot.py MH_01_easy -o trajectory.svg [--map hall.byre]

The plot needs python3-matplotlib.
"""
import argparse

import numpy as np

import byre


def run(path: str) -> byre.Slam:
    recording = byre.Recording(path)
    slam = byre.Slam.mapping(recording.calibration, byre.SlamOptions(workers=byre.Workers.repeatable))
    for images in recording:
        slam.process(images)
    slam.finish()
    return slam


def tell_error(estimate: byre.Trajectory, path: str) -> None:
    found = byre.find_ground_truth(path)
    if found is None:
        print("no trajectory error: the recording has no ground truth")
        return
    try:
        truth = byre.read_trajectory(found)
    except byre.InputError as error:
        print(f"no trajectory error: {error}")
        return
    error = byre.absolute_trajectory_error(estimate, truth).translation
    print(f"ATE {1e3 * error.rmse:.1f} mm over {error.count} of {len(estimate)} poses, at most {1e3 * error.max:.1f} mm")


def plot(estimate: byre.Trajectory, path: str) -> None:
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    positions = estimate.poses[:, :3, 3]
    figure, axes = plt.subplots()
    axes.plot(positions[:, 0], positions[:, 1])
    axes.set_aspect("equal")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")
    figure.savefig(path)


def main() -> None:
    parser = argparse.ArgumentParser(description="Maps a recording and plots the trajectory.")
    parser.add_argument("recording", help="folder or file of the recording")
    parser.add_argument("-o", "--plot", help="plot to write; the suffix selects the format")
    parser.add_argument("--map", help="map to write")
    arguments = parser.parse_args()
    slam = run(arguments.recording)
    trajectory = slam.trajectory()
    length = np.linalg.norm(np.diff(trajectory.poses[:, :3, 3], axis=0), axis=1).sum()
    print(f"{len(trajectory)} of {slam.frames} frames have a pose, {length:.2f} m, {slam.keyframes} keyframes")
    tell_error(trajectory, arguments.recording)
    if arguments.map:
        slam.save(arguments.map)
    if arguments.plot:
        plot(trajectory, arguments.plot)


if __name__ == "__main__":
    main()
