"""Checks the ROS package without ROS: package.xml, settings of sensors, and launch files.

The launch files run with stand-ins for `launch` and `launch_ros`, which compose the command line of a node by the rules
of launch_ros. This tests the files, not the interface of the real packages.

Usage: package_test.py BYRE SOURCE VERSION      BYRE: the program; SOURCE: the source folder
"""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest
import xml.etree.ElementTree

BYRE, SOURCE, VERSION = str(pathlib.Path(sys.argv[1]).absolute()), pathlib.Path(sys.argv[2]).absolute(), sys.argv[3]
LAUNCH = SOURCE / "ros2/launch"
SENSORS = sorted((SOURCE / "ros2/sensors").glob("*.yaml"))


def node(*arguments, folder=None):
    return subprocess.run([BYRE, "node", *arguments], capture_output=True, text=True, cwd=folder)


class Argument:
    """DeclareLaunchArgument, LaunchConfiguration and included files, on a dictionary of values as context."""

    def __init__(self, name, default_value=None, description=""):
        self.name, self.default, self.description = name, default_value, description

    def perform(self, context):
        return context[self.name]


class Node:
    def __init__(self, *, executable, package=None, name=None, namespace=None, parameters=(), arguments=(), output="log",
                 respawn=False, respawn_delay=None, sigterm_timeout="5"):
        self.executable, self.package, self.name, self.namespace = executable, package, name, namespace
        self.parameters, self.arguments = parameters, arguments

    def command(self, folder):
        """As launch_ros composes it: dictionaries of parameters become files."""
        command = [self.executable, *self.arguments, "--ros-args"]
        command += ["-r", "__node:=" + self.name] if self.name else []
        command += ["-r", "__ns:=/" + self.namespace.lstrip("/")] if self.namespace else []
        for number, given in enumerate(self.parameters):
            path = given
            if isinstance(given, dict):
                path = str(pathlib.Path(folder) / ("parameters_%d.yaml" % number))
                lines = ["  %s: %s" % (key, str(value).lower() if isinstance(value, bool) else "'%s'" % value)
                         for key, value in given.items()]
                full = "/" + "/".join(part for part in (self.namespace or "").split("/") + [self.name] if part)
                pathlib.Path(path).write_text(full + ":\n  ros__parameters:\n" + "".join("  " + l + "\n" for l in lines))
            command += ["--params-file", path]
        return command


def stand_ins():
    def module(name, **content):
        made = types.ModuleType(name)
        made.__dict__.update(content)
        return made

    class Include:
        def __init__(self, source, launch_arguments=()):
            self.source, self.given = source, dict(launch_arguments)

    class Function:
        def __init__(self, *, function):
            self.function = function

    return {
        "launch": module("launch", LaunchDescription=list),
        "launch.actions": module("launch.actions", DeclareLaunchArgument=Argument, IncludeLaunchDescription=Include,
                                 OpaqueFunction=Function),
        "launch.launch_description_sources": module("sources", PythonLaunchDescriptionSource=str),
        "launch.substitutions": module("launch.substitutions", LaunchConfiguration=Argument),
        "launch_ros": module("launch_ros"),
        "launch_ros.actions": module("launch_ros.actions", Node=Node),
    }, Include, Function


def launched(path, given):
    """Nodes that a launch file starts."""
    modules, include, function = stand_ins()
    sys.modules.update(modules)
    spec = importlib.util.spec_from_file_location("launched", path)
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    context, nodes = dict(given), []
    for action in loaded.generate_launch_description():
        if isinstance(action, Argument):
            context.setdefault(action.name, action.default)
        elif isinstance(action, include):
            values = {name: value.perform(context) if isinstance(value, Argument) else value
                      for name, value in action.given.items()}
            nodes += launched(action.source, {**context, **values})
        else:
            nodes += action.function(context)
    return nodes


class Package(unittest.TestCase):
    def test_has_the_version_of_the_project(self):
        package = xml.etree.ElementTree.parse(SOURCE / "package.xml").getroot()
        self.assertEqual(package.findtext("name"), "byre")
        self.assertEqual(package.findtext("version"), VERSION)
        self.assertEqual(package.findtext("export/build_type"), "cmake")


class Sensors(unittest.TestCase):
    def test_are_without_faults(self):
        self.assertGreaterEqual({path.stem for path in SENSORS}, {"realsense_d435", "realsense_d435_rgbd", "oak_d", "zed2", "turtlebot4"})
        for path in SENSORS:
            with self.subTest(sensor=path.stem):
                checked = node("--check", "--ros-args", "--params-file", str(path), "-p", "slam.task:=map",
                               "-p", "slam.save:=made.byre")
                self.assertEqual((checked.returncode, checked.stderr), (0, ""))

    def test_have_a_pair_of_rectified_images_or_depth(self):
        for path in SENSORS:
            with self.subTest(sensor=path.stem):
                printed = node("--print-config", "--ros-args", "--params-file", str(path), "-p", "slam.task:=map",
                               "-p", "slam.save:=made.byre").stdout
                has_depth = "  depth: /" in printed
                self.assertIn("rectified: true" if not has_depth else "rectified: false", printed)
                self.assertEqual(has_depth, path.stem.endswith("_rgbd"))
                self.assertNotIn(": /left/", printed)
                self.assertNotIn(": /right/", printed)


class LaunchFiles(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder.name)

    def settings(self, file, **given):
        nodes = launched(LAUNCH / file, given)
        command = nodes[0].command(self.folder.name)
        self.assertEqual(command[:2], ["byre", "node"])
        printed = node(*command[2:], "--print-config", folder=self.folder.name)
        self.assertEqual((printed.returncode, printed.stderr), (0, ""))
        return [line.split("  #")[0].strip() for line in printed.stdout.splitlines()], nodes

    def test_mission_localises_on_a_map(self):
        settings, nodes = self.settings("mission.launch.py", map="barn.byre", sensor="oak_d")
        self.assertIn("task: mission", settings)
        self.assertIn("map: %s/barn.byre" % os.getcwd(), settings)
        self.assertIn("left: /oak/left/image_rect", settings)
        self.assertEqual(len(nodes), 1)

    def test_mapping_makes_a_map(self):
        for sensor in SENSORS:
            with self.subTest(sensor=sensor.stem):
                settings, _ = self.settings("mapping.launch.py", save="made.byre", sensor=sensor.stem)
                self.assertIn("task: map", settings)
                self.assertIn("save: %s/made.byre" % os.getcwd(), settings)

    def test_mapping_extends_a_map(self):
        settings, _ = self.settings("mapping.launch.py", task="extend", map="barn.byre", save="more.byre")
        self.assertIn("task: extend", settings)

    def test_namespace_moves_topics_of_transforms(self):
        settings, _ = self.settings("mission.launch.py", map="barn.byre", namespace="robot1", name="eyes")
        self.assertIn("namespace: /robot1", settings)
        self.assertIn("name: eyes", settings)
        self.assertIn("tf: /robot1/tf", settings)

    def test_files_are_read_in_order(self):
        pathlib.Path("robot.yaml").write_text("slam:\n  map: first.byre\nframes:\n  base: chassis\n  odom: first\n")
        pathlib.Path("more.yaml").write_text("/**:\n  ros__parameters:\n    frames:\n      odom: second\n")
        settings, _ = self.settings("mission.launch.py", config="robot.yaml", params_file="more.yaml", map="last.byre")
        self.assertIn("map: %s/last.byre" % os.getcwd(), settings)
        self.assertIn("base: chassis", settings)
        self.assertIn("odom: second", settings)

    def test_rviz_is_started_on_request(self):
        _, nodes = self.settings("mission.launch.py", map="barn.byre", rviz="true")
        self.assertEqual(nodes[1].package, "rviz2")
        self.assertTrue(pathlib.Path(nodes[1].arguments[1]).is_file())

    def test_unknown_sensors_and_tasks_are_refused(self):
        with self.assertRaisesRegex(RuntimeError, "sensor:=no_such"):
            launched(LAUNCH / "mission.launch.py", {"map": "barn.byre", "sensor": "no_such"})
        with self.assertRaisesRegex(RuntimeError, "task:=drive"):
            launched(LAUNCH / "mapping.launch.py", {"task": "drive"})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
