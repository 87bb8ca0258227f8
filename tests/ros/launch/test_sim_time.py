"""Launch files with the argument `use_sim_time`, and a simulation that sets the time."""

from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.recording import Recording
from tests.ros.launch.run import recorded

SIMULATOR = """
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rosgraph_msgs.msg import Clock as ClockMessage


class Simulator(Node):
    def __init__(self):
        super().__init__("simulator")
        self.publisher = self.create_publisher(ClockMessage, "/clock", 10)
        self.milliseconds = 0
        self.create_timer(0.01, self.step, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def step(self):
        self.milliseconds += 50
        message = ClockMessage()
        message.clock.sec, rest = divmod(self.milliseconds, 1000)
        message.clock.nanosec = rest * 1000000
        self.publisher.publish(message)


def main():
    rclpy.init()
    rclpy.spin(Simulator())
"""
SETUP = """
package_name = "my_robot"
setup(entry_points={"console_scripts": [
    "talker = my_robot.talker:main", "simulator = my_robot.simulator:main"]})
"""
USES = "{'use_sim_time': LaunchConfiguration('use_sim_time')}"
ACTIONS = (
    "DeclareLaunchArgument('use_sim_time', default_value='true')",
    f"Node(package='my_robot', executable='simulator', parameters=[{USES}])",
    f"Node(**TALKER, parameters=[{USES}])",
)


@pytest.fixture
def simulation(robot: Path, launch_file: Callable[..., Path]) -> Path:
    """A launch file of a talker and a simulation, which is five times as fast as robot time."""
    (robot / "setup.py").write_text(SETUP)
    (robot / "my_robot" / "simulator.py").write_text(SIMULATOR)
    return launch_file(*ACTIONS)


def spoken(recording: Recording) -> int:
    return len(list(recording.messages("/chatter")))


@pytest.mark.parametrize(("words", "times"), [((), 10), (("use_sim_time:=false",), 2)])
def test_nodes_of_a_launch_file_follow_its_simulation_clock(
    simulation: Path, words: tuple[str, ...], times: int
) -> None:
    recording, code = recorded(simulation, *words, seconds=2.1)
    assert (spoken(recording), code) == (times, 0)


def test_two_runs_in_sim_time_are_equal(simulation: Path) -> None:
    assert recorded(simulation, seconds=1.0)[0].digest() == recorded(simulation, seconds=1.0)[0].digest()
