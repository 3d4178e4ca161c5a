"""Makes a map, saved on the command save and at the end, or extends one with task:=extend map:=barn.byre:

    ros2 launch byre mapping.launch.py save:=barn.byre sensor:=realsense_d435
"""
import pathlib

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration

NODE = str(pathlib.Path(__file__).resolve().parent / "byre.launch.py")


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("task", default_value="map", description="map, or extend with map:=FILE"),
        IncludeLaunchDescription(PythonLaunchDescriptionSource(NODE),
                                 launch_arguments={"task": LaunchConfiguration("task")}.items())])
