"""Shows a robot description in RViz, with joint positions set by sliders or zero."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare

PASSED_ON = ("urdf_package", "urdf_package_path")


def generate_launch_description() -> LaunchDescription:
    """Return the description: the robot's nodes, and RViz with the layout."""
    share = FindPackageShare("urdf_launch")
    layout = PathJoinSubstitution([share, "config", "urdf.rviz"])
    has_sliders = LaunchConfiguration("jsp_gui")
    publisher, sliders = "joint_state_publisher", "joint_state_publisher_gui"
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "jsp_gui",
                default_value="true",
                choices=["true", "false"],
                description="Whether sliders move the joints",
            ),
            DeclareLaunchArgument("rviz_config", default_value=layout, description="The layout's path"),
            IncludeLaunchDescription(
                PathJoinSubstitution([share, "launch", "description.launch.py"]),
                launch_arguments=[(name, LaunchConfiguration(name)) for name in PASSED_ON],
            ),
            Node(package=publisher, executable=publisher, condition=UnlessCondition(has_sliders)),
            Node(package=sliders, executable=sliders, condition=IfCondition(has_sliders)),
            Node(package="rviz2", executable="rviz2", arguments=["-d", LaunchConfiguration("rviz_config")]),
        ]
    )
