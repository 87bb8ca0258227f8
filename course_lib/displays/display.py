"""The base classes of displays, their subscriptions, groups of displays, and the viewer's node.

A display never sees ROS or a page. The session (`session.py`) delivers messages to its
subscriptions and calls `update` once per frame; the display changes its own branch of the scene and
its statuses. Everything that RViz's displays have in common is here: the queue of messages that
wait for tf2, the transform to the fixed frame, the statuses with RViz's wording, and the rule which
messages are dropped. A display in another file is therefore a table of properties and the
conversion of a message to drawables.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import count
from typing import Any, ClassVar, Union
from urllib.parse import quote

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Matrix
from course_lib.displays.frames import NS, Frames, ViewTime, nanoseconds
from course_lib.displays.properties import Property, PropertyHolder, flag, integer, text, words
from course_lib.displays.statuses import Statuses, StatusRow, exceptions_as_status
from course_lib.errors import format_count
from course_lib.ros.graph.graph import Graph, Sample
from course_lib.ros.graph.topics import SERVICE_HEADER, Qos, find_incompatible_policy, service_topics
from course_lib.ros.messages import deserialize, serialize, service_class, type_name
from course_lib.viewer.drawables import Camera, Drawable
from course_lib.viewer.scene import Scene

NAME = "rviz2"
_SERVICE = Qos(depth=10)
# An instance of a generated class.
Message = Any


class RvizNode:
    """A node that is added to the graph on first use."""

    def __init__(self, graph: Graph, time: ViewTime) -> None:
        self._graph = graph
        self._time = time
        self._node: int | None = None
        # Endpoint by topic, type and QoS.
        self._publishers: dict[tuple[str, str, Qos], int] = {}
        # Request endpoint by service.
        self._clients: dict[str, int] = {}
        # Callback by request number.
        self._waiting: dict[int, Callable[[Message], None]] = {}
        self._numbers = count(1)

    @property
    def now_ns(self) -> int:
        """ROS time, [ns]."""
        return self._time.ros_ns(self._graph.now_ns)

    def publish(self, topic: str, type_name: str, qos: Qos, message: Message) -> None:
        """Publish a message on a fully resolved topic."""
        self._graph.publish(self.publisher(topic, type_name, qos), serialize(message))

    def publisher(self, topic: str, type_name: str, qos: Qos) -> int:
        """Return the endpoint of a publisher; it is created on first use."""
        key = (topic, type_name, qos)
        if key not in self._publishers:
            self._publishers[key] = self._graph.add_publisher(self._id(), *key)
        return self._publishers[key]

    def withdraw(self, topic: str, type_name: str, qos: Qos) -> None:
        """Remove a publisher, if it exists."""
        endpoint = self._publishers.pop((topic, type_name, qos), None)
        if endpoint is not None:
            self._graph.remove_endpoint(endpoint)

    def has_service(self, name: str) -> bool:
        """Return whether a service is available, by its full name."""
        ends = (end for end in self._graph.endpoints() if end.is_service)
        return any(end.service is not None and end.service[0] == name for end in ends)

    def call(self, name: str, service: str, callback: Callable[[Message], None]) -> None:
        """Send an empty request, and call `callback` with the response.

        Args:
            name: The full name of the service.
            service: The service type, ``visualization_msgs/srv/GetInteractiveMarkers``.
            callback: Called once, with the response.
        """
        kind: Any = service_class(service)
        if name not in self._clients:
            requests, replies = service_topics(name, type_name(kind.Request).removesuffix("_Request"))
            client = self._clients[name] = self._graph.add_publisher(self._id(), *requests, _SERVICE)

            def take(data: bytes, source_ns: int, received_ns: int) -> None:
                addressee, number = SERVICE_HEADER.unpack_from(data)
                if addressee == client and number in self._waiting:
                    response = deserialize(data[SERVICE_HEADER.size :], kind.Response)
                    self._waiting.pop(number)(response)

            self._graph.add_subscription(self._id(), 0, *replies, _SERVICE, take)
        client, number = self._clients[name], next(self._numbers)
        self._waiting[number] = callback
        self._graph.publish(client, SERVICE_HEADER.pack(client, number) + serialize(kind.Request()))

    def close(self) -> None:
        """Remove the node from the graph."""
        if self._node is not None:
            self._graph.remove_node(self._node)
        self._node = None
        for ends in (self._publishers, self._clients, self._waiting):
            ends.clear()

    def _id(self) -> int:
        if self._node is None:
            self._node = self._graph.add_node(NAME, "/")
            self._graph.human_nodes.add(self._node)
        return self._node


# The time that a message waits for its transform before a hint is added, [ns].
HINT_AFTER = NS // 2
# [ns] time between a message that is never shown and a newer, displayed one that removes its hint.
OUTDATED_AFTER = NS
INVALID = "Message contained invalid floating point values (nans or infs)"
GROUP = "rviz_common/Group"
# RViz's names of QoS policies by the fields of Qos; RViz's default comes first.
_POLICIES = {
    "history": ("Keep Last", "Keep All"),
    "reliability": ("Reliable", "Best Effort"),
    "durability": ("Volatile", "Transient Local"),
}


@dataclass(frozen=True)
class Subscription:
    """A display's subscription to a topic.

    Args:
        topic: Fully resolved name.
        type_name: Message type, ``visualization_msgs/msg/Marker``.
        qos: Requested quality of service.
        callback: Called with each message.
        statuses: Show why messages cannot be received.
    """

    topic: str
    type_name: str
    qos: Qos
    callback: Callable[[Any], None]
    statuses: Statuses


@dataclass
class Context:
    """The scene, the frames and the time that all displays of a session share.

    Args:
        scene: Displays draw into it.
        frames: Transforms to the fixed frame.
        time: The time of the view.
        on_subscribe: Called with new subscriptions, to deliver messages that publishers keep for
            them.
        on_change: Called after a property has changed, to draw the change immediately.
        node: The viewer's node in the running graph; None for a recording.
        is_seen: False while no page can show the scene and nothing has requested it.
        has_backlog: Whether received messages have not been processed yet, see `Backlog`.
        process_backlog: Processes them.
        is_drawn: Whether the current frame will be seen, by a page or because it was requested.
    """

    scene: Scene
    frames: Frames
    time: ViewTime
    on_subscribe: Callable[[Iterable[Subscription]], None] = lambda subscriptions: None
    on_change: Callable[[], None] = lambda: None
    node: RvizNode | None = None
    is_seen: bool = True
    has_backlog: bool = False
    process_backlog: Callable[[], None] = lambda: None
    is_drawn: bool = True
    _followed: dict[str, Matrix] = field(default_factory=dict)

    def show(self) -> None:
        """Draw everything that was postponed while no page could show it, and continue to draw."""
        if not self.is_seen:
            self.process_backlog()
            self.is_seen = True
            self.on_change()

    @property
    def now_ns(self) -> int:
        """ROS time, [ns]."""
        return self.time.now_ns

    def follow_frame(self, frame: str) -> tuple[str, Matrix] | None:
        """Return the path of a node moving with a tf frame, and the transform to the fixed frame.

        Returns:
            None if the transform is unknown.
        """
        transform = self.frames.transform(frame)
        if transform is None:
            return None
        path = f"frames/{node_name(frame)}"
        if self._followed.get(path) is not transform:
            self.scene.set_transform(path, transform)
            self._followed[path] = transform
        return path, transform


class Display(PropertyHolder):
    """Base class of all displays.

    Each draws below its node `path` of the scene, in the fixed frame.
    """

    class_name: ClassVar[str] = ""
    properties: tuple[Property, ...] = (Property("Enabled", True, flag),)
    # Whether messages change more than the display's own drawing and statuses, so that they cannot
    # be postponed.
    has_side_effects: ClassVar[bool] = False

    def __init__(self, context: Context, name: str, path: str) -> None:
        super().__init__()
        self._context = context
        self.name = name
        self.path = path
        self._statuses = Statuses()
        self.subscriptions: tuple[Subscription, ...] = ()
        self.is_started = False
        # Whether all enclosing groups are enabled.
        self.is_group_visible = True

    @property
    def context(self) -> Context:
        """The objects that all displays of the session share, with all received messages processed."""
        if self._context.has_backlog:
            self._context.process_backlog()
        return self._context

    @property
    def statuses(self) -> Statuses:
        """The statuses, with all received messages processed."""
        if self._context.has_backlog:
            self._context.process_backlog()
        return self._statuses

    def __setitem__(self, label: str, value: Any) -> None:
        if self._context.has_backlog:
            self._context.process_backlog()
        super().__setitem__(label, value)
        if self.is_started:
            self.context.on_change()

    def __repr__(self) -> str:
        return f"<{self.name} ({self.class_name})>"

    @property
    def _expression(self) -> str:
        return f'viewer["{self.name}"]'

    @property
    def enabled(self) -> bool:
        """Whether the display and all enclosing groups are enabled in RViz's tree."""
        return bool(self["Enabled"]) and self.is_group_visible

    def rows(self) -> list[StatusRow]:
        """Return the statuses as rows; a disabled display has none."""
        return self.statuses.rows(self.name) if self.enabled else []

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set properties from a layout; invalid values are skipped and reported as a hint."""
        wrong = super().load(config)
        self.statuses.hint("Properties", *wrong)
        return wrong

    def on_property_change(self, label: str) -> None:
        """Update the display after a property has changed."""
        if label == "Enabled" and self.is_started:
            self.start()

    def run_safely(self, step: Callable[[], None]) -> None:
        """Start or reset; an exception becomes a status, so that the session continues without it."""
        with exceptions_as_status(self._statuses, "Start"):
            step()

    def apply_change(self, label: str) -> None:
        """Update the display after a property has changed; an exception becomes a status."""
        with exceptions_as_status(self._statuses, "Properties"):
            self.on_property_change(label)

    def start(self) -> None:
        """Start or restart with the current properties."""
        self.is_started = True
        self.reset()

    def update(self) -> None:
        """Bring the scene up to date; called once per frame."""

    def on_view_turn(self, camera: Camera) -> None:
        """Update the display after the user has turned the view."""

    def message_at(self, path: str) -> Any:
        """Return the message from which an object of the scene was drawn, or None if it is unknown."""
        return None

    def reset(self) -> None:
        """Discard all received messages, as RViz does when the fixed frame changes."""
        self.statuses.clear()
        self.context.scene.delete(self.path)
        self.context.scene.set_visible(self.path, self.enabled)


def node_name(name: str) -> str:
    """Encode a name as one component of a scene path."""
    return quote(name, safe=" ()") or "(none)"


class Group:
    """A node of RViz's tree that contains displays and further groups; the root has no name."""

    def __init__(
        self,
        name: str = "",
        config: Mapping[str, Any] | None = None,
        is_enabled: bool = True,
    ) -> None:
        self.name = name
        self.config = dict(config or {})
        self.is_enabled = is_enabled
        self.members: list[Display | Group] = []

    def update_visibility(self, above: bool = True) -> None:
        """Show the displays whose enclosing groups are all enabled, and hide the others."""
        for member in self.members:
            if isinstance(member, Group):
                member.update_visibility(above and self.is_enabled)
            else:
                was_visible, member.is_group_visible = member.is_group_visible, above and self.is_enabled
                if member.is_group_visible != was_visible and member.is_started:
                    member.run_safely(member.start)

    def displays(self) -> Iterator[Display]:
        """Iterate over the displays at any depth, in the order of the tree."""
        for member in self.members:
            yield from member.displays() if isinstance(member, Group) else (member,)

    def groups(self) -> Iterator["Group"]:
        """Iterate over this group and all groups in it."""
        yield self
        for member in self.members:
            if isinstance(member, Group):
                yield from member.groups()

    def find_group_of(self, member: Union[Display, "Group"]) -> "Group":
        """Return the group that directly contains a member of the tree."""
        return next(group for group in self.groups() if any(m is member for m in group.members))


def is_deliverable(sample: Sample, subscription: Subscription, match_qos: bool) -> bool:
    """Return whether type and QoS of a sample match a subscription; add a hint if not."""
    topic, policy, problem = sample.topic, None, None
    if sample.type_name != subscription.type_name:
        problem = f"{topic} carries {sample.type_name}; this display expects {subscription.type_name}."
    elif match_qos and (policy := find_incompatible_policy(sample.qos, subscription.qos)):
        problem = (
            f"{topic} is published with another {policy} than this display requests, so nothing "
            "arrives. Change the display's policy below Topic, or the publisher's QoS."
        )
    subscription.statuses.hint(f"Topic {topic}", *([problem] if problem else []))
    return problem is None


def qos_properties(default: str = "", label: str = "Topic") -> tuple[Property, ...]:
    """Return RViz's Topic property with the quality of service below it."""
    return (
        Property(label, default, text),
        Property(f"{label}/Depth", 5, integer(0)),
        *(
            Property(f"{label}/{field.title()} Policy", options[0], words(*options, "System Default"))
            for field, options in _POLICIES.items()
        ),
    )


def qos_of(holder: PropertyHolder, label: str = "Topic") -> Qos:
    """Return the quality of service described by the properties below a topic."""
    policy_words = {field: holder[f"{label}/{field.title()} Policy"] for field in _POLICIES}
    policies = {
        f: word.lower().replace(" ", "_") for f, word in policy_words.items() if word != "System Default"
    }
    return Qos(depth=holder[f"{label}/Depth"], **policies)


class TopicDisplay(Display):
    """A display that subscribes to a topic.

    Most displays filter their messages: a message waits in a queue until tf2 knows the frame of its
    header at its stamp, like in RViz's MessageFilterDisplay. Other displays process each message on
    arrival, like RViz's RosTopicDisplay; these have a `queue_length` of 0.
    """

    type_name: ClassVar[str]
    topic_label: ClassVar[str] = "Topic"
    # Name of the status with the number of messages.
    status_label: ClassVar[str] = "Topic"
    # Property with the length of the queue.
    queue_label: ClassVar[str] = ""
    properties = (*Display.properties, *qos_properties())

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._count = 0
        self._since_ns = 0
        # Messages without a transform, with the times of their reception, [ns].
        self._waiting: deque[tuple[int, Any]] = deque()
        # Times at which the last processed message was received, and at which the last message was
        # dropped, [ns].
        self._processed_ns = self._dropped_ns = 0

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set properties from a layout, including old ones: ``Topic: /x``, ``Unreliable: true``."""
        topic = config.get(self.topic_label)
        if not isinstance(topic, Mapping):
            unreliable = str(config.get("Unreliable")).lower() == "true"
            reliability = "Best Effort" if unreliable else None
            topic = {"Value": topic, "Depth": config.get("Queue Size"), "Reliability Policy": reliability}
        return super().load({**config, self.topic_label: topic})

    def on_property_change(self, label: str) -> None:
        """Subscribe again when the topic or its quality of service changes."""
        super().on_property_change(label)
        if label.startswith(self.topic_label) and self.is_started:
            self.start()

    def qos(self) -> Qos:
        """Return the requested quality of service."""
        return qos_of(self, self.topic_label)

    def start(self) -> None:
        """Subscribe to the topic, if the display is enabled and has one."""
        super().start()
        self._since_ns = self.context.now_ns
        self.subscriptions = ()
        if not self.enabled:
            return
        if not self[self.topic_label]:
            self.statuses.set("error", self.status_label, "Error subscribing: Empty topic name")
            return
        self.statuses.set("ok", self.status_label, "OK")
        self.subscriptions = self.make_subscriptions()
        self.context.on_subscribe(self.subscriptions)

    def make_subscriptions(self) -> tuple[Subscription, ...]:
        """Return the subscriptions that the properties request."""
        return (self.subscription(self[self.topic_label], self.type_name, self.receive),)

    def subscription(
        self,
        topic: str,
        type_name: str,
        callback: Any,
        qos: Qos | None = None,
    ) -> Subscription:
        """Return a subscription; without `qos` it has the display's quality of service."""
        return Subscription(
            "/" + topic.removeprefix("/"), type_name, qos or self.qos(), callback, self.statuses
        )

    def reset(self) -> None:
        """Discard all messages, including queued ones."""
        super().reset()
        self._count = 0
        self._waiting.clear()
        self._processed_ns = self._dropped_ns = 0

    def receive(self, message: Any) -> None:
        """Process a message, or queue it until its transform is known.

        If the queue is full the oldest message is dropped, as is one that is older than the cache
        of tf2.
        """
        if not self.queue_length or not hasattr(message, "header"):
            self._accept(message, self.context.now_ns)
        elif not message.header.frame_id.removeprefix("/"):
            self._drop(message, "the frame id of the message is empty")
        else:
            self._waiting.append((self.context.now_ns, message))
            self._process_queue()
            if len(self._waiting) > self.queue_length:
                self._drop(self._waiting.popleft()[1], "discarding message because the queue is full")

    def update(self) -> None:
        """Process the queued messages whose transform is known by now."""
        if self.queue_length:
            self._process_queue()

    @property
    def queue_length(self) -> int:
        """The number of messages that wait for tf2; 0 without a message filter."""
        return int(self[self.queue_label]) if self.queue_label else 0

    def count_status(self, what: str = "messages") -> str:
        """Return RViz's status with the number of messages and their rate."""
        elapsed = (self.context.now_ns - self._since_ns) / NS  # [s]
        rate = self._count / elapsed if elapsed else float("inf")
        return f"{self._count} {what} received at {rate:.1f} hz."

    def process(self, message: Any) -> None:
        """Show a message whose transform is known."""
        raise NotImplementedError

    def transform_problem(self, message: Any) -> str | None:
        """Return why a message has to wait, or None if its transform is known."""
        frame = message.header.frame_id.removeprefix("/")
        return self.context.frames.problem(frame, nanoseconds(message.header.stamp))

    def transform_at(
        self,
        header: Any,
        known: bool = True,
        stamp_ns: int | None = None,
    ) -> Matrix | None:
        """Return the transform from a header's frame to the fixed frame at its stamp, and set its status.

        Args:
            header: A std_msgs/msg/Header.
            known: False reports an unknown transform in any case, because another required frame is
                missing.
            stamp_ns: Time to use in place of the header's stamp, [ns]; 0 means the latest.
        """
        stamp_ns = nanoseconds(header.stamp) if stamp_ns is None else stamp_ns
        transform = self.context.frames.transform(header.frame_id, stamp_ns)
        if known and transform is not None:
            self.statuses.set("ok", "Transform", "Ok")
            return transform
        problem = f"Could not transform from [{header.frame_id}] to [{self.context.frames.fixed_frame}]"
        self.statuses.set("error", "Transform", problem)
        return None

    def _accept(self, message: Any, received_ns: int) -> None:
        self._count += 1
        self._processed_ns = max(self._processed_ns, received_ns)
        self.statuses.set("ok", self.status_label, self.count_status())
        self.process(message)

    def _process_queue(self) -> None:
        waiting = list(self._waiting)
        self._waiting.clear()
        for received_ns, message in waiting:
            if self.transform_problem(message) is None:
                # An exception that one message raises must not discard the messages after it.
                with exceptions_as_status(self._statuses, "Message"):
                    self._accept(message, received_ns)
            elif self.context.frames.is_too_old(message.header.frame_id, nanoseconds(message.header.stamp)):
                self._drop(message, OUT_OF_CACHE)
            else:
                self._waiting.append((received_ns, message))
        # RViz keeps a message without a transform until newer ones fill the queue. It gets no hint
        # any more when newer messages are shown: the publisher has been corrected, or replaced.
        if self._processed_ns - self._dropped_ns >= OUTDATED_AFTER:
            self.statuses.hint("Dropped")
        remaining = [
            m for received_ns, m in self._waiting if self._processed_ns - received_ns < OUTDATED_AFTER
        ]
        problem = None
        if remaining:
            # A message that only waits for the next transform is normal. It gets a hint if its
            # frame is unknown, or if its stamp is far from the current time.
            header = remaining[0].header
            distance_ns = abs(self.context.now_ns - nanoseconds(header.stamp))
            if self.context.frames.transform(header.frame_id) is None or distance_ns > HINT_AFTER:
                problem = self.transform_problem(remaining[-1])
        hint = [f"{format_count(len(remaining), 'message')} waiting for tf2. {problem}"] if problem else []
        self.statuses.hint("Waiting", *hint)

    def _drop(self, message: Any, reason: str) -> None:
        """Report a dropped message as a hint, with the text that RViz writes to its log."""
        header = message.header
        self._dropped_ns = self.context.now_ns
        self.statuses.hint(
            "Dropped",
            f"RViz's log: Message Filter dropping message: frame '{header.frame_id}' at time "
            f"{nanoseconds(header.stamp) / NS:.3f} for reason '{reason}'",
        )


# RViz2's reason for a message that is older than tf2's cache of 10 s.
OUT_OF_CACHE = "the timestamp on the message is earlier than all the data in the transform cache"
QUEUE_LABEL = "Topic/Filter size"
FILTER_PROPERTIES = (*TopicDisplay.properties, Property(QUEUE_LABEL, 10, integer(1)))
# The number of messages that are drawn again with each new one.
_SHORT_HISTORY = 20


class DrawnDisplay(TopicDisplay):
    """A display that keeps the last messages in converted form, and draws them according to its properties.

    A subclass implements `drawables`, and `numbers`, which must be finite, or `convert`, or both. A
    display in the frame of its message usually keeps the numbers, which is the default.
    """

    queue_label = QUEUE_LABEL
    # The property with the number of kept messages, where 0 means all; without one, the last
    # message is kept.
    length_label: ClassVar[str] = ""
    # Whether drawables are in the frame of the last message instead of the fixed frame.
    is_in_message_frame: ClassVar[bool] = False
    properties = FILTER_PROPERTIES

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        length = self[self.length_label] if self.length_label else 1
        self.history: deque[Any] = deque(maxlen=length or None)
        # Whether the drawing of a long history is out of date.
        self._is_stale = False

    def numbers(self, message: Any) -> npt.ArrayLike:
        """Return the numbers of a message that must be finite."""
        return ()

    def convert(self, message: Any, transform_frame_to_fixed: Matrix) -> Any:
        """Convert a message to the form in which it is kept, by default its numbers."""
        return self.numbers(message)

    def drawables(self) -> Mapping[str, Drawable]:
        """Return the drawables of all kept messages by name."""
        raise NotImplementedError

    def process(self, message: Any) -> None:
        """Convert, keep and draw a message if its numbers are finite and its transform is known."""
        if not np.isfinite(self.numbers(message)).all():
            self.statuses.set("error", "Topic", INVALID)
            return
        transform = self.transform_at(message.header)
        if transform is not None and self.is_in_message_frame:
            self.context.scene.set_transform(f"{self.path}/drawn", transform)
        if transform is not None:
            self.keep(self.convert(message, transform))

    def keep(self, converted: Any) -> None:
        """Keep a converted message, and redraw.

        To draw a long history again for each message would take quadratic time, so it is drawn once
        per frame.
        """
        self.history.append(converted)
        if len(self.history) > _SHORT_HISTORY:
            self._is_stale = True
        else:
            self.draw()

    def update(self) -> None:
        """Process the queued messages, and draw a long history that has changed."""
        super().update()
        if self._is_stale:
            self._is_stale = False
            self.draw()

    def reset(self) -> None:
        """Discard all kept messages."""
        super().reset()
        self.history.clear()

    def on_property_change(self, label: str) -> None:
        """Redraw. RViz clears a buffer when its length changes, but truncates a history."""
        if label == self.length_label:
            history = () if label == "Buffer Length" else self.history
            self.history = deque(history, self[label] or None)
        super().on_property_change(label)
        if self.is_started:
            self.draw()

    def draw(self) -> None:
        """Put the drawables into the scene, replacing earlier ones."""
        scene, node, drawables = self.context.scene, f"{self.path}/drawn", self.drawables()
        if previous := scene.find(node):
            for name in {path.rpartition("/")[2] for path in previous.children} - drawables.keys():
                scene.delete(f"{node}/{name}")
        for name, drawable in drawables.items():
            scene.set_object(f"{node}/{name}", drawable)
