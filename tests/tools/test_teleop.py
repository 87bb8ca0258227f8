from collections.abc import Iterator

import pytest
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time.driving import spin_for
from course_lib.tools.demo_nodes import TwistTeleop
from course_lib.tools.executables import key_buttons


@pytest.fixture
def run() -> Iterator[tuple[TwistTeleop, Node, list[Twist]]]:
    with use_graph(Graph()):
        rclpy.init()
        messages: list[Twist] = []
        base = Node("base")
        base.create_subscription(Twist, "cmd_vel", messages.append, 10)
        teleop = TwistTeleop()
        spin_for(0.1, base, teleop)
        yield teleop, base, messages
        rclpy.shutdown()


@pytest.mark.parametrize(
    ("keys", "forward", "turn"),
    [("i", 0.5, 0.0), ("j", 0.0, 1.0), (".", -0.5, 1.0), ("k", 0.0, 0.0), ("?", 0.0, 0.0), ("qi", 0.55, 0.0)],
)
def test_key_or_its_button_drives_the_robot(
    run: tuple[TwistTeleop, Node, list[Twist]], keys: str, forward: float, turn: float
) -> None:
    teleop, base, heard = run
    for key in keys:
        teleop.press(key)
    spin_for(0.1, teleop, base)
    assert (heard[-1].linear.x, heard[-1].angular.z) == pytest.approx((forward, turn))
    assert len(heard) == 1


def test_each_key_has_a_button(run: tuple[TwistTeleop, Node, list[Twist]]) -> None:
    teleop, base, heard = run
    buttons = {button.description: button for button in key_buttons(teleop.press, teleop.KEYS).children}
    buttons["I"].click()
    spin_for(0.1, teleop, base)
    assert heard[-1].linear.x == 0.5
