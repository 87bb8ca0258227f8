"""Week 5, another right solution."""

from pathlib import Path
from typing import Any

import numpy as np
import yaml

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
    """The file, as somebody who knows YAML writes it."""
    distance = my_values("week05.robot_layout")["distance"]
    return f"""
Visualization Manager:
  Displays:
    - {{Class: rviz_default_plugins/Grid, Name: Grid, Plane Cell Count: 50}}
    - Class: rviz_common/Group
      Name: Robot
      Displays:
        - {{Class: rviz_default_plugins/TF, Name: TF, Show Names: true, Enabled: true}}
        - {{Class: rviz_default_plugins/MarkerArray, Name: Detections, Topic: {{Value: /detections}}}}
        - Class: rviz_default_plugins/LaserScan
          Name: Laser
          Topic: {{Value: /scan, Reliability Policy: Best Effort}}
  Global Options: {{Fixed Frame: world}}
  Views:
    Current: {{Class: rviz_default_plugins/Orbit, Distance: {distance}}}
"""


def layout_for(fixed_frame: str, topics: dict[str, str]) -> str:
    made = Viewer(fixed_frame)
    made.remove(made["Grid"])
    for topic in sorted(topics):
        sensor = topics[topic] in ("LaserScan", "PointCloud2")
        policy = "Best Effort" if sensor else "Reliable"
        made.add(topics[topic], topic, name=topic, **{"Topic/Reliability Policy": policy})
    made.save_rviz("other.rviz")
    return Path("other.rviz").read_text()


def mended_layout() -> str:
    mends = {"wolrd": "world", "Enabled: false": "Enabled: true", "Reliable": "Best Effort"}
    text = BROKEN.replace("/detection}", "/detections}").replace("900", "12")
    for broken, mended in mends.items():
        text = text.replace(broken, mended)
    return text


def battery_bar(charge: float, height: float) -> Any:
    high = float(np.clip(charge, 0, 1)) * height
    return [0.2, 0.2, high], np.array([0, 0, high / 2]), [int(charge < 0.2), int(charge >= 0.2), 0, 1]


def displays_in(text: str) -> Any:
    found, waiting = [], list(yaml.safe_load(text)["Visualization Manager"]["Displays"])
    while waiting:
        display = waiting.pop(0)
        if display.get("Enabled") is False:
            continue
        if "Displays" in display:
            waiting = display["Displays"] + waiting
        else:
            found.append([display["Name"], display["Class"].rpartition("/")[2]])
    return found


def launch_file() -> str:
    """Built up step by step."""
    height = my_values("week05.launch_file")["height"]
    return f"""
import launch
import launch.actions
import launch.substitutions
import launch_ros.actions

FRAMES = ["--child-frame-id", "camera_link", "--frame-id", "base_link", "--z", str({height}), "--x", "0.20"]


def generate_launch_description():
    started = launch.LaunchDescription()
    argument = launch.actions.DeclareLaunchArgument(name="layout", default_value="robot_layout.rviz")
    layout = launch.substitutions.LaunchConfiguration("layout")
    camera = launch_ros.actions.Node(
        name="camera_frame", executable="static_transform_publisher", package="tf2_ros", arguments=FRAMES
    )
    started.add_action(argument)
    started.add_action(camera)
    started.add_action(launch_ros.actions.Node(package="rviz2", executable="rviz2", arguments=["-d", layout]))
    return started
"""
