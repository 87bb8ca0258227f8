"""What all displays share: messages in, scene out, properties and statuses by RViz's names."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar
from urllib.parse import quote

from course_lib.arrays import Matrix
from course_lib.displays.frames import Frames
from course_lib.displays.properties import Property, PropertyHolder, flag
from course_lib.displays.statuses import Statuses, StatusRow
from course_lib.ros.qos import Qos
from course_lib.viewer.scene import Scene


@dataclass(frozen=True)
class Interest:
    """What a display wants to hear."""

    topic: str  # fully resolved name
    type_name: str  # ``visualization_msgs/msg/Marker``
    qos: Qos  # what it requests
    take: Callable[[Any], None]  # called with each message
    statuses: Statuses  # where to say that messages cannot come


@dataclass
class Context:
    """What displays work with, one for all of a session."""

    scene: Scene  # what they draw into
    frames: Frames  # where frames are
    now_ns: int = 0  # robot time, [ns]
    # called with new interests, to get what publishers hold for latecomers
    joined: Callable[[Iterable[Interest]], None] = lambda interests: None
    # called when somebody has changed a property, to show it at once
    touched: Callable[[], None] = lambda: None
    _followed: dict[str, Matrix] = field(default_factory=dict)

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

    def __init__(self, context: Context, name: str, path: str) -> None:
        super().__init__()
        self.context = context
        self.name = name
        self.path = path
        self.statuses = Statuses()
        self.interests: tuple[Interest, ...] = ()
        self.started = False
        self._grouped = True  # whether the groups it is in are ticked

    def __setitem__(self, label: str, value: Any) -> None:
        super().__setitem__(label, value)
        if self.started:
            self.context.touched()

    def __repr__(self) -> str:
        return f"<{self.name} ({self.class_name})>"

    @property
    def enabled(self) -> bool:
        """Whether the display is ticked in RViz's tree, and all groups that it is in."""
        return bool(self["Enabled"]) and self._grouped

    def rows(self) -> list[StatusRow]:
        """List the statuses; a display that is not ticked has none."""
        return self.statuses.rows(self.name) if self.enabled else []

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Take the properties of a layout; what does not fit is left out and shown as a hint."""
        wrong = super().load(config)
        self.statuses.hint("Properties", *wrong)
        return wrong

    def changed(self, label: str) -> None:
        """Take note that a property has another value."""
        if label == "Enabled" and self.started:
            self.start()

    def show_in_group(self, ticked: bool) -> None:
        """Show or hide what is in a group."""
        if ticked != self._grouped:
            self._grouped = ticked
            if self.started:
                self.start()

    def start(self) -> None:
        """Start anew, with the interests that the properties ask for."""
        self.started = True
        self.reset()

    def update(self) -> None:
        """Bring the scene up to date; called once per frame."""

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
