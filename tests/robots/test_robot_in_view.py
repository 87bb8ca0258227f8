"""From joint states to the scene: a joint at NaN affects only its own links."""

from math import nan

from rclpy.node import Node
from sensor_msgs.msg import JointState

from course_lib.displays.viewer import Viewer
from course_lib.robots.state_publishers import RobotStatePublisher
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import spin_for
from tests.robots.urdfs import ARM_2R, joint, links, robot

ARM = ARM_2R.removeprefix('<robot name="small">').removesuffix("</robot>")
ARM_AND_LAMP = robot(ARM, links("lamp"), joint("lamp_joint", "base", "lamp"))


class Joints(Node):
    """Publishes joint states ten times a second, one of a joint that the robot does not have."""

    def __init__(self) -> None:
        super().__init__("joints")
        self.positions = {"shoulder": nan, "elbow": 0.5, "lamp_joint": 0.1, "tail": 1.0}  # [rad]
        self.publisher = self.create_publisher(JointState, "/joint_states", 10)
        self.create_timer(0.1, self.say)

    def say(self) -> None:
        state = JointState(name=list(self.positions), position=list(self.positions.values()))
        state.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(state)


def links_shown(viewer: Viewer) -> dict[str, str]:
    """Return the display's status of each link."""
    said = {row.name: row.text for row in viewer.statuses() if row.display == "RobotModel"}
    return {link: said[link] for link in ("base", "lamp", "upper", "fore", "tip")}


def test_links_beyond_a_nan_joint_are_not_placed_and_others_are_drawn(graph: Graph) -> None:
    viewer = Viewer(fixed_frame="base")
    viewer.add("RobotModel", topic="/robot_description")
    nodes = RobotStatePublisher(ARM_AND_LAMP), Joints()
    spin_for(0.5, *nodes)
    missing = {link: f"No transform from [{link}] to [base]" for link in ("upper", "fore", "tip")}
    assert links_shown(viewer) == {"base": "Transform OK", "lamp": "Transform OK"} | missing
    refused = 'TF_NAN_INPUT: Ignoring transform for child_frame_id "upper"'
    assert any(row.level == "hint" and row.text.startswith(refused) for row in viewer.statuses())
    nodes[1].positions["shoulder"] = 0.2
    spin_for(0.5, *nodes)
    assert set(links_shown(viewer).values()) == {"Transform OK"}
