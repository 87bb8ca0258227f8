"""The mobile manipulator: one arm command of seeds/002, a drive to the side, the other arm command."""

from collections.abc import Callable
from functools import partial

import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.robots.mobile_manipulator import START, OmniBase, mobile_manipulator
from course_lib.robots.state_publishers import RobotStatePublisher
from course_lib.robots.trajectory import JointTrajectoryController

JOINTS = [
    f"ur10{name}_joint"
    for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
]
FIRST, DRIVE, SECOND = 1.0, 5.0, 8.0  # [s] when each of them is sent


class Operator(Node):
    """Sends two commands to the arm and one goal to the base."""

    def __init__(self) -> None:
        super().__init__("operator")
        self.arm = self.create_publisher(JointTrajectory, "/arm_controller/joint_trajectory", 10)
        self.base = self.create_publisher(PoseStamped, "/goal_pose", 10)
        self.steps: dict[float, Callable[[], None]] = {
            FIRST: partial(self.sweep, 1.5),
            DRIVE: self.drive,
            SECOND: partial(self.sweep, -0.25),
        }
        for at in list(self.steps):
            self.create_timer(at, partial(self.do, at))

    def do(self, at: float) -> None:
        """Do the step of a time, once."""
        if step := self.steps.pop(at, None):
            step()

    def sweep(self, lift: float) -> None:
        """Send the arm to a shoulder lift [rad], within 3 s."""
        point = JointTrajectoryPoint(positions=[0.0, lift, 0.5, 0.0, 0.0, 0.0], velocities=[0.0] * 6)
        point.time_from_start.sec = 3
        self.arm.publish(JointTrajectory(joint_names=JOINTS, points=[point]))

    def drive(self) -> None:
        """Drive 0.5 m to the left."""
        goal = PoseStamped()
        goal.header.frame_id = "map"
        goal.pose.position.y = 0.5  # [m]
        goal.pose.orientation.w = 1.0
        self.base.publish(goal)


def nodes() -> list[Node]:
    """The robot and its operator."""
    urdf = mobile_manipulator().urdf
    arm = JointTrajectoryController(urdf, start=START)
    return [OmniBase(), arm, RobotStatePublisher(urdf), Operator()]


def main() -> None:
    """Run them all."""
    rclpy.init()
    executor = SingleThreadedExecutor()
    for node in nodes():
        executor.add_node(node)
    executor.spin()


if __name__ == "__main__":
    main()
