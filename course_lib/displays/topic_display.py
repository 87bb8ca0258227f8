"""Displays of a topic: with RViz's filter that waits for transforms, and with a picture of what they keep."""

from collections import deque
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Matrix
from course_lib.displays.display import Display, Interest
from course_lib.displays.frames import NS, nanoseconds
from course_lib.displays.properties import Property, PropertyHolder, integer, text, words
from course_lib.errors import counted
from course_lib.ros.qos import Qos
from course_lib.viewer.drawables import Drawable

HINT_AFTER = NS // 2  # [ns] that a message waits for a known frame before a hint is added
# By the fields of Qos; in RViz's words, its default first.
_POLICIES = {
    "history": ("Keep Last", "Keep All"),
    "reliability": ("Reliable", "Best Effort"),
    "durability": ("Volatile", "Transient Local"),
}


def topic_properties(default: str = "", label: str = "Topic") -> tuple[Property, ...]:
    """Return the properties of a display with a topic."""
    return (*Display.properties, *with_qos(default, label))


def with_qos(default: str = "", label: str = "Topic") -> tuple[Property, ...]:
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
    """Return the quality of service that the properties below a topic say."""
    said = {field: holder[f"{label}/{field.title()} Policy"] for field in _POLICIES}
    policies = {f: word.lower().replace(" ", "_") for f, word in said.items() if word != "System Default"}
    return Qos(depth=holder[f"{label}/Depth"], **policies)


class TopicDisplay(Display):
    """A display that shows each message of its topic at once (RViz's RosTopicDisplay)."""

    type_name: ClassVar[str]
    topic_label: ClassVar[str] = "Topic"
    status_label: ClassVar[str] = "Topic"  # name of the status of its messages
    properties = topic_properties()

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._received = 0
        self._since_ns = 0

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set properties from a layout; older than Galactic, it has ``Topic: /x``, ``Unreliable: true``."""
        topic = config.get(self.topic_label)
        if not isinstance(topic, Mapping):
            unreliable = str(config.get("Unreliable")).lower() == "true"
            reliability = "Best Effort" if unreliable else None
            topic = {"Value": topic, "Depth": config.get("Queue Size"), "Reliability Policy": reliability}
        return super().load({**config, self.topic_label: topic})

    def changed(self, label: str) -> None:
        """Resubscribe when the topic or its quality of service changes."""
        super().changed(label)
        if label.startswith(self.topic_label) and self.started:
            self.start()

    def qos(self) -> Qos:
        """Return what the display requests of publishers."""
        return qos_of(self, self.topic_label)

    def start(self) -> None:
        """Listen to the topic, if the display is ticked and has one."""
        super().start()
        self._since_ns = self.context.now_ns
        self.interests = ()
        if not self.enabled:
            return
        if not self[self.topic_label]:
            self.statuses.set("error", self.status_label, "Error subscribing: Empty topic name")
            return
        self.statuses.set("ok", self.status_label, "OK")
        self.interests = self.wanted()
        self.context.joined(self.interests)

    def wanted(self) -> tuple[Interest, ...]:
        """Return what the display listens to."""
        return (self.interest(self[self.topic_label], self.type_name, self.take),)

    def interest(self, topic: str, type_name: str, take: Any, qos: Qos | None = None) -> Interest:
        """Return an interest, with the display's quality of service if there is no other."""
        return Interest("/" + topic.removeprefix("/"), type_name, qos or self.qos(), take, self.statuses)

    def reset(self) -> None:
        """Forget all messages."""
        super().reset()
        self._received = 0

    def take(self, message: Any) -> None:
        """Count a message and show it."""
        self._received += 1
        self.statuses.set("ok", self.status_label, self.received())
        self.process(message)

    def received(self, what: str = "messages") -> str:
        """Return RViz's status of the number of messages, and of their rate."""
        elapsed = (self.context.now_ns - self._since_ns) / NS  # [s]
        rate = self._received / elapsed if elapsed else float("inf")
        return f"{self._received} {what} received at {rate:.1f} hz."

    def process(self, message: Any) -> None:
        """Show a message."""
        raise NotImplementedError

    def transform_at(self, header: Any, known: bool = True, stamp_ns: int | None = None) -> Matrix | None:
        """Return the transform from a header's frame to the fixed frame at its stamp, and say if it is known.

        Args:
            header: A std_msgs/msg/Header.
            known: False if something that belongs to the message cannot be placed, whatever tf2 knows.
            stamp_ns: Instead of its stamp, [ns]; 0 takes the latest.
        """
        stamp_ns = nanoseconds(header.stamp) if stamp_ns is None else stamp_ns
        transform = self.context.frames.transform(header.frame_id, stamp_ns)
        if known and transform is not None:
            self.statuses.set("ok", "Transform", "Ok")
            return transform
        problem = f"Could not transform from [{header.frame_id}] to [{self.context.frames.fixed_frame}]"
        self.statuses.set("error", "Transform", problem)
        return None


class FilteredDisplay(TopicDisplay):
    """A display whose messages wait until tf2 knows their frame at their stamp (MessageFilterDisplay)."""

    queue_label: ClassVar[str] = "Topic/Filter size"  # of the property with the length of the queue
    properties = (*topic_properties(), Property(queue_label, 10, integer(1)))

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._waiting: deque[Any] = deque()

    def reset(self) -> None:
        """Forget all messages, waiting ones too."""
        super().reset()
        self._waiting.clear()

    def take(self, message: Any) -> None:
        """Queue a message until its transform is known; the oldest is dropped when too many wait."""
        if not message.header.frame_id.removeprefix("/"):
            self._dropped(message, "the frame id of the message is empty")
            return
        self._waiting.append(message)
        self._let_through()
        if len(self._waiting) > self[self.queue_label]:
            self._dropped(self._waiting.popleft(), "discarding message because the queue is full")

    def update(self) -> None:
        """Show what tf2 knows by now."""
        self._let_through()

    def _let_through(self) -> None:
        still: list[Any] = []
        while self._waiting:
            message = self._waiting.popleft()
            if self.problem(message) is None:
                super().take(message)
            else:
                still.append(message)
        self._waiting.extend(still)
        problem = self.problem(still[-1]) if still and self._waits_long(still[0]) else None
        self.statuses.hint(
            "Waiting", *([f"{counted(len(still), 'message')} waiting for tf2. {problem}"] if problem else [])
        )

    def _waits_long(self, message: Any) -> bool:
        """Return whether a message is too far from robot time to be waiting for just the next transform."""
        known = self.context.frames.transform(message.header.frame_id) is not None
        return not known or abs(self.context.now_ns - nanoseconds(message.header.stamp)) > HINT_AFTER

    def problem(self, message: Any) -> str | None:
        """Return the reason for a message to wait; None if it can be drawn."""
        frame = message.header.frame_id.removeprefix("/")
        return self.context.frames.problem(frame, nanoseconds(message.header.stamp))

    def _dropped(self, message: Any, reason: str) -> None:
        """Repeat what RViz writes to its log only."""
        header = message.header
        stamp = nanoseconds(header.stamp) / NS  # [s]
        self.statuses.hint(
            "Dropped",
            f"RViz's log: Message Filter dropping message: frame '{header.frame_id}' at time {stamp:.3f} "
            f"for reason '{reason}'",
        )


INVALID = "Message contained invalid floating point values (nans or infs)"


class DrawnDisplay(FilteredDisplay):
    """A display whose picture is made of its properties and of what it keeps: of one message, or of more."""

    length_label: ClassVar[str] = ""  # of the property with the number of kept messages; 0 keeps all
    in_frame: ClassVar[bool] = (
        False  # whether the parts lie in the last message's frame, not in the fixed one
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.kept: deque[Any] = deque(maxlen=(self[self.length_label] or None) if self.length_label else 1)

    def numbers(self, message: Any) -> npt.ArrayLike:
        """Return those numbers of a message that must be finite."""
        return ()

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Any:
        """Return what is to be kept of a message."""
        raise NotImplementedError

    def parts(self) -> Mapping[str, Drawable]:
        """Return what is to be seen, by name; nothing before the first message."""
        raise NotImplementedError

    def process(self, message: Any) -> None:
        """Show a message, if its numbers are finite and its frame is known."""
        if not np.isfinite(self.numbers(message)).all():
            self.statuses.set("error", "Topic", INVALID)
            return
        transform = self.transform_at(message.header)
        if transform is not None and self.in_frame:
            self.context.scene.set_transform(f"{self.path}/drawn", transform)
        if transform is not None:
            self.keep(self.made(message, transform))

    def keep(self, thing: Any) -> None:
        """Keep one more, and draw."""
        self.kept.append(thing)
        self.draw()

    def reset(self) -> None:
        """Forget all that was kept."""
        super().reset()
        self.kept.clear()

    def changed(self, label: str) -> None:
        """Redraw; RViz empties its buffers when their length changes, and cuts its histories."""
        if label == self.length_label:
            self.kept = deque(() if label == "Buffer Length" else self.kept, self[label] or None)
        super().changed(label)
        if self.started:
            self.draw()

    def draw(self) -> None:
        """Put the parts into the scene, in place of those that are there."""
        scene, node, parts = self.context.scene, f"{self.path}/drawn", self.parts()
        old = scene.find(node)
        gone = {path.rpartition("/")[2] for path in old.children} - parts.keys() if old else ()
        for name in gone:
            scene.delete(f"{node}/{name}")
        for name, drawable in parts.items():
            scene.set_object(f"{node}/{name}", drawable)
