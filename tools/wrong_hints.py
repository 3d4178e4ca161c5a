#!/usr/bin/env python3
"""Starts a mission at many times with pose hints that are wrong by some metres; reports the poses found.

    PYTHONPATH=build/release/python tools/wrong_hints.py MISSION MAP [--shifts -10 -5 5 10] [--frames 220] [--every 120]

One line per start: first pose and its error relative to the same mission without a hint, number of wrong poses (error
above 0.2 m), number of those trusted, and events.
"""
import argparse

import numpy as np

import byre

WRONG_M = 0.2


def mission_on(recording: byre.Recording, map_file: str) -> byre.Slam:
    return byre.Slam.on_map(recording.calibration, map_file, byre.SlamOptions(workers=byre.Workers.repeatable))


def poses_without_hint(recording: byre.Recording, map_file: str) -> dict[int, np.ndarray]:
    slam = mission_on(recording, map_file)
    reports = [slam.process(recording[i]) for i in range(len(recording))]
    return {i: report.map_from_body for i, report in enumerate(reports) if report.map_from_body is not None}


def long_axis(poses: dict[int, np.ndarray]) -> np.ndarray:
    positions = np.array([pose[:3, 3] for pose in poses.values()])
    return np.linalg.svd(positions - positions.mean(axis=0))[2][0]


def fly(slam: byre.Slam, recording: byre.Recording, frames: range, poses: dict[int, np.ndarray]) -> str:
    first, wrong, trusted, events = "no pose", 0, 0, []
    for i in frames:
        report = slam.process(recording[i])
        events += [f"{i - frames.start} {event.name}" for event in report.events]
        if report.map_from_body is None or i not in poses:
            continue
        error = float(np.linalg.norm(report.map_from_body[:3, 3] - poses[i][:3, 3]))
        if first == "no pose":
            first = f"frame {i - frames.start} off by {error:.2f} m"
        if error > WRONG_M:
            wrong += 1
            trusted += report.verdict == byre.Verdict.trusted
    return f"{first}; {wrong} wrong, {trusted} of them trusted; {', '.join(events)}"


def main() -> None:
    parser = argparse.ArgumentParser(description="Starts a mission at many times with wrong pose hints.")
    parser.add_argument("mission")
    parser.add_argument("map")
    parser.add_argument("--shifts", type=float, nargs="+", default=[-10.0, -5.0, 5.0, 10.0], metavar="METRES")
    parser.add_argument("--frames", type=int, default=220)
    parser.add_argument("--every", type=int, default=120, metavar="FRAMES")
    arguments = parser.parse_args()
    recording = byre.Recording(arguments.mission)
    poses = poses_without_hint(recording, arguments.map)
    axis = long_axis(poses)
    for start in range(100, len(recording) - arguments.frames, arguments.every):
        for shift in arguments.shifts if start in poses else []:
            hint = poses[start].copy()
            hint[:3, 3] += shift * axis
            slam = mission_on(recording, arguments.map)
            slam.set_initial_pose(hint, radius=1.5, turn=0.5, seconds=8.0)
            frames = range(start, start + arguments.frames)
            print(f"frame {start}, {shift:+.0f} m: {fly(slam, recording, frames, poses)}", flush=True)


if __name__ == "__main__":
    main()
