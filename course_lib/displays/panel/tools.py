"""RViz's tools: the buttons of the tool bar, and the messages that some of them publish."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import atan2, cos, sin
from typing import Any

from course_lib.arrays import Vector
from course_lib.displays.display import RvizNode, qos_of, qos_properties
from course_lib.displays.frames import NS
from course_lib.displays.layout import text_at
from course_lib.displays.panel.protocol import Gesture, PublishGesture, ToolSettings
from course_lib.displays.properties import Property, PropertyHolder, color, flag, number
from course_lib.errors import CourseError
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import message_class

# An instance of a generated class.
Message = Any


class Tool(PropertyHolder):
    """One button of the tool bar.

    Args:
        short: RViz's class, without its package.
        label: The label of the button.
        key: The key that selects it.
        gesture: The page's reaction to the mouse.
        properties: The properties of this tool.
    """

    def __init__(
        self,
        short: str,
        label: str,
        key: str,
        gesture: Gesture,
        *properties: Property,
    ) -> None:
        self.properties += properties
        super().__init__()
        self.class_name = f"rviz_default_plugins/{short}"
        self.label, self.key, self.gesture = label, key, gesture

    def __repr__(self) -> str:
        return self.label

    def on_property_change(self, label: str) -> None:
        """Do nothing, because properties are read when the tool is used."""

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set properties from the tool's part of a layout, and keep that part for saving."""
        self.config = config
        return super().load(config)


class PublishPoint(Tool):
    """A tool that publishes the clicked point."""

    type_name = "geometry_msgs/msg/PointStamped"
    # Node through which the tool publishes, once its topic is advertised.
    node: RvizNode | None = None
    # Topic, type and QoS.
    advertised: tuple[str, str, Qos] | None = None
    properties = (*qos_properties("/clicked_point"), Property("Single click", True, flag))

    def message(self, frame: str, stamp_ns: int, point: Vector, yaw: float) -> Message:
        """Return the message for a point [m] and a direction [rad] at a robot time [ns]."""
        stamped: Message = message_class(self.type_name)()
        stamped.header.frame_id = frame
        stamped.header.stamp.sec, stamped.header.stamp.nanosec = divmod(stamp_ns, NS)
        if hasattr(stamped, "point"):
            stamped.point.x, stamped.point.y, stamped.point.z = map(float, point)
        else:
            # A pose on the ground; z of the point is 0.
            pose = getattr(stamped.pose, "pose", stamped.pose)
            pose.position.x, pose.position.y = float(point[0]), float(point[1])
            pose.orientation.z, pose.orientation.w = sin(yaw / 2), cos(yaw / 2)
        return stamped

    def confirmation(self, topic: str, message: Message) -> str:
        """Describe a published message."""
        p = message.point
        return f"Published ({p.x:.2f}, {p.y:.2f}, {p.z:.2f}) in {message.header.frame_id} on {topic}."

    def on_property_change(self, label: str) -> None:
        """Advertise the current topic instead of the previous one."""
        if self.node is not None and self.advertised is not None:
            self.node.withdraw(*self.advertised)
        self.advertise()

    def advertise(self) -> None:
        """Create the publisher with the quality of service in the properties, like RViz's tool."""
        if self.node is not None:
            self.advertised = self.topic, self.type_name, qos_of(self)
            self.node.publisher(*self.advertised)

    @property
    def topic(self) -> str:
        """The fully resolved name of the tool's topic."""
        return "/" + str(self["Topic"]).removeprefix("/")


class SetGoal(PublishPoint):
    """A tool that publishes the pose dragged on the ground."""

    log_text = "Setting goal pose"

    type_name = "geometry_msgs/msg/PoseStamped"
    properties = qos_properties("goal_pose")

    def confirmation(self, topic: str, message: Message) -> str:
        """Describe a published message with the text of RViz's log."""
        pose = getattr(message.pose, "pose", message.pose)
        p, q = pose.position, pose.orientation
        return (
            f"{self.log_text}: Frame:{message.header.frame_id}, Position({p.x:g}, {p.y:g}, {p.z:g}), "
            f"Orientation({q.x:g}, {q.y:g}, {q.z:g}, {q.w:g}) = Angle: {2 * atan2(q.z, q.w):g}"
        )


class SetInitialPose(SetGoal):
    """A tool that publishes the pose dragged on the ground, with a covariance."""

    log_text = "Setting estimate pose"

    type_name = "geometry_msgs/msg/PoseWithCovarianceStamped"
    properties = (
        *qos_properties("initialpose"),
        Property("Covariance x", 0.25, number()),  # [m^2]
        Property("Covariance y", 0.25, number()),  # [m^2]
        Property("Covariance yaw", 0.06853891909122467, number()),  # [rad^2]; (pi / 12)^2 as float32
    )

    def message(self, frame: str, stamp_ns: int, point: Vector, yaw: float) -> Message:
        """Return the message for a pose, with the covariance in the properties."""
        stamped = super().message(frame, stamp_ns, point, yaw)
        for index, axis in ((0, "x"), (7, "y"), (35, "yaw")):
            stamped.pose.covariance[index] = self[f"Covariance {axis}"]
        return stamped


def all_tools() -> tuple[Tool, ...]:
    """Create the tools in RViz's order, with its shortcut keys."""
    return (
        Tool("Interact", "Interact", "i", "interact", Property("Hide Inactive Objects", True, flag)),
        Tool("MoveCamera", "Move Camera", "m", "camera"),
        Tool("Select", "Select", "s", "select"),
        Tool("FocusCamera", "Focus Camera", "c", "focus"),
        Tool("Measure", "Measure", "n", "measure", Property("Line color", (128, 128, 0), color)),
        SetInitialPose("SetInitialPose", "2D Pose Estimate", "p", "pose"),
        SetGoal("SetGoal", "2D Goal Pose", "g", "pose"),
        PublishPoint("PublishPoint", "Publish Point", "u", "point"),
    )


def load_tools(tools: Iterable[Tool], configs: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Set the tools' properties from a layout, and yield the problems with it."""
    tools_by_class = {tool.class_name: tool for tool in tools}
    unknown = list[str]()
    # In reverse order, so that the first tool of a class has precedence.
    for config in reversed(configs):
        class_name = text_at(config, "Class")
        if class_name in tools_by_class:
            yield from tools_by_class[class_name].load(config)
        else:
            unknown.insert(0, repr(class_name))
    if unknown:
        # A layout of ROS 1 has eight unknown tools.
        subject = "is no tool" if len(unknown) == 1 else "are no tools"
        yield f"There {subject} {', '.join(unknown)}; the layout keeps the settings."


def advertise_tools(
    node: RvizNode,
    tools: Iterable[Tool],
    configs: Sequence[Mapping[str, Any]],
) -> None:
    """Advertise the topics of the tools in a layout, as RViz does when it loads one."""
    class_names = {text_at(config, "Class") for config in configs}
    for tool in tools:
        if isinstance(tool, PublishPoint) and tool.class_name in class_names:
            tool.node = node
            tool.advertise()


def settings_of(tools: Sequence[Tool]) -> ToolSettings:
    """Return the properties of tools that the page itself uses."""
    single = next(tool.get("Single click", None) for tool in tools if tool.gesture == "point")
    line = next(tool.get("Line color", None) for tool in tools if tool.gesture == "measure")
    return ToolSettings(single, "rgb({}, {}, {})".format(*line))


def publish(node: RvizNode, tools: Iterable[Tool], fixed_frame: str, command: PublishGesture) -> str:
    """Publish a message for a gesture in the fixed frame, stamped now, and return its description.

    Raises:
        CourseError: If there is no such tool.
    """
    tools_by_label = {tool.label: tool for tool in tools if isinstance(tool, PublishPoint)}
    if command.tool not in tools_by_label:
        tool_names = ", ".join(tools_by_label)
        raise CourseError(f"There is no publishing tool {command.tool!r}; choose one of {tool_names}.")
    tool = tools_by_label[command.tool]
    message = tool.message(fixed_frame, node.now_ns, command.point, command.angle)
    node.publish(tool.topic, tool.type_name, qos_of(tool), message)
    return tool.confirmation(tool.topic, message)
