"""Week 5, wrong answers of a first try."""

from pathlib import Path
from typing import Any

from course_lib import Viewer
from course_lib.grading import my_values

BROKEN = """Visualization Manager:
  Global Options:
    Fixed Frame: wolrd
  Displays:
    - {Class: rviz_default_plugins/Grid, Name: Floor, Color: 100; 100; 200}
    - {Class: rviz_default_plugins/TF, Name: Frames, Enabled: false, Marker Scale: 1}
    - Class: rviz_default_plugins/LaserScan
      Name: Laser
      Topic: {Value: /scan, Reliability Policy: Reliable}
    - {Class: rviz_default_plugins/MarkerArray, Name: People, Topic: {Value: /detection}}
  Views:
    Current: {Class: rviz_default_plugins/Orbit, Distance: 900}
"""
Path("broken.rviz").write_text(BROKEN)


def robot_layout() -> str:
    """All displays by the Add button, none of their properties set."""
    made = Viewer(fixed_frame="world")
    made.add("TF")
    made.add("MarkerArray", "/detections")
    made.add("LaserScan", "/scan")
    made.save_rviz("robot_layout.rviz")
    return Path("robot_layout.rviz").read_text()


def layout_for(fixed_frame: str, topics: dict[str, str]) -> str:
    """Made for the example."""
    made = Viewer(fixed_frame="odom")
    made.add("LaserScan", "/front/scan", name="/front/scan", **{"Topic/Reliability Policy": "Best Effort"})
    made.add("Path", "/plan", name="/plan")
    made.save_rviz("made.rviz")
    return Path("made.rviz").read_text()


def mended_layout() -> str:
    """Only what is red."""
    mended = Viewer.from_rviz("broken.rviz")
    mended.fixed_frame = "world"
    mended.save_rviz("mended.rviz")
    return Path("mended.rviz").read_text()


def battery_bar(charge: float, height: float) -> Any:
    """The bar hangs half below the ground."""
    color = (0.0, 1.0, 0.0, 1.0) if charge >= 0.2 else (1.0, 0.0, 0.0, 1.0)
    return (0.2, 0.2, charge * height), (0.0, 0.0, 0.0), color


def displays_in(text: str) -> Any:
    """By the text alone."""
    names = [line.split("Name: ")[1].split(",")[0] for line in text.splitlines() if "Name: " in line]
    classes = [line.split("Class: ")[1].split(",")[0] for line in text.splitlines() if "Class: " in line]
    return [(name, cls.split("/")[-1]) for name, cls in zip(names, classes, strict=False)]


def launch_file() -> str:
    """The layout's name is written twice, instead of the argument's value."""
    height = my_values("week05.launch_file")["height"]
    words = ["--x", "0.2", "--z", str(height), "--frame-id", "base_link", "--child-frame-id", "camera_link"]
    return f"""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("layout", default_value="robot_layout.rviz"),
        Node(package="rviz2", executable="rviz2", arguments=["-d", "robot_layout.rviz"]),
        Node(package="tf2_ros", executable="static_transform_publisher",
             name="camera_frame", arguments={words}),
    ])
"""
