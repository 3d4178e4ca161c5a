#!/usr/bin/env python3
"""Tests of check_comments.py on small generated trees."""
import contextlib
import io
import pathlib
import tempfile
import unittest

import check_comments


class CheckCommentsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.source = pathlib.Path(folder.name)

    def write(self, text, name="map/map.h"):
        path = self.source / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def found(self, text):
        return [(fault.line, fault.message) for fault in check_comments.file_faults(self.write(text))]

    def assert_one_fault(self, text, line, words):
        found = self.found(text)
        self.assertEqual([line], [fault[0] for fault in found])
        self.assertIn(words, found[0][1])

    def assert_stands_alone(self, comment):
        self.assertEqual([], self.found(f"int a = 1;  // metres\nint b = 2;  // {comment}\nint c = 3;  // pixels\n"))

    def run_main(self, *arguments):
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            code = check_comments.main([str(argument) for argument in arguments])
        return code, output.getvalue(), errors.getvalue()


class FirstWords(CheckCommentsTest):
    def test_a_comment_that_begins_without_its_noun_is_a_fault_with_its_line(self):
        for comment in ("of those", "and the last one", "or reading depths", "that were looked at", "likewise",
                        "else whole pixels", "which closes it", "they lie on a line", "by which it is late",
                        "the same with a sigma", "same", "both", "too", "Of the lens"):
            with self.subTest(comment=comment):
                self.assert_one_fault(f"int a = 1;\nint b = 2;  // {comment}\n", 2, "refers to the line above")

    def test_a_noun_phrase_may_begin_with_a_word_like_them(self):
        for comment in ("both cameras' gain, ratio", "too few points hold the pose", "which of the recordings",
                        "the same in both images", "offset, pixels", "origin of the map", "bytes of the header",
                        "android", "tool", "by rows", "took no part", "in the frustum"):
            with self.subTest(comment=comment):
                self.assert_stands_alone(comment)

    def test_a_comment_on_a_line_of_its_own_may_not_begin_with_of(self):
        self.assert_one_fault("int a = 1;\n\n// Of the position, square metres.\nint b = 2;\n", 3, "name the noun")

    def test_prose_may_begin_with_other_words_and_any_of_its_further_lines_with_of(self):
        self.assertEqual([], self.found("// And so on: what is kept\n// of the map. The same\n// Of both.\nint a;\n"))


class Pointing(CheckCommentsTest):
    def test_a_word_that_points_to_another_line_is_a_fault_wherever_it_stands(self):
        for comment in ("from format 3 on; likewise empty", "frames, as above", "every n-th frame of those"):
            with self.subTest(comment=comment):
                self.assert_one_fault(f"int a = 1;  // {comment}\n", 1, "points to another line")


class RunningOn(CheckCommentsTest):
    def test_a_comment_that_is_finished_behind_the_next_line_of_code_is_a_fault(self):
        for end in ("sizes,", "sizes and", "seen in the"):
            with self.subTest(end=end):
                text = f"int a = 1;  // height in {end}\nint b = 2;  // pixels\n"
                self.assert_one_fault(text, 1, "continues in the comment")

    def test_a_comment_that_goes_on_in_the_column_below_is_a_fault(self):
        text = "int a = 1;  // one per edge:\n            // squared sigmas\n"
        self.assert_one_fault(text, 1, "continues on the next line")

    def test_comments_one_below_the_other_are_none(self):
        self.assertEqual([], self.found("int a = 1;  // metres\nint b = 2;  // pixels\n// A sentence.\nint c = 3;\n"))

    def test_a_comma_at_the_end_is_none_where_no_comment_follows(self):
        self.assertEqual([], self.found("int a = 1;  // metres,\nint b = 2;\n"))


class WhatIsAComment(CheckCommentsTest):
    def test_strings_are_not(self):
        self.assertEqual([], self.found('auto a = "http://x  // of those";\nauto b = R"(\n1  // of those\n)";\n'))

    def test_a_comment_behind_a_string_is(self):
        self.assert_one_fault('auto a = "http://x \\"";  // of those\n', 1, "'of'")

    def test_what_is_meant_for_tools_is_not(self):
        self.assertEqual([], self.found("int a;  // NOLINT(of those)\nb <<  //\n    1;\n}  // namespace\n"))

    def test_lines_are_counted_through_block_comments_and_raw_strings(self):
        self.assert_one_fault('/* one\n two */\nauto a = R"(\n)";\nint b;  // of those\n', 5, "'of'")


class Main(CheckCommentsTest):
    def test_returns_zero_when_all_comments_stand_alone(self):
        self.write("int a = 1;  // metres\n")
        code, output, _ = self.run_main(self.source)
        self.assertEqual(0, code)
        self.assertIn("1 files, no faults", output)

    def test_returns_one_and_names_file_and_line_of_each_fault_in_all_folders(self):
        self.write("int a = 1;  // of those\n", "map/map.h")
        self.write("int a = 1;\nint b = 1;  // likewise\n", "place/place.cc")
        code, output, _ = self.run_main(self.source / "map", self.source / "place")
        self.assertEqual(1, code)
        self.assertIn("map.h:1: ", output)
        self.assertIn("place.cc:2: ", output)
        self.assertIn("2 files, 2 faults", output)

    def test_returns_two_when_a_folder_has_nothing_to_check(self):
        self.write("int a;\n")
        code, _, errors = self.run_main(self.source, self.source / "absent")
        self.assertEqual(2, code)
        self.assertIn("no .h or .cc file", errors)

    def test_returns_two_with_the_usage_on_options(self):
        code, _, errors = self.run_main("--all")
        self.assertEqual(2, code)
        self.assertIn("Usage", errors)


if __name__ == "__main__":
    unittest.main()
