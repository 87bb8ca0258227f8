"""One turtle of turtlesim: its topics, its services, its action."""

import math
from collections import deque
from collections.abc import Callable

from geometry_msgs.msg import Twist
from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.task import Future
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import SetPen, TeleportAbsolute, TeleportRelative

from course_lib.robots.turtlesim.canvas import SIZE, Canvas, Pen

QOS = QoSProfile(depth=7)
PATIENCE_NS = 10**9  # [ns] after its last command a turtle stops
TURN = 1.0  # [rad/s] of the action
NEAR = 0.02  # [rad] of the action's goal


class Turtle:
    """A turtle, moved by Twist messages.

    Args:
        node: The simulator.
        name: Of the turtle, which its topics begin with.
        canvas: What its pen draws on.
        x: To the right, [m].
        y: Up, [m].
        theta: Its heading, 0 to the right, [rad].
    """

    def __init__(self, node: Node, name: str, canvas: Canvas, x: float, y: float, theta: float) -> None:
        self._node, self._canvas, self.pen = node, canvas, Pen()
        self.x, self.y, self.theta = x, y, theta
        self._forward, self._left, self._turn = 0.0, 0.0, 0.0  # [m/s], [m/s], [rad/s]
        self._commanded_ns = node.get_clock().now().nanoseconds
        self._jumps: deque[TeleportAbsolute.Request | TeleportRelative.Request] = deque()
        self._goal: ServerGoalHandle | None = None
        self._ended: Future[RotateAbsolute.Result] = Future()
        self._start = theta  # [rad] of the goal
        self._twists = node.create_subscription(Twist, f"{name}/cmd_vel", self._follow, QOS)
        self._poses = node.create_publisher(Pose, f"{name}/pose", QOS)
        self._colors = node.create_publisher(Color, f"{name}/color_sensor", QOS)
        self._services = [
            node.create_service(SetPen, f"{name}/set_pen", self._set_pen),
            node.create_service(TeleportRelative, f"{name}/teleport_relative", self._teleport),
            node.create_service(TeleportAbsolute, f"{name}/teleport_absolute", self._teleport),
        ]
        self._action = ActionServer(
            node,
            RotateAbsolute,
            f"{name}/rotate_absolute",
            self._rotate,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def destroy(self) -> None:
        """Remove its topics, services and action."""
        self._end(ServerGoalHandle.abort)
        self._action.destroy()
        self._node.destroy_subscription(self._twists)
        for publisher in (self._poses, self._colors):
            self._node.destroy_publisher(publisher)
        for service in self._services:
            self._node.destroy_service(service)

    def update(self, seconds: float) -> None:
        """Move for so long, and publish where it is."""
        while self._jumps:
            self._jump(self._jumps.popleft())
        if self._goal is not None:
            self._steer(self._goal)
        if self._node.get_clock().now().nanoseconds - self._commanded_ns > PATIENCE_NS:
            self._stop()
        before = self.x, self.y
        self.theta = _normal(self.theta + self._turn * seconds)
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        self._place(
            self.x + (cos * self._forward - sin * self._left) * seconds,
            self.y + (sin * self._forward + cos * self._left) * seconds,
        )
        speed = math.hypot(self._forward, self._left)
        self._poses.publish(
            Pose(x=self.x, y=self.y, theta=self.theta, linear_velocity=speed, angular_velocity=self._turn)
        )
        red, green, blue = self._canvas.color_at((self.x, self.y))  # before its own line goes on
        self._colors.publish(Color(r=red, g=green, b=blue))
        if before != (self.x, self.y):
            self._canvas.line(self.pen, before, (self.x, self.y))

    def _place(self, x: float, y: float) -> None:
        """Move to a place, or to the edge before it."""
        if not (0 <= x <= SIZE and 0 <= y <= SIZE):
            place = f"[x={x:f}, y={SIZE - y:f}]"  # as ROS counts here, down from the top
            self._node.get_logger().warning(f"Oh no! I hit the wall! (Clamping from {place})")
        self.x, self.y = min(max(x, 0.0), SIZE), min(max(y, 0.0), SIZE)

    def _follow(self, twist: Twist) -> None:
        self._commanded_ns = self._node.get_clock().now().nanoseconds
        self._forward, self._turn = twist.linear.x, twist.angular.z
        if self._node.get_parameter("holonomic").value:
            self._left = twist.linear.y
        if self._goal is not None:
            self._warn("Velocity command received during rotation goal. Aborting goal")
            self._end(ServerGoalHandle.abort)

    def _stop(self) -> None:
        self._forward = self._left = self._turn = 0.0

    def _set_pen(self, request: SetPen.Request, response: SetPen.Response) -> SetPen.Response:
        color = (request.r, request.g, request.b)
        self.pen = Pen(color, request.width or 1) if not request.off else Pen(on=False)
        return response

    def _teleport(
        self,
        request: TeleportAbsolute.Request | TeleportRelative.Request,
        response: TeleportAbsolute.Response | TeleportRelative.Response,
    ) -> TeleportAbsolute.Response | TeleportRelative.Response:
        self._jumps.append(request)
        return response

    def _jump(self, request: TeleportAbsolute.Request | TeleportRelative.Request) -> None:
        before = self.x, self.y
        if isinstance(request, TeleportRelative.Request):
            self.theta += request.angular
            self.x += math.cos(self.theta) * request.linear
            self.y += math.sin(self.theta) * request.linear
        else:
            self.x, self.y, self.theta = request.x, min(SIZE, request.y), request.theta
        self._canvas.line(self.pen, before, (self.x, self.y))

    async def _rotate(self, goal: ServerGoalHandle) -> RotateAbsolute.Result:
        if self._goal is not None:
            self._warn("Rotation goal received before a previous goal finished. Aborting previous goal")
            self._end(ServerGoalHandle.abort)
        self._goal, self._start, self._ended = goal, self.theta, Future()
        return await self._ended or RotateAbsolute.Result()

    def _steer(self, goal: ServerGoalHandle) -> None:
        """Turn towards the goal, or end it."""
        say = self._node.get_logger().info
        self._stop()
        if goal.is_cancel_requested:
            say("Rotation goal canceled")
            self._end(ServerGoalHandle.canceled)
            return
        remaining = _normal(_normal(goal.request.theta) - self.theta)
        goal.publish_feedback(RotateAbsolute.Feedback(remaining=remaining))
        if abs(remaining) < NEAR:
            say("Rotation goal completed successfully")
            self._end(ServerGoalHandle.succeed)
        else:
            self._turn = math.copysign(TURN, remaining)
            self._commanded_ns = self._node.get_clock().now().nanoseconds

    def _end(self, how: Callable[[ServerGoalHandle], None]) -> None:
        """End the goal, if there is one, in one of the three ways."""
        goal, self._goal = self._goal, None
        if goal is not None:
            how(goal)
            self._ended.set_result(RotateAbsolute.Result(delta=_normal(self._start - self.theta)))

    def _warn(self, text: str) -> None:
        self._node.get_logger().warning(text)


def _normal(angle: float) -> float:
    """Return the same direction from -pi to pi, [rad]."""
    return angle - math.tau * math.floor((angle + math.pi) / math.tau)
