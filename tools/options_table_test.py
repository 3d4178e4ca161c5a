#!/usr/bin/env python3
"""Tests of options_table.py, with a program that prints two options."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(__file__).resolve().parent / "options_table.py"
PROGRAM = """#!/bin/sh
if [ "$1 $2" = "node --print-config" ]; then
  echo 'images:'
  echo '  right: ""  # images of the right camera; empty: one (topic or empty)'
  exit
fi
echo 'pace: paced  # place of mapping (paced|live)'
echo 'tracking:'
echo '  radius_px: 12.5  # first search (pixels at octave 0, from 0.5 to 1000)'
"""
PAGE = """Words.

<!-- The table is written by tools/options_table.py. -->
<!-- End of the table. -->

More words.
"""
ROWS = ["| `pace` |  | paced | paced, live | place of mapping |",
        "| `tracking.radius_px` | pixels at octave 0 | 12.5 | from 0.5 to 1000 | first search |"]

SETTING = '| `images.right` | "" | topic or empty | images of the right camera; empty: one |'


class OptionsTable(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.program = pathlib.Path(self.folder.name) / "program"
        self.page = pathlib.Path(self.folder.name) / "page.md"
        self.program.write_text(PROGRAM)
        self.program.chmod(0o755)
        self.page.write_text(PAGE)

    def run_tool(self, *more: str) -> int:
        command = [sys.executable, str(TOOL), str(self.program), str(self.page), *more]
        return subprocess.run(command, capture_output=True, text=True, check=False).returncode

    def test_writes_a_row_for_each_option_and_leaves_the_rest(self):
        self.assertEqual(self.run_tool(), 1)
        lines = self.page.read_text().splitlines()
        self.assertEqual([line for line in lines if line.startswith("| `")], ROWS)
        self.assertEqual((lines[0], lines[-1]), ("Words.", "More words."))
        self.assertEqual(self.run_tool(), 0, "the page is as it should be")

    def test_writes_the_settings_of_the_node(self):
        self.assertEqual(self.run_tool("--node"), 1)
        lines = [line for line in self.page.read_text().splitlines() if line.startswith("|")]
        self.assertEqual(lines, ["| option | default | accepted | meaning |", "|---|---|---|---|", SETTING])
        self.assertEqual(self.run_tool("--node", "--check"), 0)
        self.assertEqual(self.run_tool("--check"), 1)

    def test_check_tells_and_writes_nothing(self):
        self.assertEqual(self.run_tool("--check"), 1)
        self.assertEqual(self.page.read_text(), PAGE)
        self.run_tool()
        self.assertEqual(self.run_tool("--check"), 0)

    def test_refuses_a_page_without_a_place_and_a_program_of_another_kind(self):
        self.page.write_text("Words.\n")
        self.assertEqual(self.run_tool(), 2)
        self.page.write_text(PAGE)
        self.program.write_text("#!/bin/sh\necho 'something else'\n")
        self.assertEqual(self.run_tool(), 2)
        self.assertEqual(self.run_tool("--wrong"), 2)


if __name__ == "__main__":
    unittest.main()
