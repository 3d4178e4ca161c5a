#!/usr/bin/env python3
"""Tests of run_tutorials.py on small pages, without byre."""
import contextlib
import io
import pathlib
import tempfile
import unittest
from unittest import mock

import run_tutorials


class RunTutorialsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve()
        (self.root / "prefix" / "bin").mkdir(parents=True)

    def main(self, text, *options):
        page = self.root / "page.md"
        page.write_text(text, encoding="utf-8")
        output, errors = io.StringIO(), io.StringIO()
        arguments = ["run_tutorials.py", *(options or ["--prefix", str(self.root / "prefix")]), str(page)]
        with mock.patch("sys.argv", arguments), contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            code = run_tutorials.main()
        return code, (output.getvalue() + errors.getvalue()).replace(f"{self.root}/", "")

    def assert_passes(self, text, words):
        code, output = self.main(text)
        self.assertEqual(0, code, output)
        self.assertIn(words, output)

    def assert_fails(self, text, words):
        code, output = self.main(text)
        self.assertEqual(1, code, output)
        self.assertIn(words, output)

    def assert_refused(self, text, words):
        code, output = self.main(text, "--check")
        self.assertEqual(2, code, output)
        self.assertIn(words, output)

    def test_carries_variables_and_folder_over(self):
        self.assert_passes("```sh\nexport A='x y'\nmkdir new\ncd new\n```\n\n"
                           "```bash\n[[ $A == 'x y' && $PWD == */page/new ]]\n```\n", "2 blocks run, 0 files written")

    def test_reports_page_line_command_and_output_of_a_failure(self):
        self.assert_fails("# Title\n\n```sh\necho before\nfalse\necho after\n```\n",
                          "page.md:5: false: exit code 1\n    | before\n")
        self.assert_fails("```sh\nfalse | true\n```\n", "page.md:2: ")
        self.assert_fails("```sh\nabsent-program a\n```\n", "page.md:2: absent-program a: exit code 127")

    def test_stops_the_page_at_the_first_failure(self):
        code, output = self.main("```sh\nfalse\n```\n\n```sh\necho never\n```\n")
        self.assertEqual(1, code)
        self.assertNotIn("never", output)

    def test_writes_files_named_in_the_text(self):
        self.assert_passes("Save as `src/a.py`:\n\n<!-- file: src/a.py -->\n```python\nprint('a  b')\n```\n\n"
                           "```sh\npython3 src/a.py\n```\n\n<!-- output -->\n```\na b\n```\n", "1 files written, 1 outputs")

    def test_runs_hidden_setup(self):
        self.assert_passes("<!-- setup\necho hay >barn.txt\n-->\n\n```sh\ngrep hay barn.txt\n```\n", "2 blocks run")
        self.assert_fails("<!-- setup\nfalse\n-->\n", "page.md:2: false: exit code 1")
        self.assert_refused("<!-- setup\nfalse\n", "page.md:1: setup without end")

    def test_lists_blocks_left_out(self):
        self.assert_passes("<!-- skip: changes the system -->\n```sh\nfalse\n```\n\n<!-- output -->\n```\nx\n```\n",
                           "page.md:3: not run: changes the system\n  page.md:8: not compared")
        self.assert_passes("<!-- needs: bash, absent-program, /absent, test 1 = 2 -->\n```sh\nfalse\n```\n",
                           "page.md:3: not run: needs absent-program, /absent, test 1 = 2\n")
        self.assert_passes("<!-- needs: bash, /, true a -->\n```sh\ntrue\n```\n", "1 blocks run")

    def test_compares_output_except_for_numbers(self):
        page = "```sh\nprintf 'ATE  4.1 mm\\nmiddle\\nend 3\\n'\n```\n\n<!-- output -->\n```\n{}\n```\n"
        self.assert_passes(page.format("ATE 12 mm\n...\nend 4"), "1 outputs compared")
        self.assert_fails(page.format("ATE 12 m"), "page.md:7: output lacks: ATE 12 m\n    | ATE  4.1 mm\n")
        self.assert_fails(page.format("end 3\nATE 4.1 mm"), "output lacks: ATE 4.1 mm")

    def test_interrupts_a_block(self):
        self.assert_passes("<!-- interrupt: 0.3 -->\n```sh\nsleep 60\n```\n", "1 blocks run")
        self.assert_fails("<!-- interrupt: 5 -->\n```sh\ntrue\n```\n", "page.md:3: block ended before Ctrl-C")
        self.assert_fails("<!-- interrupt: 5 -->\n```sh\nfalse\n```\n", "page.md:3: false: exit code 1")

    def test_ends_a_block_that_takes_too_long(self):
        code, output = self.main("```sh\necho begun\nsleep 60\n```\n", "--installed", "--timeout", "0.5")
        self.assertEqual(1, code)
        self.assertIn("page.md:2: block took more than 0.5 s: exit code 124\n    | begun", output)

    def test_uses_the_prefix_before_the_system(self):
        program = self.root / "prefix" / "bin" / "byre"
        program.write_text("#!/bin/sh\necho installed\n")
        program.chmod(0o755)
        (self.root / "prefix" / "lib" / "python3" / "dist-packages").mkdir(parents=True)
        with mock.patch.dict("os.environ", {"BYRE_DATA": "/elsewhere"}):
            self.assert_passes("```sh\nbyre\n[[ -z ${BYRE_DATA-} && $CMAKE_PREFIX_PATH == */prefix ]]\n"
                               "[[ $PYTHONPATH == */prefix/lib/python3/dist-packages ]]\n```\n\n"
                               "<!-- output -->\n```\ninstalled\n```\n", "1 outputs compared")

    def test_refuses_unclear_marks(self):
        self.assert_refused("```cpp\nint a;\n```\n", "page.md:2: cpp block has neither a file nor a reason")
        self.assert_refused("<!-- file: a.cc -->\n```cpp\nint a;\n```\n", "page.md:3: the text above does not name")
        self.assert_refused("`../a`\n\n<!-- file: ../a -->\n```cpp\n```\n", "leaves the folder of the page")
        self.assert_refused("<!-- files: a.cc -->\n```cpp\n```\n", "page.md:1: comment above a block is no mark")
        self.assert_refused("<!-- output -->\n```sh\n```\n", "output has no language")
        self.assert_refused("<!-- skip: a -->\n<!-- file: a -->\n```sh\n```\n", "contradicting marks: file, skip")
        self.assert_refused("<!-- skip: a -->\n```\n```\n", "mark other than output")
        self.assert_refused("```sh\necho\n", "page.md:1: block without end")

    def test_ignores_other_comments_and_blocks(self):
        self.assertEqual((0, ""), self.main("<!-- note -->\n\n```\nfigure\n```\n", "--check"))


if __name__ == "__main__":
    unittest.main()
