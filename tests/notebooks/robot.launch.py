"""A launch file with an argument."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.substitutions import LaunchConfiguration


def generate_launch_description() -> LaunchDescription:
    speed = LaunchConfiguration("speed")
    return LaunchDescription([DeclareLaunchArgument("speed", default_value="1.0"), LogInfo(msg=speed)])
