#!/usr/bin/env python3
"""Updates a map by sessions of faulty missions, and checks that no version gets worse.

Usage: poisoned_updates.py MAPPED MISSION... --check RECORDING... --map MAP [--elsewhere RECORDING...] [options]

Recordings are EuRoC folders with ground truth and wheel.txt, as written by byre simulate cowshed --motion. MAP was made
from MAPPED. Each fault is applied to a copy of each MISSION; recordings ELSEWHERE are of other buildings. The mission
runs on MAP and its session updates it. If that gives a new version, the right recordings CHECK run on both versions.

One row for each trial: fault, mission, share of trusted frames, outcome (the reason of a refusal, or what the checks
show). A version is worse if a check has a frame trusted and more than 0.2 m off, 1 % fewer trusted frames, or a median
error larger by 10 % and 1 mm. Exit code: 0 no version is worse, 1 some are, 2 a run failed. Needs numpy and OpenCV.
"""
import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import cv2
import numpy as np

LEFT, RIGHT = "mav0/cam0", "mav0/cam1"


def images_of(folder, camera):
    return sorted((folder / camera / "data").iterdir())


def change_images(folder, cameras, change):
    """change: function of an image, its number and the number of images."""
    for camera in cameras:
        paths = images_of(folder, camera)
        for number, path in enumerate(paths):
            image = change(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), number, len(paths))
            path.unlink()  # a link to the original
            cv2.imwrite(str(path), image)


def mirror(folder):
    change_images(folder, (LEFT, RIGHT), lambda image, *_: cv2.flip(image, 1))
    left, right, kept = folder / LEFT / "data", folder / RIGHT / "data", folder / "kept"
    left.rename(kept)
    right.rename(left)
    kept.rename(right)


def body_from_camera(folder, camera):
    text = (folder / camera / "sensor.yaml").read_text()
    return np.array([float(x) for x in re.search(r"data: \[([^]]*)\]", text)[1].split(",")]).reshape(4, 4)


def set_body_from_camera(folder, camera, pose):
    path = folder / camera / "sensor.yaml"
    numbers = ", ".join(f"{x:.12g}" for x in pose.ravel())
    text = re.sub(r"data: \[[^]]*\]", f"data: [{numbers}]", path.read_text())
    path.unlink()
    path.write_text(text)


def turned(degrees, axis):
    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(np.radians(degrees) * np.eye(3)[axis])[0]
    return pose


def turn_cameras(axis):
    """The pair was turned by two degrees on its mount, about an axis of the left camera (x right, y down, z ahead)."""
    def fault(folder):
        left, right = body_from_camera(folder, LEFT), body_from_camera(folder, RIGHT)
        set_body_from_camera(folder, LEFT, left @ turned(2.0, axis))
        set_body_from_camera(folder, RIGHT, left @ turned(2.0, axis) @ np.linalg.inv(left) @ right)
    return fault


def bend_pair(axis):
    """The right camera was turned by 0.3 degrees."""
    return lambda folder: set_body_from_camera(folder, RIGHT, body_from_camera(folder, RIGHT) @ turned(0.3, axis))


def soil(folder):
    random = np.random.default_rng(1)
    spots = [(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0.05, 0.2)) for _ in range(12)]

    def soiled(image, *_):
        height, width = image.shape
        mask = np.zeros_like(image)
        for x, y, radius in spots:
            cv2.circle(mask, (int(x * width), int(y * height)), int(radius * height), 255, -1)
        weight = cv2.GaussianBlur(mask, (0, 0), 0.02 * width)[..., None].astype(float) / 255
        blurred = cv2.GaussianBlur(image, (0, 0), 0.03 * width)[..., None]
        return (weight * (0.7 * blurred + 30) + (1 - weight) * image[..., None]).astype(np.uint8)[..., 0]
    change_images(folder, (LEFT, RIGHT), soiled)


def freeze(folder):
    """Every second second shows its first image."""
    for camera in (LEFT, RIGHT):
        paths = images_of(folder, camera)
        times = np.array([int(path.stem) for path in paths]) / 1e9
        seconds = (times - times[0]).astype(int)
        first = {second: paths[int(np.argmax(seconds == second))] for second in set(seconds)}
        for path, second in zip(paths, seconds):
            if second % 2 and path != first[second]:
                path.unlink()
                shutil.copy(first[second], path)


def scale_focal(factor):
    def fault(folder):
        for camera in (LEFT, RIGHT):
            path = folder / camera / "sensor.yaml"
            text = re.sub(r"intrinsics: \[([^,]*), ([^,]*),", lambda found: "intrinsics: ["
                          f"{factor * float(found[1])}, {factor * float(found[2])},", path.read_text())
            path.unlink()
            path.write_text(text)
    return fault


def scale_wheels(folder):
    """Wheel positions in centimetres."""
    path = folder / "wheel.txt"
    rows = np.loadtxt(path)
    rows[:, 1:4] *= 100
    path.unlink()
    np.savetxt(path, rows, fmt="%.9f")


def jump_clock(seconds):
    """Image times from the middle on are later by some seconds; those of wheels and gyroscope are not."""
    def fault(folder):
        for camera in (LEFT, RIGHT):
            paths = images_of(folder, camera)
            middle = len(paths) // 2
            lines = (folder / camera / "data.csv").read_text().splitlines()
            renamed = {path.stem: str(int(path.stem) + int(seconds * 1e9)) for path in paths[middle:]}
            for path in reversed(paths[middle:]):
                path.rename(path.with_name(renamed[path.stem] + path.suffix))
            changed = []
            for line in lines:
                stem = line.split(",")[0].strip()
                changed.append(line.replace(stem, renamed[stem]) if stem in renamed else line)
            (folder / camera / "data.csv").unlink()
            (folder / camera / "data.csv").write_text("\n".join(changed) + "\n")
    return fault


FAULTS = {
    "mirrored": mirror,
    "cameras turned up": turn_cameras(0),
    "cameras turned aside": turn_cameras(1),
    "cameras rolled": turn_cameras(2),
    "right camera turned up": bend_pair(0),
    "right camera turned aside": bend_pair(1),
    "dirt": soil,
    "every second second frozen": freeze,
    "calibration of a longer lens": scale_focal(1.03),
    "calibration of a shorter lens": scale_focal(0.97),
    "wheels in centimetres": scale_wheels,
    "clock jumps ahead": jump_clock(5.0),
    "none": lambda folder: None,
}


def copy_with_links(source, folder):
    """Images are links, other files copies."""
    for path in source.rglob("*"):
        target = folder / path.relative_to(source)
        if path.is_dir():
            target.mkdir(parents=True, exist_ok=True)
        elif path.suffix == ".png":
            target.parent.mkdir(parents=True, exist_ok=True)
            target.symlink_to(path.resolve())
        else:
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, target)


class Trials:
    def __init__(self, options):
        self.options = options
        self.before = {}  # measures of the checks on the map
        self.worse = 0

    def byre(self, *arguments, accept=(0,)):
        result = subprocess.run([self.options.byre, *map(str, arguments)], capture_output=True, text=True)
        if result.returncode not in accept:
            raise RuntimeError(f"byre {arguments[0]}: exit code {result.returncode}: {result.stderr.strip()[-300:]}")
        return result

    def run(self, recording, map_file, folder, *arguments):
        """Statistics; truth is compared where the recording has it."""
        stats = folder / "stats.json"
        self.byre("run", recording, "--map", map_file, "--stats", stats, "--quiet", *arguments, accept=(0, 1, 3))
        return json.loads(stats.read_text()) if stats.exists() else None

    def check(self, recording, map_file, folder):
        stats = self.run(recording, map_file, folder, "--truth", recording, "--map-truth", self.options.mapped)
        errors = stats["errors"]
        return (stats["mission"]["trusted_share"], 1e3 * errors["causal"]["position_m"]["median"],
                errors["trusted_off_by_more_than_0.2m"])

    def compare(self, version, folder):
        shown, is_worse = [], False
        for recording in self.options.check:
            if recording not in self.before:
                self.before[recording] = self.check(recording, self.options.map, folder)
            before, after = self.before[recording], self.check(recording, version, folder)
            is_worse |= (after[2] > 0 or after[0] < before[0] - 0.01
                         or (after[1] > 1.1 * before[1] and after[1] > before[1] + 1.0))
            shown.append(f"{before[0]:.3f} -> {after[0]:.3f}, {before[1]:.1f} -> {after[1]:.1f} mm, {after[2]} wrong")
        self.worse += is_worse
        return ("WORSE: " if is_worse else "not worse: ") + "; ".join(shown)

    def trial(self, fault, mission, change):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            recording, session, version = folder / "recording", folder / "a.session", folder / "new.byre"
            copy_with_links(mission, recording)
            change(recording)
            stats = self.run(recording, self.options.map, folder, "--save-session", session)
            trusted = f"{stats['mission']['trusted_share']:.2f}" if stats else "-"
            outcome = "no session was stored"
            if session.exists():
                report = json.loads(self.byre("update", self.options.map, session, "-o", version, "--json", "--quiet",
                                              accept=(0, 1)).stdout)
                faults = [used["fault"] for used in report["sessions"] if used["fault"]]
                outcome = "refused: " + (faults[0] if faults else report["refusal"] or "")
            if version.exists():
                outcome = self.compare(version, folder)
        print(f"{fault:30} {mission.name:10} {trusted:5} {outcome}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mapped", type=pathlib.Path)
    parser.add_argument("missions", type=pathlib.Path, nargs="+")
    parser.add_argument("--map", type=pathlib.Path, required=True)
    parser.add_argument("--check", type=pathlib.Path, nargs="+", required=True)
    parser.add_argument("--elsewhere", type=pathlib.Path, nargs="*", default=[])
    parser.add_argument("--faults", nargs="*", choices=list(FAULTS), default=list(FAULTS))
    parser.add_argument("--byre", default="byre", help="program (byre)")
    options = parser.parse_args()
    trials = Trials(options)
    try:
        for recording in options.elsewhere:
            trials.trial("elsewhere", recording, FAULTS["none"])
        for fault in options.faults:
            for mission in options.missions:
                trials.trial(fault, mission, FAULTS[fault])
    except (RuntimeError, KeyError, OSError) as error:
        print(f"poisoned_updates.py: {error!r}", file=sys.stderr)
        sys.exit(2)
    print(f"{trials.worse} versions are worse")
    sys.exit(1 if trials.worse else 0)


if __name__ == "__main__":
    main()
