"""Starts `byre node` together with other ROS 2 nodes:

    ros2 launch ros2/launch/byre.launch.py config:=robot.yaml [rviz:=true]

byre needs no ROS, so it is started as a process from the PATH, not from a ROS package.
"""
import pathlib

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition
from launch.substitutions import EnvironmentVariable, LaunchConfiguration

RVIZ = str(pathlib.Path(__file__).resolve().parent.parent / "rviz" / "byre.rviz")


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("config", description="settings, as `byre node --print-config` prints them"),
        DeclareLaunchArgument("rviz", default_value="false", description="whether to start rviz2 as well"),
        DeclareLaunchArgument("ros_distro", default_value=EnvironmentVariable("ROS_DISTRO", default_value="jazzy")),
        ExecuteProcess(
            cmd=["byre", "node", "--config", LaunchConfiguration("config"),
                 "--ros-distro", LaunchConfiguration("ros_distro")],
            name="byre", output="screen", respawn=True, respawn_delay=1.0, sigterm_timeout="60"),
        ExecuteProcess(cmd=["rviz2", "-d", RVIZ], name="rviz2", condition=IfCondition(LaunchConfiguration("rviz"))),
    ])
