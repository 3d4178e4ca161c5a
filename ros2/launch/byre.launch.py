"""Starts `byre node`, and RViz on request. Included by mission.launch.py and mapping.launch.py.

The program is the one installed with this file, else the one in the PATH.
"""
import pathlib

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

FILES = pathlib.Path(__file__).resolve().parent.parent  # PREFIX/share/byre/ros2
TASKS = ["mission", "extend", "map"]
ARGUMENTS = {
    "task": ("mission", "mission on a map, extend a map, or make a map"),
    "map": ("", "map to localise in, or to extend"),
    "save": ("", "file of the map made"),
    "sensor": ("", "settings of a sensor or robot: " + ", ".join(sorted(
        path.stem for path in (FILES / "sensors").glob("*.yaml")))),
    "params_file": ("", "parameter file of ROS with settings below ros__parameters, read after those of the sensor"),
    "config": ("", "settings file as printed by byre node --print-config, read first"),
    "namespace": ("", "namespace of the node and of tf, tf_static, map and initialpose"),
    "name": ("byre", "name of the node"),
    "log_level": ("info", "debug, info, warn, error or fatal"),
    "respawn": ("false", "whether to start the node again after it has ended"),
    "rviz": ("false", "whether to start rviz2"),
}


def absolute(path):
    return str(pathlib.Path(path).expanduser().absolute())


def start(context):
    given = {name: LaunchConfiguration(name).perform(context).strip() for name in ARGUMENTS}
    if given["task"] not in TASKS:
        raise RuntimeError("task:=%s is none of %s" % (given["task"], ", ".join(TASKS)))
    settings = {"slam.task": given["task"]}
    for name in ("map", "save"):
        if given[name]:
            settings["slam." + name] = absolute(given[name])
    if given["namespace"]:
        settings["topics.in_namespace"] = True
    parameters = []
    if given["sensor"]:
        parameters.append(str(FILES / "sensors" / (given["sensor"] + ".yaml")))
        if not pathlib.Path(parameters[-1]).is_file():
            raise RuntimeError("sensor:=%s has no file %s" % (given["sensor"], parameters[-1]))
    if given["params_file"]:
        parameters.append(absolute(given["params_file"]))
    parameters.append(settings)
    arguments = ["--config", absolute(given["config"])] if given["config"] else []
    installed = FILES.parents[2] / "lib" / "byre" / "node"
    program, command = (str(installed), []) if installed.is_file() else ("byre", ["node"])
    nodes = [Node(
        executable=program, name=given["name"], namespace=given["namespace"], parameters=parameters,
        arguments=command + arguments + ["--ros-args", "--log-level", given["log_level"]],
        output="screen", respawn=given["respawn"].lower() == "true", respawn_delay=1.0, sigterm_timeout="60")]
    if given["rviz"].lower() == "true":
        nodes.append(Node(package="rviz2", executable="rviz2", arguments=["-d", str(FILES / "rviz" / "byre.rviz")]))
    return nodes


def generate_launch_description():
    declared = [DeclareLaunchArgument(name, default_value=default, description=meaning)
                for name, (default, meaning) in ARGUMENTS.items()]
    return LaunchDescription(declared + [OpaqueFunction(function=start)])
