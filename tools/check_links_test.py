#!/usr/bin/env python3
"""Tests of check_links.py on small folders made for each case."""
import contextlib
import io
import pathlib
import tempfile
import unittest

import check_links


class CheckLinksTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name).resolve() / "project"
        self.root.mkdir()

    def write(self, name, text=""):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def found(self):
        return [(fault.path.relative_to(self.root).as_posix(), fault.line, fault.message)
                for fault in check_links.faults(self.root)]

    def assert_sound(self, text):
        self.write("page.md", text)
        self.assertEqual([], self.found())

    def assert_broken(self, text, line=1, words=""):
        self.write("page.md", text)
        found = self.found()
        self.assertEqual([("page.md", line)], [fault[:2] for fault in found])
        self.assertIn(words, found[0][2])

    def run_main(self, *arguments):
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            code = check_links.main([str(argument) for argument in arguments])
        return code, output.getvalue(), errors.getvalue()


class Files(CheckLinksTest):
    def test_accepts_files_folders_and_links_with_a_scheme(self):
        self.write("docs/other.md")
        self.write("docs/a (b).png")
        self.assert_sound("[a](docs/other.md) [b](docs) ![c](<docs/a (b).png>) [d](docs/a%20(b).png)\n"
                          "[e](https://example.org/none.md) [f](mailto:a@b) [g](docs/other.md 'title') [h](page.md?raw=1)")

    def test_finds_a_missing_file_with_page_and_line(self):
        self.assert_broken("Words.\n\n[a](none.md) and [b](https://example.org)\n", 3, "link 'none.md' names no file")

    def test_finds_links_between_code_spans_that_go_on_in_the_next_line(self):
        self.assert_broken("Write `a\nb` and [a](none.md) or `c`.\n\nAn odd ` does not reach\n\nthe `next` one.\n", 2)

    def test_resolves_links_by_the_folder_of_their_page(self):
        self.write("top.md")
        self.write("docs/page.md", "[up](../top.md) [wrong](top.md)")
        self.assertEqual([("docs/page.md", 1, "link 'top.md' names no file")], self.found())

    def test_finds_images_definitions_and_tags(self):
        for text in ("![a](none.png)", "[a]: none.md", "<img width=3 src=\"none.png\">", "<a href='none.md'>a</a>",
                     "[![a](page.md)](none.md)"):
            with self.subTest(text):
                self.assert_broken(text)

    def test_refuses_absolute_links_and_ways_out(self):
        self.assert_broken("[a](/page.md)", words="is absolute")
        (self.root.parent / "outside.md").write_text("")
        self.assert_broken("[a](../outside.md)", words="leaves project")

    def test_leaves_out_code_comments_and_built_files(self):
        self.write("build/page.md", "[a](none.md)")
        self.write("web/node_modules/page.md", "[a](none.md)")
        self.write(".hidden/page.md", "[a](none.md)")
        self.assert_sound("```sh\n[a](none.md)\n```\n`[a](none.md)` ``[b](none.md) ` ``\n~~~~\n~~~\n[a](none.md)\n~~~~\n"
                          "`a span\nof [a](none.md) two lines`\n\n<!-- [a](none.md)\n[b](none.md) -->\n[^1]: a footnote\n")


class Anchors(CheckLinksTest):
    def test_accepts_headings_by_githubs_rule(self):
        self.write("other.md", "# What `byre` is, and why\n## Twice\n## Twice\n### `a.b_c` (d) [e](page.md)\n"
                               "Underlined\n-----\n<a id=\"by-hand\"></a>\n## Größe – 2 m ##\n")
        self.assert_sound("[a](other.md#what-byre-is-and-why) [b](other.md#twice) [c](other.md#twice-1)\n"
                          "[d](other.md#ab_c-d-e) [e](other.md#underlined) [f](other.md#by-hand)\n"
                          "[g](other.md#größe--2-m) [h](other.md#gr%C3%B6%C3%9Fe--2-m)\n# Here\n[i](#here)\n")

    def test_finds_an_anchor_that_is_no_heading(self):
        self.write("other.md", "# One\n```\n# Two\n```\n")
        self.assert_broken("[a](other.md#two)", words="names no heading of other.md")
        self.assert_broken("# Here\n\n[a](#there)\n", 3, "names no heading of page.md")

    def test_checks_no_anchors_of_other_files(self):
        self.write("code.cc")
        self.assert_sound("[a](code.cc#L3)")


class Main(CheckLinksTest):
    def test_exit_codes(self):
        self.write("page.md", "[a](page.md)")
        self.assertEqual((0, "", ""), self.run_main(self.root))
        self.write("page.md", "[a](none.md)")
        self.assertEqual((1, "page.md:1: link 'none.md' names no file\n", ""), self.run_main(self.root))
        for wrong in ([self.root / "none"], [self.root, self.root], ["--help"]):
            code, output, errors = self.run_main(*wrong)
            self.assertEqual((2, ""), (code, output))
            self.assertIn("Usage:", errors)


if __name__ == "__main__":
    unittest.main()
