"""Checks that the layouts for RViz and Foxglove use topics of a node with default settings.

Usage: layouts_test.py BYRE FOLDER      BYRE: the program; FOLDER: the source folder ros2
"""
import json
import pathlib
import re
import subprocess
import sys
import unittest

BYRE, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2])
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


def panels_in(layout) -> list[str]:
    if isinstance(layout, str):
        return [layout]
    return panels_in(layout["first"]) + panels_in(layout["second"])


class Layouts(unittest.TestCase):
    def test_foxglove_shows_every_configured_panel(self):
        layout = json.loads((FOLDER / "foxglove/byre.json").read_text())
        self.assertCountEqual(panels_in(layout["layout"]), layout["configById"])

    def test_foxglove_uses_topics_of_the_node(self):
        text = (FOLDER / "foxglove/byre.json").read_text()
        named = {name.split(".")[0] for name in re.findall(r'"(/[\w/.]+)', text)}
        self.assertIn("/byre/points", named)
        self.assertLessEqual(named, node_topics())

    def test_rviz_uses_topics_of_the_node(self):
        named = set(re.findall(r"Value: (/\S+)", (FOLDER / "rviz/byre.rviz").read_text()))
        self.assertIn("/byre/points", named)
        self.assertLessEqual(named, node_topics())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
