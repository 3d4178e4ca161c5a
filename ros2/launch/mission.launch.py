"""Localises on a map:

    ros2 launch byre mission.launch.py map:=barn.byre sensor:=realsense_d435
"""
import pathlib

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource

NODE = str(pathlib.Path(__file__).resolve().parent / "byre.launch.py")


def generate_launch_description():
    return LaunchDescription([
        IncludeLaunchDescription(PythonLaunchDescriptionSource(NODE), launch_arguments={"task": "mission"}.items())])
