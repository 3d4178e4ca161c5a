#!/usr/bin/env python3
"""Tests of unity_groups.py on files in a temporary folder."""
import contextlib
import io
import pathlib
import tempfile
import unittest

import unity_groups

LOCAL = "namespace byre {\nnamespace {\n\n%s\n}\n}\n"


class UnityGroupsTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.source = pathlib.Path(self.folder.name) / "src"

    def write(self, name, text):
        path = self.source / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    def groups(self, files, size=16):
        return unity_groups.groups_of(files, size, self.source, self.source / "public")

    def test_files_with_a_common_local_name_are_apart(self):
        files = [self.write("map/a.cc", LOCAL % "constexpr double kLeast = 1;"),
                 self.write("map/b.cc", LOCAL % "const int kLeast = 2;"),
                 self.write("map/c.cc", LOCAL % "struct Scene {\n};"),
                 self.write("map/d.cc", LOCAL % "class Scene {\n};")]
        self.assertEqual([0, 1, 0, 1], self.groups(files))

    def test_a_group_has_no_more_files_than_given(self):
        files = [self.write(f"map/{i}.cc", "namespace byre {}\n") for i in range(5)]
        self.assertEqual([0, 0, 1, 1, 2], self.groups(files, 2))

    def test_functions_of_different_types_of_byre_may_share_a_group(self):
        files = [self.write("map/a.cc", LOCAL % "int size(const Map& map) {\n}"),
                 self.write("map/b.cc", LOCAL % "int size(const Frame& frame) {\n}"),
                 self.write("map/c.cc", LOCAL % "int size(const Map& map) {\n}"),
                 self.write("map/d.cc", LOCAL % "int size(int x) {\n}"),
                 self.write("map/e.cc", LOCAL % "int size(double x) {\n}")]
        self.assertEqual([0, 0, 1, 0, 1], self.groups(files))

    def test_aliases_of_one_type_may_share_a_group(self):
        files = [self.write("map/a.cc", LOCAL % "using Json = nlohmann::json;"),
                 self.write("map/b.cc", LOCAL % "using Json = nlohmann::ordered_json;"),
                 self.write("map/c.cc", LOCAL % "using Json = nlohmann::json;")]
        self.assertEqual([0, 1, 0], self.groups(files))

    def test_a_local_name_is_apart_from_files_whose_headers_declare_it(self):
        self.write("geometry/pose.h", "namespace byre {\n\nconstexpr double kFar = 1;\nPose inverse(int x);\n}\n")
        self.write("map/map.h", '#include "byre/geometry/pose.h"\n')
        files = [self.write("map/a.cc", '#include "byre/map/map.h"\n'),
                 self.write("map/b.cc", LOCAL % "constexpr double kFar = 2;"),
                 self.write("map/c.cc", LOCAL % "Pose inverse(int x) {\n}"),
                 self.write("map/d.cc", LOCAL % "Pose other(int x) {\n}")]
        self.assertEqual([0, 1, 1, 0], self.groups(files))

    def test_the_program_prints_the_group_of_each_file(self):
        path = self.write("map/a.cc", "namespace byre {}\n")
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            self.assertEqual(0, unity_groups.main([str(self.source), str(self.source), "16", str(path)]))
        self.assertEqual("0\n", output.getvalue())

    def test_wrong_usage_has_code_2(self):
        with contextlib.redirect_stderr(io.StringIO()):
            self.assertEqual(2, unity_groups.main(["src", "include", "many"]))


if __name__ == "__main__":
    unittest.main()
