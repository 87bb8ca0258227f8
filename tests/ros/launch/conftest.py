from collections.abc import Callable
from pathlib import Path

import pytest

from tests.ros.launch.run import MANIFEST, SETUP_CFG

TALKER = """
import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        rate = self.declare_parameter("rate", 1.0).value
        self.declare_parameter("word", "hi")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_timer(1 / rate, self.tick)

    def tick(self):
        words = [repr(self.get_parameter("word").value), *sys.argv[1:2]]
        self.publisher.publish(String(data=" ".join(words)))


def main():
    rclpy.init()
    node = Talker()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


def once():
    rclpy.init()
    Talker().tick()
    return 0


def fail():
    raise ValueError("no laser")
"""
SETUP = """
package_name = "my_robot"
setup(packages=[package_name], entry_points={"console_scripts": [
    "talker = my_robot.talker:main", "once = my_robot.talker:once", "fail = my_robot.talker:fail"]})
"""
IMPORTS = """
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.events import Shutdown as ShutdownEvent
from launch.events import ShutdownProcess, SignalProcess, matches_action
from launch.launch_description_sources import AnyLaunchDescriptionSource, PythonLaunchDescriptionSource
from launch.substitutions import *
from launch_xml.launch_description_sources import XMLLaunchDescriptionSource
from launch_ros.actions import *
from launch_ros.descriptions import ComposableNode
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

TALKER = dict(package="my_robot", executable="talker")


def generate_launch_description():
    return LaunchDescription([
"""


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    """A package's sources, my_robot, with executables talker, once and fail."""
    root = tmp_path / "my_robot"
    for folder in ("my_robot", "launch", "config"):
        (root / folder).mkdir(parents=True)
    (root / "package.xml").write_text(MANIFEST)
    (root / "setup.cfg").write_text(SETUP_CFG)
    (root / "setup.py").write_text(SETUP)
    (root / "my_robot" / "__init__.py").touch()
    (root / "my_robot" / "talker.py").write_text(TALKER)
    return root


@pytest.fixture
def launch_file(robot: Path) -> Callable[..., Path]:
    """Write a launch file that describes some actions."""

    def write(*actions: str, name: str = "robot.launch.py") -> Path:
        file = robot / "launch" / name
        file.write_text(IMPORTS + "".join(f"        {action},\n" for action in actions) + "    ])\n")
        return file

    return write
