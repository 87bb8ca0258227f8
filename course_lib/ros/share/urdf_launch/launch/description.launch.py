"""Starts robot_state_publisher with the description in a package: URDF or xacro."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import Command, LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Return the description: an argument for the package, one for the path, and the node."""
    share = FindPackageShare(LaunchConfiguration("urdf_package"))
    path = PathJoinSubstitution([share, LaunchConfiguration("urdf_package_path")])
    description = ParameterValue(Command(["xacro ", path]), value_type=str)
    return LaunchDescription(
        [
            DeclareLaunchArgument("urdf_package", description="The package that holds the description"),
            DeclareLaunchArgument("urdf_package_path", description="The path of the description in it"),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{"robot_description": description}],
            ),
        ]
    )
