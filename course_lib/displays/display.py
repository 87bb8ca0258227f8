"""The base of all displays: messages in, scene out, properties and statuses; and groups of displays."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Union
from urllib.parse import quote

from course_lib.arrays import Matrix
from course_lib.displays.frames import Frames
from course_lib.displays.node import RvizNode
from course_lib.displays.properties import Property, PropertyHolder, flag
from course_lib.displays.statuses import Statuses, StatusRow
from course_lib.displays.view_time import ViewTime
from course_lib.ros.graph import Sample
from course_lib.ros.qos import Qos, incompatible
from course_lib.viewer.camera import Camera
from course_lib.viewer.scene import Scene


@dataclass(frozen=True)
class Interest:
    """A display's subscription to a topic."""

    topic: str  # fully resolved name
    type_name: str  # ``visualization_msgs/msg/Marker``
    qos: Qos  # what it requests
    take: Callable[[Any], None]  # called with each message
    statuses: Statuses  # where to say that messages cannot come


@dataclass
class Context:
    """The scene, the frames and the time that all displays of a session share."""

    scene: Scene  # what they draw into
    frames: Frames  # where frames are
    time: ViewTime
    # called with new interests, to get what publishers hold for latecomers
    joined: Callable[[Iterable[Interest]], None] = lambda interests: None
    # called when a property has changed, to show it immediately
    touched: Callable[[], None] = lambda: None
    node: RvizNode | None = None  # of the viewer in the running graph; a recording has none
    is_seen: bool = True  # False where no page can show the scene, as long as nobody asks for it
    owes: bool = False  # True while messages wait that nobody has asked for yet
    settle: Callable[[], None] = lambda: None  # processes them
    draws: bool = True  # whether the frame that is made is seen: by a page, or because somebody asks for it
    _followed: dict[str, Matrix] = field(default_factory=dict)

    def show(self) -> None:
        """Draw what was left out while no page could show it, and all that comes from now on."""
        if not self.is_seen:
            self.settle()
            self.is_seen = True
            self.touched()

    @property
    def now_ns(self) -> int:
        """ROS time, [ns]."""
        return self.time.now_ns

    def follow(self, frame: str) -> tuple[str, Matrix] | None:
        """Return a node of the scene that moves with a frame, and its transform to the fixed frame.

        Returns:
            None if it is not known where the frame is.
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
    """Base of all displays; each draws below its own node of the scene, `path`, in the fixed frame."""

    class_name: ClassVar[str] = ""
    properties: tuple[Property, ...] = (Property("Enabled", True, flag),)
    acts: ClassVar[bool] = False  # whether messages change more than its picture and its statuses

    def __init__(self, context: Context, name: str, path: str) -> None:
        super().__init__()
        self._context = context
        self.name = name
        self.path = path
        self._statuses = Statuses()
        self.interests: tuple[Interest, ...] = ()
        self.started = False
        self._grouped = True  # whether the groups it is in are ticked

    @property
    def context(self) -> Context:
        """The parts that all displays of the session share, after all messages so far."""
        if self._context.owes:
            self._context.settle()
        return self._context

    @property
    def statuses(self) -> Statuses:
        """Its statuses, as they are after all messages so far."""
        if self._context.owes:
            self._context.settle()
        return self._statuses

    def __setitem__(self, label: str, value: Any) -> None:
        if self._context.owes:
            self._context.settle()
        super().__setitem__(label, value)
        if self.started:
            self.context.touched()

    def __repr__(self) -> str:
        return f"<{self.name} ({self.class_name})>"

    @property
    def enabled(self) -> bool:
        """Display and all its groups are ticked in RViz's tree."""
        return bool(self["Enabled"]) and self._grouped

    def rows(self) -> list[StatusRow]:
        """List the statuses; a display that is not ticked has none."""
        return self.statuses.rows(self.name) if self.enabled else []

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set properties from a layout; values that do not fit are skipped and shown as a hint."""
        wrong = super().load(config)
        self.statuses.hint("Properties", *wrong)
        return wrong

    def changed(self, label: str) -> None:
        """React to a property's new value."""
        if label == "Enabled" and self.started:
            self.start()

    def show_in_group(self, ticked: bool) -> None:
        """Show or hide what is in a group."""
        if ticked != self._grouped:
            self._grouped = ticked
            if self.started:
                self.start()

    def start(self) -> None:
        """Restart, with the interests that the properties request."""
        self.started = True
        self.reset()

    def update(self) -> None:
        """Bring the scene up to date; called once per frame."""

    def look_from(self, camera: Camera) -> None:
        """React to a view that was turned by hand."""

    def message_at(self, path: str) -> Any:
        """Return the message that an object of the scene was drawn from, or None if that is not known."""
        return None

    def reset(self) -> None:
        """Forget all that has been received, as RViz does when the fixed frame changes."""
        self.statuses.clear()
        self.context.scene.delete(self.path)
        self.context.scene.set_visible(self.path, self.enabled)


def node_name(name: str) -> str:
    """Return a name as one step of a path in the scene."""
    return quote(name, safe=" ()") or "(none)"


GROUP = "rviz_common/Group"


class Group:
    """A node of RViz's tree that holds displays and further groups; the root is one without a name."""

    def __init__(self, name: str = "", config: Mapping[str, Any] | None = None, ticked: bool = True) -> None:
        self.name = name
        self.config = dict(config or {})  # of the layout it comes from
        self.ticked = ticked
        self.members: list[Display | Group] = []

    def tick(self, above: bool = True) -> None:
        """Show or hide the displays below, as all groups above them are ticked or not."""
        for member in self.members:
            if isinstance(member, Group):
                member.tick(above and self.ticked)
            else:
                member.show_in_group(above and self.ticked)

    def displays(self) -> Iterator[Display]:
        """Iterate over the displays in it, at any depth, in the order of the tree."""
        for member in self.members:
            yield from member.displays() if isinstance(member, Group) else (member,)

    def groups(self) -> Iterator["Group"]:
        """Iterate over this group and all groups in it."""
        yield self
        for member in self.members:
            if isinstance(member, Group):
                yield from member.groups()

    def holder(self, wanted: Union[Display, "Group"]) -> "Group":
        """Return the group that holds a member of the tree directly."""
        return next(group for group in self.groups() if any(m is wanted for m in group.members))


def reaches(sample: Sample, interest: Interest, match_qos: bool) -> bool:
    """Return whether a sample reaches an interest in its topic; add a hint if not."""
    topic, policy, problem = sample.topic, None, None
    if sample.type_name != interest.type_name:
        problem = f"{topic} carries {sample.type_name}; this display takes {interest.type_name}."
    elif match_qos and (policy := incompatible(sample.qos, interest.qos)):
        problem = (
            f"{topic} is published with another {policy} than this display asks for, so nothing arrives. "
            "Change the display's policy below Topic, or the publisher's QoS."
        )
    interest.statuses.hint(f"Topic {topic}", *([problem] if problem else []))
    return problem is None


def hint_at_held(interest: Interest) -> None:
    """Add the hint that a publisher holds a message for latecomers, which this display does not request."""
    topic = interest.topic
    text = (
        f"{topic} was published before this display was here, and its publisher holds it for latecomers; "
        "ask for it with Durability Policy: Transient Local."
    )
    interest.statuses.hint(f"Topic {topic}", text)


def silence(display: Display, types: Mapping[str, str]) -> list[StatusRow]:
    """List the topics, of those with messages, that a display without messages could subscribe to."""
    topics = {interest.topic for interest in display.interests}
    wanted = {interest.type_name for interest in display.interests}
    others = sorted(topic for topic, name in types.items() if name in wanted)
    if not topics or topics & types.keys() or not others:
        return []
    text = f"nothing has come on {min(topics)}; messages of its type come on {', '.join(others)}."
    return [StatusRow(display.name, "Topic", "hint", text)]
