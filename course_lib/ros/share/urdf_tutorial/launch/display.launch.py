"""Shows the description given by `model`, a path in this package or an absolute path."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    """Return the description: the arguments, and urdf_launch's display of the model."""
    display = PathJoinSubstitution([FindPackageShare("urdf_launch"), "launch", "display.launch.py"])
    layout = PathJoinSubstitution([FindPackageShare("urdf_launch"), "config", "urdf.rviz"])
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "gui",
                default_value="true",
                choices=["true", "false"],
                description="Whether sliders move the joints",
            ),
            DeclareLaunchArgument("rvizconfig", default_value=layout, description="The layout's path"),
            DeclareLaunchArgument(
                "model",
                default_value="urdf/01-myfirst.urdf",
                description="The description: a path in urdf_tutorial, or an absolute path",
            ),
            IncludeLaunchDescription(
                display,
                launch_arguments=[
                    ("urdf_package", "urdf_tutorial"),
                    ("urdf_package_path", LaunchConfiguration("model")),
                    ("rviz_config", LaunchConfiguration("rvizconfig")),
                    ("jsp_gui", LaunchConfiguration("gui")),
                ],
            ),
        ]
    )
