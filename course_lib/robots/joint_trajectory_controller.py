"""ros2_control's joint trajectory controller, with simulated joints."""

from collections.abc import Mapping, Sequence
from typing import Unpack

import numpy as np
from control_msgs.action import FollowJointTrajectory
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node, NodeOptions
from rclpy.time import Time
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from course_lib.arrays import Floats
from course_lib.errors import CourseError
from course_lib.robots.period import period_of
from course_lib.robots.trajectory import PREEMPTED, REACHED, TrajectoryGoal, Waypoint, sample, waypoints_of
from course_lib.robots.urdf import MOVING, Urdf, parse_urdf


class SimulatedJoints:
    """Joints that reach a command within a period, as far as the limits in the URDF allow.

    Args:
        tree: The robot; joints that mimic others are left out.
        start: Positions by name, [rad] or [m]; joints without one begin at 0.

    Raises:
        CourseError: If a joint does not exist, or would begin outside of its limits.
    """

    def __init__(self, tree: Urdf, start: Mapping[str, float]) -> None:
        joints = [j for j in tree.joints.values() if j.kind in MOVING and not j.mimic]
        self.names = [joint.name for joint in joints]
        self.lower = np.array([joint.limits.get("lower", -np.inf) for joint in joints])
        self.upper = np.array([joint.limits.get("upper", np.inf) for joint in joints])
        self.speed = np.array([joint.velocity for joint in joints])
        for name, position in start.items():
            if name not in self.names:
                raise CourseError(f"There is no joint {name!r} to start; there are {', '.join(self.names)}.")
            i = self.names.index(name)
            if not self.lower[i] <= position <= self.upper[i]:
                limits = f"{self.lower[i]:.3f} … {self.upper[i]:.3f}"
                raise CourseError(f"{name} cannot start at {position!r}; its limits are {limits}.")
        self.positions: Floats = np.array([start.get(name, 0.0) for name in self.names])
        self.velocities: Floats = np.zeros(len(joints))

    def follow(self, command: Floats, period: float) -> list[str]:
        """Move to positions within a period [s]; return ROS's warnings about limits."""
        inside = np.clip(command, self.lower, self.upper)
        reach = self.speed * period
        reached = np.clip(inside, self.positions - reach, self.positions + reach)
        limited = {"position": inside != command, "velocity": np.abs(reached - inside) > 1e-9}
        self.velocities, self.positions = (reached - self.positions) / period, reached
        names = {kind: " ".join(np.array(self.names)[which]) for kind, which in limited.items()}
        return [f"Joint(s) [{n}] would exceed {kind} limits, limiting" for kind, n in names.items() if n]


class JointTrajectoryController(Node):
    """Moves a robot's joints along trajectories, and publishes /joint_states.

    It takes them on the topic ~/joint_trajectory, and as goals of the action ~/follow_joint_trajectory. A new
    one replaces the one that runs, and goes on from where the joints are and how fast they are; a new goal
    also aborts the old one. What it refuses it logs, in the controller's words.

    Args:
        robot_description: The text of a URDF, `mobile_manipulator().urdf`.
        start: Where joints begin, by name, [rad] or [m]; those without a position begin at 0.
        rate: How often it looks and commands, [Hz].
        options: What any node takes.

    Raises:
        CourseError: If the description is not valid, `start` does not suit its joints, or the rate is not
            above 0.
    """

    def __init__(
        self,
        robot_description: str,
        *,
        start: Mapping[str, float] | None = None,
        rate: float = 20.0,
        **options: Unpack[NodeOptions],
    ) -> None:
        self._period = period_of(rate)
        self._joints = SimulatedJoints(parse_urdf(robot_description), start or {})
        super().__init__("arm_controller", **options)
        self._new: tuple[Time, Sequence[Waypoint]] | None = None  # begins with the next update
        self._start_ns = self.get_clock().now().nanoseconds
        self._goal: TrajectoryGoal | None = None
        self._hold()
        self._states = self.create_publisher(JointState, "joint_states", 10)
        self.create_subscription(JointTrajectory, "~/joint_trajectory", self._on_trajectory, 10)
        ActionServer(
            self,
            FollowJointTrajectory,
            "~/follow_joint_trajectory",
            self._follow,
            goal_callback=self._on_goal,
            cancel_callback=self._on_cancel,
        )
        self.create_timer(self._period, self._update)

    def _on_trajectory(self, message: JointTrajectory) -> bool:
        """Accept a trajectory and return True, or log its error."""
        try:
            waypoints = waypoints_of(message, self._joints.names, self.get_clock().now())
        except CourseError as problem:
            self.get_logger().error(str(problem))
            return False
        self._new = Time.from_msg(message.header.stamp), waypoints
        return True

    def _on_goal(self, goal: FollowJointTrajectory.Goal) -> GoalResponse:
        self.get_logger().info("Received new action goal")
        if not self._on_trajectory(goal.trajectory):
            return GoalResponse.REJECT
        self.get_logger().info("Accepted new action goal")
        return GoalResponse.ACCEPT

    def _on_cancel(self, _: ServerGoalHandle) -> CancelResponse:
        self.get_logger().info("Got request to cancel goal")
        return CancelResponse.ACCEPT

    async def _follow(self, handle: ServerGoalHandle) -> FollowJointTrajectory.Result | None:
        if self._goal:
            self._goal.end(PREEMPTED)
        self._goal = TrajectoryGoal(handle, self._joints.names, self.get_logger())
        return await self._goal.result

    def _update(self) -> None:
        now = self.get_clock().now()
        self._publish(now)
        if self._new:
            self._begin(*self._new, now)
        seconds = (now.nanoseconds - self._start_ns) / 1e9
        if self._goal:
            self._look_after(self._goal, now, seconds)
        command = sample(self._waypoints, seconds + self._period)[0]
        for warning in self._joints.follow(command, self._period):
            self.get_logger().warning(warning, throttle_duration_sec=1.0)

    def _look_after(self, goal: TrajectoryGoal, now: Time, seconds: float) -> None:
        """Publish a goal's feedback, and end it when due."""
        desired, actual = sample(self._waypoints, seconds)[:2], self._state()
        goal.report(now, desired, actual)
        end = goal.judge((desired - actual)[0], seconds - self._waypoints[-1].seconds)
        if goal.handle.is_cancel_requested:
            self.get_logger().info("Canceling active action goal because cancel callback received.")
            goal.cancel()
        elif end:
            (self.get_logger().info if end is REACHED else self.get_logger().warning)(end.logs)
            goal.end(end)
        else:
            return
        self._goal = None
        if end is not REACHED:
            self._hold()

    def _begin(self, start: Time, waypoints: Sequence[Waypoint], now: Time) -> None:
        """Continue from the present state along waypoints; a start of 0 is now."""
        self._start_ns, self._new = start.nanoseconds or now.nanoseconds, None
        still: Floats = np.zeros_like(self._joints.positions)
        here = Waypoint((now.nanoseconds - self._start_ns) / 1e9, np.vstack([self._state(), still]))
        self._waypoints = [here, *waypoints]

    def _state(self) -> Floats:
        return np.array([self._joints.positions, self._joints.velocities])

    def _hold(self) -> None:
        """Hold the present positions."""
        self._waypoints = [Waypoint(0.0, self._joints.positions[np.newaxis])]

    def _publish(self, now: Time) -> None:
        state = JointState(name=self._joints.names)
        state.position, state.velocity = self._joints.positions, self._joints.velocities
        state.header.stamp = now.to_msg()
        self._states.publish(state)
