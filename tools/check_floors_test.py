#!/usr/bin/env python3
"""Tests of check_floors.py on small generated trees."""
import contextlib
import io
import pathlib
import tempfile
import unittest

import check_floors


class CheckFloorsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.source = pathlib.Path(folder.name)

    def write(self, name, text):
        path = self.source / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def found(self):
        return [(fault.path.relative_to(self.source).as_posix(), fault.line, fault.message)
                for fault in check_floors.faults(self.source)]

    def assert_one_fault(self, name, line, words):
        found = self.found()
        self.assertEqual([(name, line)], [fault[:2] for fault in found])
        self.assertIn(words, found[0][2])

    def run_main(self, *arguments):
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            code = check_floors.main([str(argument) for argument in arguments])
        return code, output.getvalue(), errors.getvalue()


class Types(CheckFloorsTest):
    def defined(self, text):
        return list(check_floors.definitions(text))

    def test_types_have_their_namespace_and_line(self):
        text = "namespace byre {\n// struct No {\nstruct Light { double s; };\nenum class Kind : int { a };\n}\n"
        self.assertEqual([("byre::Light", 3), ("byre::Kind", 4)], self.defined(text))

    def test_definitions_inside_types_and_functions_are_ignored(self):
        text = ("namespace byre {\nclass A final : public B {\n struct Impl { int x; };\n};\n"
                "int f(Map map) {\n struct C {}; }\n}\n")
        self.assertEqual([("byre::A", 2), ("byre::f(Map)", 5)], self.defined(text))

    def test_declared_types_are_not_defined(self):
        self.assertEqual([("byre::f()", 3)],
                         self.defined("namespace byre {\nclass Map;\nvoid f(const std::string& t);\n}\n"))

    def test_two_headers_that_define_one_name_are_a_fault(self):
        self.write("camera/exposure.h", "namespace byre {\nstruct Exposure {\n};\n}\n")
        self.write("simulation/sensor.h", "namespace byre {\n\nstruct Exposure {\n};\n}\n")
        self.write("io/ros/types.h", "namespace byre::ros {\nstruct Exposure {\n};\n}\n")
        self.write("camera/exposure.cc", "namespace byre {\nnamespace {\nstruct Local {\n};\n}\n}\n")
        found = list(check_floors.twice_defined_faults(sorted(self.source.rglob("*.h"))))
        self.assertEqual([("sensor.h", 3)], [(fault.path.name, fault.line) for fault in found])
        self.assertIn("byre::Exposure is also defined in", found[0].message)
        code, output, _ = self.run_main(self.source)
        self.assertEqual(1, code)
        self.assertIn("Exposure", output)


class Floors(CheckFloorsTest):
    def test_lower_floors_and_the_own_room_may_be_included(self):
        self.write("map/map.cc", '#include "byre/map/map.h"\n#include "byre/features/features.h"\n')
        self.write("geometry/camera.cc", '#include "byre/base/text_file.h"\n')
        self.write("io/recording/euroc.cc", '#include "byre/io/image/image_file.h"\n'
                                            '#include "byre/geometry/evaluation/evaluate.h"\n')
        self.assertEqual([], self.found())

    def test_a_higher_floor_is_a_fault_with_its_line(self):
        self.write("geometry/evaluation/error.cc", '#include "byre/geometry/pose.h"\n\n#include "byre/map/map.h"\n')
        self.assert_one_fault("geometry/evaluation/error.cc", 3, "geometry (floor 1) must not include map (floor 3)")

    def test_a_neighbour_on_the_same_floor_is_a_fault(self):
        self.write("optimise/bundle.cc", '#include "byre/features/image.h"\n')
        self.assert_one_fault("optimise/bundle.cc", 1, "both are on floor 2")

    def test_base_lies_below_everything(self):
        self.write("base/input_error.h", '#include "byre/geometry/pose.h"\n')
        self.assert_one_fault("base/input_error.h", 1, "must not include geometry")

    def test_tests_keep_to_the_floors_too(self):
        self.write("geometry/pose_test.cc", '#include "byre/slam/tracking/tracking.h"\n')
        self.assert_one_fault("geometry/pose_test.cc", 1, "must not include slam")

    def test_an_include_of_an_unknown_room_is_a_fault(self):
        self.write("map/map.cc", '#include "byre/util/strings.h"\n')
        self.assert_one_fault("map/map.cc", 1, "unknown room 'util'")

    def test_a_folder_that_is_no_room_is_a_fault(self):
        self.write("common/strings.cc", "int x;\n")
        self.assert_one_fault("common/strings.cc", 1, "'common' has no floor")

    def test_a_file_outside_all_rooms_is_a_fault(self):
        self.write("version.h", "int x;\n")
        self.assert_one_fault("version.h", 1, "is in no room")


class Circles(CheckFloorsTest):
    def circles(self):
        return [fault.path.relative_to(self.source).as_posix() for fault in check_floors.circle_faults(self.source)]

    def test_folders_of_a_room_must_not_include_each_other_through_others(self):
        self.write("slam/a/a.cc", '#include "byre/slam/b/b.h"\n')
        self.write("slam/b/b.cc", '#include "byre/slam/c/c.h"\n')
        self.assertEqual([], self.circles())
        self.write("slam/c/c.cc", '#include "byre/slam/a/a.h"\n')
        self.assertEqual(["slam/a/a.cc", "slam/b/b.cc", "slam/c/c.cc"], self.circles())
        code, output, _ = self.run_main(self.source)
        self.assertEqual(1, code)
        self.assertIn("slam/a must not include slam/b", output)

    def test_tests_and_files_directly_in_the_room_may_include_any_of_its_folders(self):
        self.write("slam/a/a.cc", '#include "byre/slam/b/b.h"\n#include "byre/slam/options.h"\n')
        self.write("slam/b/b_test.cc", '#include "byre/slam/a/a.h"\n')
        self.write("slam/options.cc", '#include "byre/slam/a/a.h"\n')
        self.assertEqual([], self.circles())


class Fences(CheckFloorsTest):
    def test_fenced_headers_are_faults_outside_their_rooms(self):
        for header in ("thread", "mutex", "ceres/ceres.h", "opencv2/core.hpp", "iostream", "nlohmann/json.hpp",
                       "yaml-cpp/yaml.h", "fstream", "CLI/CLI.hpp"):
            with self.subTest(header=header):
                self.write("slam/tracking/tracking.cc", f"#include <{header}>\n")
                self.assert_one_fault("slam/tracking/tracking.cc", 1, f"must not include <{header}>")

    def test_fenced_headers_are_allowed_in_their_rooms(self):
        self.write("base/executor.cc", "#include <thread>\n#include <mutex>\n")
        self.write("optimise/bundle.cc", "#include <ceres/ceres.h>\n")
        self.write("features/extract.cc", "#include <opencv2/imgproc.hpp>\n")
        self.write("cli/main.cc", "#include <iostream>\n#include <CLI/CLI.hpp>\n")
        self.write("cli/map/command.cc", "#include <CLI/CLI.hpp>\n")
        self.write("playback/report/report.h", "#include <nlohmann/json.hpp>\n")
        self.write("playback/map_run.cc", "#include <thread>\n")
        self.assertEqual([], self.found())

    def test_a_header_of_one_folder_is_a_fault_elsewhere_in_the_room(self):
        self.write("playback/archive/register_map.cc", "#include <nlohmann/json.hpp>\n")
        self.assert_one_fault("playback/archive/register_map.cc", 1, "playback/archive must not include <nlohmann")

    def test_a_header_of_files_directly_in_the_room_is_a_fault_in_its_folders(self):
        self.write("playback/archive/register_map.cc", "#include <thread>\n")
        self.assert_one_fault("playback/archive/register_map.cc", 1, "only allowed in base")

    def test_public_headers_may_include_paths_but_no_threads(self):
        header = self.source / "slam.h"
        for name, count in (("filesystem", 0), ("thread", 1), ("fstream", 1), ("opencv2/core.hpp", 2)):
            with self.subTest(name=name):
                self.write("slam.h", f"#include <{name}>\n")
                self.assertEqual(count, len(list(check_floors.public_faults(header))))

    def test_quotes_do_not_get_round_a_fence(self):
        self.write("slam/tracking/tracking.cc", '#include "opencv2/core.hpp"\n')
        self.assert_one_fault("slam/tracking/tracking.cc", 1, "opencv2/core.hpp")

    def test_spaces_do_not_get_round_a_fence(self):
        self.write("slam/tracking/tracking.cc", "#  include  <thread>\n")
        self.assert_one_fault("slam/tracking/tracking.cc", 1, "thread")

    def test_tests_may_include_fenced_headers(self):
        self.write("geometry/camera_test.cc", "#include <opencv2/calib3d.hpp>\n#include <fstream>\n")
        self.assertEqual([], self.found())


class ForbiddenCalls(CheckFloorsTest):
    def test_printing_below_cli_is_a_fault(self):
        for call in ("std::cout << 1;", 'printf("x");', 'std::fprintf(stderr, "x");', "std::cerr << 1;", 'puts("x");'):
            with self.subTest(call=call):
                self.write("map/map.cc", f"void f() {{\n  {call}\n}}\n")
                self.assert_one_fault("map/map.cc", 2, "only cli prints")

    def test_leaving_the_program_below_cli_is_a_fault(self):
        for call in ("exit(1);", "std::exit(1);", "std::abort();", "std::terminate();"):
            with self.subTest(call=call):
                self.write("map/map.cc", f"void f() {{ {call} }}\n")
                self.assert_one_fault("map/map.cc", 1, "only cli ends the program")

    def test_cli_may_print_and_exit(self):
        self.write("cli/main.cc", 'int main() { std::cout << 1; printf("x"); std::exit(1); }\n')
        self.assertEqual([], self.found())

    def test_unseeded_randomness_is_a_fault_everywhere(self):
        for call in ("std::random_device device;", "int x = rand();", "std::srand(1);"):
            with self.subTest(call=call):
                self.write("cli/main.cc", f"void f() {{ {call} }}\n")
                self.assert_one_fault("cli/main.cc", 1, "seed")

    def test_json_text_with_control_characters_is_a_fault(self):
        self.write("ros2/node/node.cc", "auto text = json.dump(2);\n")
        self.assert_one_fault("ros2/node/node.cc", 1, "printable_json")
        self.write("ros2/node/node.cc", "auto text = dumped(json, 2);\n")
        self.assertEqual([], self.found())

    def test_names_that_only_resemble_a_call_are_no_fault(self):
        self.write("map/map.cc",
                   "int a = std::snprintf(b, 1, c); on_exit(1); region.exit(2); my_printf(x); brand(3);\n")
        self.assertEqual([], self.found())

    def test_comments_and_strings_are_not_code(self):
        self.write("map/map.cc", '// printf(1)\n/* exit(1)\n std::cout */\nauto s = "std::cout // exit(1)";\n')
        self.assertEqual([], self.found())

    def test_raw_strings_and_quote_characters_do_not_hide_the_code_after_them(self):
        self.write("map/map.cc", "auto a = R\"(exit(1);\nprintf(2) // \" )\";\nchar b = '\"';\nvoid f() { abort(); }\n")
        self.assert_one_fault("map/map.cc", 4, "abort")

    def test_lines_are_counted_through_block_comments(self):
        self.write("map/map.cc", "/* one\n two\n three */\nvoid f() { exit(1); }\n")
        self.assert_one_fault("map/map.cc", 4, "exit")


class Main(CheckFloorsTest):
    def test_returns_zero_when_all_rules_hold(self):
        self.write("geometry/pose.h", "#include <vector>\n")
        code, output, _ = self.run_main(self.source)
        self.assertEqual(0, code)
        self.assertIn("1 files, no faults", output)

    def test_returns_one_and_names_file_and_line_of_each_fault(self):
        self.write("geometry/pose.h", "#include <thread>\n#include <iostream>\n")
        code, output, _ = self.run_main(self.source)
        self.assertEqual(1, code)
        self.assertIn("pose.h:1: ", output)
        self.assertIn("pose.h:2: ", output)
        self.assertIn("1 files, 2 faults", output)

    def test_returns_two_when_there_is_nothing_to_check(self):
        for folder in (self.source, self.source / "absent"):
            code, _, errors = self.run_main(folder)
            self.assertEqual(2, code)
            self.assertIn("no .h or .cc file", errors)

    def test_returns_two_with_the_usage_on_wrong_arguments(self):
        code, _, errors = self.run_main("one", "two")
        self.assertEqual(2, code)
        self.assertIn("Usage", errors)


if __name__ == "__main__":
    unittest.main()
