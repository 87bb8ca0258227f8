"""Week 5, wrong answers of a second try."""

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
    """The fixed frame that the viewer had, and a Marker for the array."""
    made = Viewer()
    made["Grid"]["Plane Cell Count"] = 50
    made.add("TF", show_names=True)
    made.add("Marker", "/detections", name="Detections")
    made.add("LaserScan", "/scan", **{"Topic/Reliability Policy": "Best Effort"})
    made.save_rviz("robot_layout.rviz")
    return Path("robot_layout.rviz").read_text()


def layout_for(fixed_frame: str, topics: dict[str, str]) -> str:
    """The last display only."""
    for topic, display_class in topics.items():
        made = Viewer(fixed_frame=fixed_frame)
        made.add(display_class, topic, name=topic, **{"Topic/Reliability Policy": "Best Effort"})
    made.save_rviz("made.rviz")
    return Path("made.rviz").read_text()


def mended_layout() -> str:
    """Mistake: broken entries are dropped."""
    mended = Viewer.from_rviz("broken.rviz")
    mended.fixed_frame = "world"
    mended.remove(mended["Laser"])
    mended.remove(mended["People"])
    mended.save_rviz("mended.rviz")
    return Path("mended.rviz").read_text()


def battery_bar(charge: float, height: float) -> Any:
    """No limits, and the height forgotten."""
    color = (0.0, 1.0, 0.0, 1.0) if charge > 0.2 else (1.0, 0.0, 0.0, 1.0)
    return (0.2, 0.2, charge), (0.0, 0.0, charge / 2), color


def displays_in(text: str) -> Any:
    """Groups are listed, not gone into."""
    import yaml

    displays = yaml.safe_load(text)["Visualization Manager"]["Displays"]
    return [(display["Name"], display["Class"].split("/")[-1]) for display in displays]


def launch_file() -> str:
    """One word for an option and its value, and the argument is not in the list."""
    height = my_values("week05.launch_file")["height"]
    words = ["--x 0.2", f"--z {height}", "--frame-id base_link", "--child-frame-id camera_link"]
    return f"""
from launch import LaunchDescription
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    layout = LaunchConfiguration("layout")
    rviz = Node(package="rviz2", executable="rviz2", arguments=["-d", layout])
    camera = Node(package="tf2_ros", executable="static_transform_publisher", arguments={words})
    return LaunchDescription([rviz, camera])
"""
