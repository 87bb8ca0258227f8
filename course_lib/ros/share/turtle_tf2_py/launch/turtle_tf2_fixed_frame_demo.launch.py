"""The second turtle follows a frame that is attached to the first one."""

from ament_index_python.packages import get_package_share_path
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Return the demo with `carrot1` as the target frame, and the broadcaster of that frame."""
    demo = get_package_share_path("turtle_tf2_py") / "launch" / "turtle_tf2_demo.launch.py"
    return LaunchDescription(
        [
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(demo), launch_arguments={"target_frame": "carrot1"}.items()
            ),
            Node(package="turtle_tf2_py", executable="fixed_frame_tf2_broadcaster", name="carrot"),
        ]
    )
