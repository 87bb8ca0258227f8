"""turtlesim: its node with turtles on a canvas, its programs, and the nodes of turtle_tf2_py."""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from geometry_msgs.msg import TransformStamped, Twist, Vector3
from PIL import Image, ImageDraw
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.task import Future
from rclpy.time import Time
from std_srvs.srv import Empty
from tf2_ros import (
    Buffer,
    StaticTransformBroadcaster,
    TransformBroadcaster,
    TransformException,
    TransformListener,
)
from tf_transformations import quaternion_from_euler
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute, TeleportRelative

from course_lib.errors import CourseError

# Edge length of the canvas [px].
PIXELS = 500
# In pixels.
METER = 45
# Edge length of the canvas [m].
SIZE = (PIXELS - 1) / METER
# Maximum number of points in a strip.
LONGEST = 500
# x to the right, y up, [m].
Point = tuple[float, float]
# Components in 0..255.
Rgb = tuple[int, int, int]


@dataclass(frozen=True)
class Pen:
    """A pen. turtlesim's default pen is light and 3 pixels wide."""

    color: Rgb = (0xB3, 0xB8, 0xFF)
    # In pixels.
    width: int = 3
    on: bool = True


@dataclass
class Strip:
    """Points that a pen has connected by lines."""

    pen: Pen
    points: list[Point] = field(default_factory=list)


class Canvas:
    """Lines as strips, for the view, and as pixels, for the turtles' color sensors."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Remove all lines."""
        self.strips: list[Strip] = []
        self._image = Image.new("RGBA", (PIXELS, PIXELS), (255, 255, 255, 0))
        self._painter = ImageDraw.Draw(self._image)

    def line(self, pen: Pen, start: Point, end: Point) -> None:
        """Draw a line. It extends the strip that ends at its start, if there is one."""
        if not pen.on:
            return
        # Only the last strips can end at a turtle, unless there are many turtles.
        ends = [strip for strip in self.strips[-8:] if strip.pen == pen and strip.points[-1] == start]
        if ends and len(ends[-1].points) < LONGEST:
            ends[-1].points.append(end)
        else:
            self.strips.append(Strip(pen, [start, end]))
        self._painter.line([_pixel(start), _pixel(end)], fill=(*pen.color, 255), width=pen.width)

    def color_at(self, place: Point) -> Sequence[int]:
        """Return the RGB color of the canvas at a position; white without a line."""
        pixel = self._image.getpixel(_pixel(place))
        # The image is not a palette image, so a pixel is a tuple.
        assert isinstance(pixel, tuple)
        return pixel[:3]


def _pixel(place: Point) -> tuple[int, int]:
    x, y = (round(min(max(number, 0.0), SIZE) * METER) for number in place)
    return x, PIXELS - 1 - y


QOS = QoSProfile(depth=7)
# A turtle stops this long after its last command [ns].
PATIENCE_NS = 10**9
# Angular speed of the action [rad/s].
TURN = 1.0
# Tolerance of the action's goal [rad].
ANGLE_TOLERANCE = 0.02


class Turtle:
    """A turtle, controlled by Twist messages.

    Args:
        node: The simulator.
        name: The turtle's name, with which its topics begin.
        canvas: The canvas that its pen draws on.
        x: Position to the right, [m].
        y: Position upwards, [m].
        theta: Heading, 0 to the right, [rad].
    """

    def __init__(
        self,
        node: Node,
        name: str,
        canvas: Canvas,
        x: float,
        y: float,
        theta: float,
    ) -> None:
        self._node, self._canvas, self.pen = node, canvas, Pen()
        self.x, self.y, self.theta = x, y, theta
        # In [m/s], [m/s] and [rad/s].
        self._forward_speed, self._sideways_speed, self._turn = 0.0, 0.0, 0.0
        self._commanded_ns = node.get_clock().now().nanoseconds
        self._teleports: deque[TeleportAbsolute.Request | TeleportRelative.Request] = deque()
        self._goal: ServerGoalHandle | None = None
        self._rotation_result: Future[RotateAbsolute.Result] = Future()
        # Heading at the start of the goal [rad].
        self._start = theta
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
        """Remove the turtle's topics, services and action."""
        self._end(ServerGoalHandle.abort)
        self._action.destroy()
        self._node.destroy_subscription(self._twists)
        for publisher in (self._poses, self._colors):
            self._node.destroy_publisher(publisher)
        for service in self._services:
            self._node.destroy_service(service)

    def update(self, seconds: float) -> None:
        """Move for a time [s], and publish pose and color."""
        while self._teleports:
            request = self._teleports.popleft()
            left = self.x, self.y
            if isinstance(request, TeleportRelative.Request):
                self.theta += request.angular
                self.x += math.cos(self.theta) * request.linear
                self.y += math.sin(self.theta) * request.linear
            else:
                self.x, self.y, self.theta = request.x, min(SIZE, request.y), request.theta
            self._canvas.line(self.pen, left, (self.x, self.y))
        if self._goal is not None:
            self._steer(self._goal)
        if self._node.get_clock().now().nanoseconds - self._commanded_ns > PATIENCE_NS:
            self._stop()
        before = self.x, self.y
        self.theta = _normalize_angle(self.theta + self._turn * seconds)
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        x = self.x + (cos * self._forward_speed - sin * self._sideways_speed) * seconds
        y = self.y + (sin * self._forward_speed + cos * self._sideways_speed) * seconds
        if not (0 <= x <= SIZE and 0 <= y <= SIZE):
            # In ROS's message, y is measured downwards.
            place = f"[x={x:f}, y={SIZE - y:f}]"
            self._node.get_logger().warning(f"Oh no! I hit the wall! (Clamping from {place})")
        self.x, self.y = min(max(x, 0.0), SIZE), min(max(y, 0.0), SIZE)
        speed = math.hypot(self._forward_speed, self._sideways_speed)
        self._poses.publish(
            Pose(x=self.x, y=self.y, theta=self.theta, linear_velocity=speed, angular_velocity=self._turn)
        )
        # The color is read before the turtle's own line covers it.
        red, green, blue = self._canvas.color_at((self.x, self.y))
        self._colors.publish(Color(r=red, g=green, b=blue))
        if before != (self.x, self.y):
            self._canvas.line(self.pen, before, (self.x, self.y))

    def _follow(self, twist: Twist) -> None:
        self._commanded_ns = self._node.get_clock().now().nanoseconds
        self._forward_speed, self._turn = twist.linear.x, twist.angular.z
        if self._node.get_parameter("holonomic").value:
            self._sideways_speed = twist.linear.y
        if self._goal is not None:
            self._node.get_logger().warning("Velocity command received during rotation goal. Aborting goal")
            self._end(ServerGoalHandle.abort)

    def _stop(self) -> None:
        self._forward_speed = self._sideways_speed = self._turn = 0.0

    def _set_pen(self, request: SetPen.Request, response: SetPen.Response) -> SetPen.Response:
        color = (request.r, request.g, request.b)
        self.pen = Pen(color, request.width or 1) if not request.off else Pen(on=False)
        return response

    def _teleport(
        self,
        request: TeleportAbsolute.Request | TeleportRelative.Request,
        response: TeleportAbsolute.Response | TeleportRelative.Response,
    ) -> TeleportAbsolute.Response | TeleportRelative.Response:
        self._teleports.append(request)
        return response

    async def _rotate(self, goal: ServerGoalHandle) -> RotateAbsolute.Result:
        if self._goal is not None:
            self._node.get_logger().warning(
                "Rotation goal received before a previous goal finished. Aborting previous goal"
            )
            self._end(ServerGoalHandle.abort)
        self._goal, self._start, self._rotation_result = goal, self.theta, Future()
        return await self._rotation_result or RotateAbsolute.Result()

    def _steer(self, goal: ServerGoalHandle) -> None:
        """Turn towards the goal, or end the goal."""
        say = self._node.get_logger().info
        self._stop()
        if goal.is_cancel_requested:
            say("Rotation goal canceled")
            self._end(ServerGoalHandle.canceled)
            return
        remaining_angle = _normalize_angle(_normalize_angle(goal.request.theta) - self.theta)
        goal.publish_feedback(RotateAbsolute.Feedback(remaining=remaining_angle))
        if abs(remaining_angle) < ANGLE_TOLERANCE:
            say("Rotation goal completed successfully")
            self._end(ServerGoalHandle.succeed)
        else:
            self._turn = math.copysign(TURN, remaining_angle)
            self._commanded_ns = self._node.get_clock().now().nanoseconds

    def _end(self, how: Callable[[ServerGoalHandle], None]) -> None:
        """End the goal, if there is one, by calling one of the handle's methods."""
        goal, self._goal = self._goal, None
        if goal is not None:
            how(goal)
            self._rotation_result.set_result(
                RotateAbsolute.Result(delta=_normalize_angle(self._start - self.theta))
            )


def _normalize_angle(angle: float) -> float:
    """Return the equivalent angle from -pi to pi [rad]."""
    return angle - math.tau * math.floor((angle + math.pi) / math.tau)


# Period of the simulation [s].
PERIOD = 0.016
WATER = {"r": 0x45, "g": 0x56, "b": 0xFF}


class TurtlesimNode(Node):
    """The simulator, which starts with one turtle in the middle."""

    def __init__(self) -> None:
        super().__init__("turtlesim")
        for (letter, value), color in zip(WATER.items(), ("Red", "Green", "Blue"), strict=True):
            text = f"{color} channel of the background color"
            limits = [IntegerRange(from_value=0, to_value=255, step=1)]
            descriptor = ParameterDescriptor(description=text, integer_range=limits)
            self.declare_parameter(f"background_{letter}", value, descriptor)
        text = "If true, then turtles will be holonomic"
        self.declare_parameter("holonomic", False, ParameterDescriptor(description=text))
        self.turtles: dict[str, Turtle] = {}
        self.canvas, self._count = Canvas(), 0
        self.create_service(Empty, "clear", self._clear)
        self.create_service(Empty, "reset", self._reset)
        self.create_service(Spawn, "spawn", self._on_spawn)
        self.create_service(Kill, "kill", self._kill)
        self.get_logger().info(f"Starting turtlesim with node name {self.get_fully_qualified_name()}")
        self._spawn("", SIZE / 2, SIZE / 2, 0.0)
        self.create_timer(PERIOD, self._update)

    @property
    def background(self) -> Rgb:
        """The background color: red, green and blue."""
        red, green, blue = (int(self.get_parameter(f"background_{letter}").value) for letter in WATER)
        return red, green, blue

    def _update(self) -> None:
        for turtle in list(self.turtles.values()):
            turtle.update(PERIOD)

    def _spawn(self, name: str, x: float, y: float, theta: float) -> str:
        """Add a turtle, by default with the next free name.

        Return its name, or "" if the name is taken.
        """
        if name in self.turtles:
            return ""
        while not name or name in self.turtles:
            self._count += 1
            name = f"turtle{self._count}"
        # In ROS these are single-precision numbers.
        x, y, theta = (float(np.float32(number)) for number in (x, y, theta))
        self.turtles[name] = Turtle(self, name, self.canvas, x, y, theta)
        place = f"x=[{x:f}], y=[{y:f}], theta=[{theta:f}]"
        self.get_logger().info(f"Spawning turtle [{name}] at {place}")
        return name

    def _on_spawn(self, request: Spawn.Request, response: Spawn.Response) -> Spawn.Response:
        response.name = self._spawn(request.name, request.x, request.y, request.theta)
        if not response.name:
            self.get_logger().error(f"A turtle named [{request.name}] already exists")
        return response

    def _kill(self, request: Kill.Request, response: Kill.Response) -> Kill.Response:
        if request.name in self.turtles:
            self.turtles.pop(request.name).destroy()
        else:
            text = f"Tried to kill turtle [{request.name}], which does not exist"
            self.get_logger().error(text)
        return response

    def _clear(self, request: Empty.Request, response: Empty.Response) -> Empty.Response:
        self.get_logger().info("Clearing turtlesim.")
        self.canvas.clear()
        return response

    def _reset(self, request: Empty.Request, response: Empty.Response) -> Empty.Response:
        self.get_logger().info("Resetting turtlesim.")
        while self.turtles:
            self.turtles.popitem()[1].destroy()
        self._count = 0
        self._spawn("", SIZE / 2, SIZE / 2, 0.0)
        self.canvas.clear()
        return response


# Period of the timers [s].
MIMIC_PERIOD = 0.016
# Side of the square [m].
EDGE = 2.0
# Speeds along the square [m/s, rad/s].
SPEED, KEY_TURN = 1.0, 0.4
# Tolerances of position and heading [m, rad].
ARRIVED, ALIGNED = 0.1, 0.01
# Speed below which a turtle has stopped [m/s, rad/s].
MIN_SPEED = 0.0001
# Factors of forward and turning speed.
ARROWS = {"↑": (1.0, 0.0), "↓": (-1.0, 0.0), "←": (0.0, 1.0), "→": (0.0, -1.0)}
# Headings in eighths of a turn. On a keyboard these keys are around F, which cancels.
HEADINGS = {"g": 0, "t": 1, "r": 2, "e": 3, "d": 4, "c": -3, "v": -2, "b": -1}


class TurtleMimic(Node):
    """Lets a turtle copy the motion of another one: from `input/pose` to `output/cmd_vel`."""

    def __init__(self) -> None:
        super().__init__("turtle_mimic")
        self._twists = self.create_publisher(Twist, "output/cmd_vel", QOS)
        self.create_subscription(Pose, "input/pose", self._copy, QOS)

    def _copy(self, pose: Pose) -> None:
        self._twists.publish(_twist(pose.linear_velocity, pose.angular_velocity))


class DrawSquare(Node):
    """Resets turtlesim, then drives the first turtle along squares."""

    def __init__(self) -> None:
        super().__init__("draw_square")
        self._twists = self.create_publisher(Twist, "turtle1/cmd_vel", QOS)
        self.create_subscription(Pose, "turtle1/pose", self._on_pose, QOS)
        self._pose: Pose | None = None
        self._goal: Pose | None = None
        self._turns, self._stops = False, False
        self.create_client(Empty, "reset").call_async(Empty.Request())
        self.create_timer(MIMIC_PERIOD, self._drive)

    def _on_pose(self, pose: Pose) -> None:
        self._pose = pose

    def _drive(self) -> None:
        pose = self._pose
        if pose is None:
            return
        goal = self._goal or self._aim(pose)
        is_near = abs(pose.x - goal.x) < ARRIVED and abs(pose.y - goal.y) < ARRIVED
        if self._stops and pose.linear_velocity < MIN_SPEED and pose.angular_velocity < MIN_SPEED:
            self.get_logger().info("Reached goal")
            self._stops, self._turns = False, not self._turns
            self._aim(pose)
        elif self._stops or (is_near and abs(pose.theta - goal.theta) < ALIGNED):
            self._stops = True
            self._twists.publish(_twist(0.0, 0.0))
        else:
            self._twists.publish(_twist(0.0, KEY_TURN) if self._turns else _twist(SPEED, 0.0))

    def _aim(self, pose: Pose) -> Pose:
        """Set the next goal: the end of an edge, or a quarter of a turn."""
        distance = 0.0 if self._turns else EDGE
        theta = math.remainder(pose.theta + self._turns * math.pi / 2, math.tau)
        x, y = pose.x + math.cos(pose.theta) * distance, pose.y + math.sin(pose.theta) * distance
        self._goal = goal = Pose(x=x, y=y, theta=theta)
        self.get_logger().info(f"New goal [{goal.x:f} {goal.y:f}, {goal.theta:f}]")
        return goal


class TurtleTeleop(Node):
    """Controls the first turtle by keys, pressed by a program or a button."""

    # Rows of three buttons; an empty name leaves a gap.
    KEYS = ("e", "r", "t", "d", "f", "g", "c", "v", "b", "←", "↑", "→", "", "↓", "")

    def __init__(self) -> None:
        super().__init__("teleop_turtle")
        for kind in ("angular", "linear"):
            self.declare_parameter(f"scale_{kind}", 2.0)
        self._twists = self.create_publisher(Twist, "turtle1/cmd_vel", QOS)
        self._rotate = ActionClient(self, RotateAbsolute, "turtle1/rotate_absolute")
        self._goal: ClientGoalHandle | None = None
        self._pressed: deque[str] = deque()
        self.create_timer(MIMIC_PERIOD, self._work)

    def press(self, key: str) -> None:
        """Press a key: an arrow, or one of the letters around F. Other keys are ignored."""
        self._pressed.append(key.lower())

    def _work(self) -> None:
        while self._pressed:
            key = self._pressed.popleft()
            if key in ARROWS:
                forward, turn = ARROWS[key]
                scales = [self.get_parameter(f"scale_{kind}").value for kind in ("linear", "angular")]
                self._twists.publish(_twist(forward * float(scales[0]), turn * float(scales[1])))
            elif key in HEADINGS:
                goal = RotateAbsolute.Goal(theta=HEADINGS[key] * math.pi / 4)
                self._rotate.send_goal_async(goal).add_done_callback(self._remember)
            elif key == "f" and self._goal is not None:
                self._goal.cancel_goal_async()

    def _remember(self, goal_future: "Future[Any]") -> None:
        self._goal = goal_future.result()


def _twist(forward: float, turn: float) -> Twist:
    return Twist(linear=Vector3(x=forward), angular=Vector3(z=turn))


# Gains of the follower: forward speed by distance, turning speed by bearing [1/s].
FORWARD_GAIN, TURNING_GAIN = 0.5, 1.0
# Periods of the follower and of the broadcasters of carrot1 [s].
FOLLOW_PERIOD, CARROT_PERIOD = 1.0, 0.1
# Distances of carrot1 from its turtle: attached to it, and circling around it [m].
FIXED_DISTANCE, RADIUS = 2.0, 10.0


class TurtleBroadcaster(Node):
    """Broadcasts the frame of the turtle given by the parameter `turtlename`."""

    def __init__(self) -> None:
        super().__init__("turtle_tf2_frame_publisher")
        self._turtle = self.declare_parameter("turtlename", "turtle").value
        self._broadcaster = TransformBroadcaster(self)
        self.create_subscription(Pose, f"/{self._turtle}/pose", self._on_pose, 1)

    def _on_pose(self, pose: Pose) -> None:
        at = (pose.x, pose.y, 0.0)
        self._broadcaster.sendTransform(_transform(self, "world", self._turtle, at, (0.0, 0.0, pose.theta)))


class FixedFrameBroadcaster(Node):
    """Broadcasts the frame carrot1, which is attached to the first turtle."""

    def __init__(self) -> None:
        super().__init__("fixed_frame_tf2_broadcaster")
        self._broadcaster = TransformBroadcaster(self)
        self.create_timer(CARROT_PERIOD, self._broadcast)

    def _broadcast(self) -> None:
        self._broadcaster.sendTransform(_transform(self, "turtle1", "carrot1", (0.0, FIXED_DISTANCE, 0.0)))


class DynamicFrameBroadcaster(Node):
    """Broadcasts the frame carrot1, which circles around the first turtle every two seconds."""

    def __init__(self) -> None:
        super().__init__("dynamic_frame_tf2_broadcaster")
        self._broadcaster = TransformBroadcaster(self)
        self.create_timer(CARROT_PERIOD, self._broadcast)

    def _broadcast(self) -> None:
        seconds = self.get_clock().now().seconds_nanoseconds()[0]
        angle = math.pi * seconds
        at = (RADIUS * math.sin(angle), RADIUS * math.cos(angle), 0.0)
        self._broadcaster.sendTransform(_transform(self, "turtle1", "carrot1", at))


class StaticTurtleBroadcaster(Node):
    """Broadcasts a static frame once: its name, its position and its roll, pitch and yaw are arguments."""

    def __init__(self, words: list[str]) -> None:
        if len(words) != 7:
            raise CourseError(
                "Invalid number of parameters. Usage: ros2 run turtle_tf2_py "
                "static_turtle_tf2_broadcaster child_frame_name x y z roll pitch yaw"
            )
        frame, *numbers = words
        if frame == "world":
            raise CourseError('Your static turtle name cannot be "world"')
        super().__init__("static_turtle_tf2_broadcaster")
        x, y, z, roll, pitch, yaw = map(float, numbers)
        self._broadcaster = StaticTransformBroadcaster(self)
        self._broadcaster.sendTransform(_transform(self, "world", frame, (x, y, z), (roll, pitch, yaw)))


class TurtleFollower(Node):
    """Spawns the second turtle, which follows the frame given by the parameter `target_frame`."""

    def __init__(self) -> None:
        super().__init__("turtle_tf2_frame_listener")
        self._target = self.declare_parameter("target_frame", "turtle1").value
        self._buffer = Buffer()
        self._listener = TransformListener(self._buffer, self)
        self._spawner = self.create_client(Spawn, "spawn")
        self._spawn_response: Future[Spawn.Response] | None = None
        self._twists = self.create_publisher(Twist, "turtle2/cmd_vel", 1)
        self.create_timer(FOLLOW_PERIOD, self._follow)

    def _follow(self) -> None:
        say = self.get_logger().info
        if self._spawn_response is None and not self._spawner.service_is_ready():
            say("Service is not ready")
        elif self._spawn_response is None:
            self._spawn_response = self._spawner.call_async(Spawn.Request(name="turtle2", x=4.0, y=2.0))
        elif not self._spawn_response.done():
            say("Spawn is not finished")
        else:
            try:
                transform = self._buffer.lookup_transform("turtle2", self._target, Time())
            except TransformException as error:
                say(f"Could not transform turtle2 to {self._target}: {error}")
                return
            x, y = transform.transform.translation.x, transform.transform.translation.y
            twist = Twist()
            twist.linear.x = FORWARD_GAIN * math.hypot(x, y)
            twist.angular.z = TURNING_GAIN * math.atan2(y, x)
            self._twists.publish(twist)


def _transform(
    node: Node,
    parent: str,
    child: str,
    at: tuple[float, float, float],
    angles: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> TransformStamped:
    """Return a transform with the current time; `at` in m, `angles` are roll, pitch and yaw in rad."""
    transform = TransformStamped(child_frame_id=child)
    transform.header.stamp = node.get_clock().now().to_msg()
    transform.header.frame_id = parent
    translation, rotation = transform.transform.translation, transform.transform.rotation
    translation.x, translation.y, translation.z = at
    rotation.x, rotation.y, rotation.z, rotation.w = map(float, quaternion_from_euler(*angles))
    return transform
