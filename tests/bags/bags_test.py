#!/usr/bin/env python3
"""byre on bags written by other software from MH_01_easy and freiburg1_rpy: results must equal those on the folder.

Usage: bags_test.py BYRE        BYRE is the program; the recording is searched below $BYRE_DATA, or ../shared/data
next to the project's folder. Exit code 77 if it or a bag writer is missing.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    from bag_writers import write_rosbag, write_rosbag2_mcap, write_rosbag2_sqlite
    from euroc_messages import Camera, camchain, depth_messages_of, messages_of, motion_of
except ImportError as error:
    print(f"Skipped: {error.name} is not installed (python3-rosbag, python3-sensor-msgs, python3-nav-msgs, "
          "python3-tf2-msgs)")
    sys.exit(77)

PROJECT = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path(os.environ.get("BYRE_DATA", PROJECT.parent / "shared" / "data"))
RECORDING = DATA / "euroc" / "MH_01_easy"
BYRE = None


def run(*arguments, expected=0):
    done = subprocess.run([BYRE, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == expected, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


class Bags(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.cameras = [Camera(RECORDING / "mav0" / name) for name in ("cam0", "cam1")]
        cls.calibration = cls.folder / "camchain.yaml"
        cls.calibration.write_text(camchain(cls.cameras), encoding="utf-8")
        cls.from_folder = {frames: cls.trajectory(RECORDING, frames) for frames in (10, 30)}
        cls.long = messages_of(cls.cameras, 30, raw=False)
        cls.short = messages_of(cls.cameras, 10, raw=True)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def trajectory(cls, recording, frames, *options):
        written = cls.folder / "trajectory.txt"
        run("map", recording, *options, "--calibration", cls.calibration, "--frames", f":{frames}", "--pace", "paced",
            "--quiet", "-o", cls.folder / "walk.byre", "--trajectory", written)
        return written.read_bytes()

    def expect_same(self, bag, frames):
        self.assertGreaterEqual(self.from_folder[frames].count(b"\n"), frames)
        self.assertTrue(self.trajectory(bag, frames) == self.from_folder[frames], f"{bag}: the trajectory differs")

    def test_ros1_bag_equals_folder(self):
        write_rosbag(self.folder / "long.bag", self.long, "lz4")
        self.expect_same(self.folder / "long.bag", 30)

    def test_ros1_bag_accepts_each_compression(self):
        for compression in ("none", "bz2", "lz4"):
            bag = self.folder / f"{compression}.bag"
            write_rosbag(bag, self.short, compression)
            self.expect_same(bag, 10)
            told = json.loads(run("bag", "info", bag, "--json"))
            self.assertEqual(told["compression"], [] if compression == "none" else [compression])
            self.assertEqual(told["damage"], [])
            self.assertEqual(told["messages"], len(self.short))

    def test_ros1_bag_provides_wheels_and_gyroscope(self):
        moving, options = motion_of(self.short), ("--imu-topic", "/imu", "--wheels-topic", "/odom")
        write_rosbag2_mcap(self.folder / "moving", moving)
        expected = self.trajectory(self.folder / "moving", 10, *options)
        self.assertNotEqual(expected, self.from_folder[10])
        for compression in ("none", "bz2", "lz4"):
            write_rosbag(self.folder / "moving.bag", moving, compression)
            self.assertTrue(self.trajectory(self.folder / "moving.bag", 10, *options) == expected, compression)

    def test_ros1_bag_with_depth_equals_folder(self):
        folder = DATA / "tum" / "freiburg1_rpy"
        if not folder.is_dir():
            self.skipTest(f"no recording at {folder}")
        write_rosbag(self.folder / "depth.bag", depth_messages_of(folder, 10), "bz2")
        paths = []
        calibration = ("--calibration", folder / "calibration.yaml")
        for recording, options in ((folder, ()), (self.folder / "depth.bag", calibration)):
            paths.append(self.folder / f"depth{len(paths)}.txt")
            run("map", recording, *options, "--camera", "rgbd", "--frames", ":8", "--pace", "paced", "--quiet",
                "-o", self.folder / "depth.byre", "--trajectory", paths[-1])
        self.assertGreaterEqual(paths[0].read_bytes().count(b"\n"), 8)
        self.assertEqual(paths[0].read_bytes(), paths[1].read_bytes())

    def test_rosbag2_in_sqlite_equals_folder(self):
        write_rosbag2_sqlite(self.folder / "sqlite", self.long)
        self.expect_same(self.folder / "sqlite", 30)

    def test_rosbag2_in_mcap_equals_folder(self):
        write_rosbag2_mcap(self.folder / "mcap", self.long)
        self.expect_same(self.folder / "mcap", 30)
        write_rosbag2_mcap(self.folder / "mcap_raw", self.short)
        self.expect_same(self.folder / "mcap_raw", 10)

    def test_bags_report_their_topics(self):
        write_rosbag2_mcap(self.folder / "topics", self.short)
        told = json.loads(run("bag", "info", self.folder / "topics", "--json"))
        counts = {topic["name"]: topic["messages"] for topic in told["topics"]}
        self.assertEqual(counts, {"/tf_static": 1, "/cam0/camera_info": 1, "/cam1/camera_info": 1,
                                  "/cam0/image_raw": 10, "/cam1/image_raw": 10})
        self.assertEqual(told["images"], {"left": "/cam0/image_raw", "right": "/cam1/image_raw"})
        self.assertEqual(told["storage"], "mcap")

    def test_camera_info_and_frames_provide_the_calibration(self):
        write_rosbag2_sqlite(self.folder / "calibrated", self.short)
        in_bag = json.loads(run("check", self.folder / "calibrated", "--json"))
        in_folder = json.loads(run("check", RECORDING, "--frames", ":10", "--json"))
        self.assertAlmostEqual(in_bag["baseline_m"], in_folder["baseline_m"], places=8)
        self.assertAlmostEqual(in_bag["pair"]["row_error_px"], in_folder["pair"]["row_error_px"], places=4)

    def test_truncated_bag_is_mapped_up_to_the_cut(self):
        write_rosbag(self.folder / "whole.bag", self.short, "none")
        cut = self.folder / "cut.bag"
        cut.write_bytes((self.folder / "whole.bag").read_bytes()[:4_000_000])
        told = run("bag", "info", cut, expected=1)
        self.assertIn("DAMAGE", told)
        self.assertIn("is truncated or damaged from byte", told)
        checked = json.loads(run("check", cut, "--calibration", self.calibration, "--json"))
        self.assertGreaterEqual(checked["frames"], 4)
        self.assertLess(checked["frames"], 10)


if __name__ == "__main__":
    if not RECORDING.is_dir():
        print(f"Skipped: no recording at {RECORDING}; set BYRE_DATA to the folder with euroc/MH_01_easy")
        sys.exit(77)
    BYRE = sys.argv.pop(1)
    unittest.main()
