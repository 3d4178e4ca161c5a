"""Checks that the layouts for RViz and Foxglove use topics of a node with default settings and of a record.

Usage: layouts_test.py BYRE SOURCE      BYRE: the program; SOURCE: the source folder
"""
import json
import pathlib
import re
import subprocess
import sys
import unittest

BYRE, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
FOLDER = SOURCE / "ros2"
RECORD = SOURCE / "src/byre/playback/report/run_messages.cc"
LAYOUTS = ["foxglove/byre.json", "rviz/byre.rviz"]
# Topics of the node without a setting, and topics of other nodes that a layout may publish.
BEYOND_SETTINGS = {"/tf", "/tf_static", "/diagnostics", "/goal_pose", "/clicked_point"}


def node_topics() -> set[str]:
    settings = subprocess.run([BYRE, "node", "--print-config"], check=True, capture_output=True, text=True).stdout
    topics = set(BEYOND_SETTINGS)
    section = ""
    for line in settings.splitlines():
        if match := re.fullmatch(r"(\w+):", line):
            section = match[1]
        elif (match := re.match(r"  \w+: ([^ #]+)", line)) and section in ("topics", "images", "calibration"):
            name = match[1].strip("\"'")
            topics.add(name if name.startswith("/") else f"/byre/{name}")
    return topics


def record_topics() -> set[str]:
    named = set(re.findall(r'"(/[\w/]+)"', RECORD.read_text())) - {"/left", "/right"}
    return {name for name in named if name not in ("/image_raw", "/camera_info")} | {
        camera + name for camera in ("/left", "/right") for name in ("/image_raw", "/camera_info")}


def topics_in(layout: str) -> set[str]:
    text = (FOLDER / layout).read_text()
    if layout.endswith(".json"):
        return {name.split(".")[0] for name in re.findall(r'"(/[\w/.]+)', text)}
    return set(re.findall(r"Value: (/\S+)", text))


def panels_in(layout) -> list[str]:
    if isinstance(layout, str):
        return [layout]
    return panels_in(layout["first"]) + panels_in(layout["second"])


class Layouts(unittest.TestCase):
    def test_foxglove_shows_every_configured_panel(self):
        layout = json.loads((FOLDER / "foxglove/byre.json").read_text())
        self.assertCountEqual(panels_in(layout["layout"]), layout["configById"])

    def test_use_topics_of_a_node_or_of_a_record(self):
        for layout in LAYOUTS:
            with self.subTest(layout=layout):
                self.assertLessEqual(topics_in(layout), node_topics() | record_topics())

    def test_show_what_nodes_and_records_have_in_common(self):
        common = node_topics() & record_topics()
        self.assertLessEqual({"/tf", "/diagnostics", "/left/image_raw", "/byre/odometry", "/byre/pose", "/byre/path",
                              "/byre/points", "/byre/events"}, common)
        for layout in LAYOUTS:
            with self.subTest(layout=layout):
                shown = topics_in(layout)
                self.assertLessEqual({"/left/image_raw", "/byre/odometry", "/byre/pose", "/byre/path", "/byre/points",
                                      "/byre/offline_points", "/map"}, shown)
                self.assertGreaterEqual(len(shown & common), 5)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
