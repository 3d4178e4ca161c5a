#!/usr/bin/env python3
"""Estimates the scale of a KITTI sequence independently of byre; compares it with byre and the ground truth.

Per frame: corners are tracked from left to right and forward in time by pyramidal Lucas-Kanade with a backward check;
depths follow from the given baseline, motion from points and pixels (solvePnPRansac, refined). Step lengths are summed
over each range of frames and compared with those of the truth. If both estimates deviate equally from the truth, the
given baseline or the truth is wrong. Needs python3-opencv and python3-numpy.

Usage: independent_scale.py SEQUENCE POSES TRAJECTORY FIRST:LAST...
       independent_scale.py kitti/sequences/00 kitti/poses/00.txt out.txt 17:38 17:27 27:38 46:59
       TRAJECTORY: file of `byre map SEQUENCE --trajectory`
"""

import argparse
import pathlib

import cv2
import numpy as np

LUCAS_KANADE = {"winSize": (15, 15), "maxLevel": 5, "criteria": (3, 40, 0.001)}
NEAR_DISPARITY_PX = 10.0


class Sequence:
    def __init__(self, folder):
        self.folder = folder
        lines = (folder / "calib.txt").read_text(encoding="utf-8").splitlines()
        left, right = (np.array(line.split()[1:], float).reshape(3, 4) for line in lines[:2])
        self.camera = left[:, :3]
        self.baseline_m = -right[0, 3] / left[0, 0]

    def image(self, camera, frame):
        return cv2.imread(str(self.folder / f"image_{camera}" / f"{frame:06d}.png"), cv2.IMREAD_GRAYSCALE)


def follow(first, second, points):
    """Positions of one image's points in another, and which of them pass the backward check."""
    there, found, _ = cv2.calcOpticalFlowPyrLK(first, second, points, None, **LUCAS_KANADE)
    back, found_back, _ = cv2.calcOpticalFlowPyrLK(second, first, there, None, **LUCAS_KANADE)
    is_back = np.linalg.norm((points - back)[:, 0], axis=1) < 0.1
    return there[:, 0], (found[:, 0] == 1) & (found_back[:, 0] == 1) & is_back


def step_m(sequence, frame):
    """Distance of the camera from a frame to the next, estimated from near points."""
    left, right, later = sequence.image(0, frame), sequence.image(1, frame), sequence.image(0, frame + 1)
    corners = cv2.goodFeaturesToTrack(left, 3000, 0.005, 7)
    corners = cv2.cornerSubPix(left, corners, (3, 3), (-1, -1), (3, 30, 0.01))
    in_right, is_matched = follow(left, right, corners)
    in_later, is_followed = follow(left, later, corners)
    pixels = corners[:, 0]
    disparity = pixels[:, 0] - in_right[:, 0]
    is_level = np.abs(pixels[:, 1] - in_right[:, 1]) < 0.5
    use = is_matched & is_followed & is_level & (disparity > NEAR_DISPARITY_PX)
    focal, centre = sequence.camera[0, 0], sequence.camera[:2, 2]
    depth = focal * sequence.baseline_m / disparity[use]
    points = np.c_[(pixels[use] - centre) * depth[:, None] / focal, depth]
    seen = in_later[use]
    _, turn, shift, inliers = cv2.solvePnPRansac(points, seen, sequence.camera, None, reprojectionError=1.0,
                                                 iterationsCount=300, flags=cv2.SOLVEPNP_SQPNP)
    inliers = inliers[:, 0]
    _, shift = cv2.solvePnPRefineLM(points[inliers], seen[inliers], sequence.camera, None, turn, shift)
    return float(np.linalg.norm(shift))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sequence", type=pathlib.Path)
    parser.add_argument("poses", type=pathlib.Path)
    parser.add_argument("trajectory", type=pathlib.Path)
    parser.add_argument("stretches", nargs="+", metavar="FIRST:LAST")
    arguments = parser.parse_args()
    sequence = Sequence(arguments.sequence)
    truth = np.loadtxt(arguments.poses)[:, [3, 7, 11]]
    estimate = np.loadtxt(arguments.trajectory)[:, 1:4]
    cv2.setRNGSeed(1)
    print("frames   independent   byre     (length error)")
    for stretch in arguments.stretches:
        first, last = (int(frame) for frame in stretch.split(":"))
        true_m = np.linalg.norm(np.diff(truth[first : last + 1], axis=0), axis=1).sum()
        byre_m = np.linalg.norm(np.diff(estimate[first : last + 1], axis=0), axis=1).sum()
        independent_m = sum(step_m(sequence, frame) for frame in range(first, last))
        print(f"{stretch:8} {100 * (independent_m / true_m - 1):+.2f} %      {100 * (byre_m / true_m - 1):+.2f} %")


if __name__ == "__main__":
    main()
