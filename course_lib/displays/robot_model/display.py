"""The RobotModel display."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from course_lib.displays.display import node_name
from course_lib.displays.frames import NS
from course_lib.displays.properties import Property, flag, number, text, words
from course_lib.displays.robot_model.links import DrawnLink, Wanted
from course_lib.displays.topic_display import TopicDisplay, topic_properties
from course_lib.errors import CourseError
from course_lib.robots.urdf import links_of, parse_urdf
from course_lib.ros.qos import Qos

_STYLES = (
    "Links in Alphabetic Order",
    "Joints in Alphabetic Order",
    "Tree of links",
    "Tree of links and joints",
    "",
)
_ALL = "Links/All Links Enabled"
_TOPIC = "Description Topic"
_SWITCHES = {
    "visual": "Visual Enabled",
    "collision": "Collision Enabled",
    "mass": "Mass Properties/Mass",
    "inertia": "Mass Properties/Inertia",
}
_OF_LINKS = {"axes": "Show Axes", "trail": "Show Trail"}


class RobotModelDisplay(TopicDisplay):
    """A robot by its description, each link at its tf2 frame; joint states are not subscribed to."""

    class_name = "rviz_default_plugins/RobotModel"
    type_name = "std_msgs/msg/String"
    topic_label = _TOPIC
    properties = (
        *topic_properties(label=_TOPIC),
        Property("Alpha", 1.0, number(0.0, 1.0)),
        Property("Collision Enabled", False, flag),
        Property("Description File", "", text),
        Property("Description Source", "Topic", words("Topic", "File")),
        Property(_ALL, True, flag),
        *(
            Property(f"Links/Expand {what}", False, flag)
            for what in ("Joint Details", "Link Details", "Tree")
        ),
        Property("Links/Link Tree Style", _STYLES[0], words(*_STYLES)),
        Property("Mass Properties/Inertia", False, flag),
        Property("Mass Properties/Mass", False, flag),
        Property("TF Prefix", "", text),
        Property("Update Interval", 0.0, number(0.0)),  # [s]
        Property("Visual Enabled", True, flag),
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._urdf: str | None = None
        self._links: list[DrawnLink] = []  # by name
        self._updated_ns: int | None = None  # when links were placed last; None asks for it now

    def qos(self) -> Qos:
        """Ask for what is latched, whatever the properties show, until one of them is changed."""
        policies = [prop for prop in self.properties if prop.label.startswith(f"{_TOPIC}/")]
        changed = any(self[prop.label] != prop.default for prop in policies)
        return super().qos() if changed else Qos(depth=1, durability="transient_local")

    def changed(self, label: str) -> None:
        """Restart with another description; other properties apply from the next frame on."""
        super().changed(label)
        switches = [f"Links/{link.name}" for link in self._links if link.has_geometry]
        if label == _ALL:
            self._values |= dict.fromkeys(switches, self[_ALL])
        elif label in switches:
            self._values[_ALL] = all(self[switch] for switch in switches)
        elif label == "TF Prefix" and self.started:
            self.reset()
        elif label in ("Description File", "Description Source") and self.started:
            self.start()
        self._updated_ns = None

    def start(self) -> None:
        """Forget the robot, and read its file or listen to the topic."""
        self._urdf = None
        if self["Description Source"] == "Topic":
            super().start()
            return
        self.interests = ()
        super(TopicDisplay, self).start()
        if self.enabled and self._file:
            self._read(self._file)

    def reset(self) -> None:
        """Redraw the robot: it stays the same in another fixed frame."""
        super().reset()
        self._load()

    def process(self, message: Any) -> None:
        """Draw the robot of a description."""
        self._urdf = message.data
        self._load()

    def update(self) -> None:
        """Place the links where tf2 has them; a frame that nobody sees needs none."""
        if not self.context.draws:
            return
        now_ns, last_ns = self.context.now_ns, self._updated_ns
        if last_ns is not None and now_ns - last_ns < self["Update Interval"] * NS:
            return
        self._updated_ns = now_ns
        before = self._problems()
        for link in self._links:
            self._place(link)
        if self._problems() != before:
            self._say_problems()

    @property
    def _file(self) -> Path | None:
        """The file that the description is from."""
        named = self["Description File"]
        return Path(named) if named and self["Description Source"] == "File" else None

    def _read(self, file: Path) -> None:
        try:
            self._urdf = file.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            self.statuses.hint("URDF", f"{file}: {error}")
        if self._urdf:
            self._load()
        else:
            self.statuses.set("error", "URDF", "URDF is empty")

    def _load(self) -> None:
        """Create the links of the description, in place of earlier ones."""
        self.context.scene.delete(f"{self.path}/links")
        self._links, self._updated_ns = [], None
        self.shrink("Links")
        if self._urdf is None:
            return
        try:
            parse_urdf(self._urdf)
        except CourseError as error:
            self.statuses.clear()
            self.statuses.set("error", "URDF", "URDF failed Model parse")
            self.statuses.hint("URDF", str(error))
            return
        self.statuses.hint("URDF")
        self.statuses.set("ok", "URDF", "URDF parsed OK")
        scene, path = self.context.scene, f"{self.path}/links"
        self._links = [
            DrawnLink(scene, f"{path}/{node_name(link.name)}", link, self._file)
            for link in sorted(links_of(self._urdf), key=lambda link: link.name)
        ]
        wrong = self.grow(*(prop for link in self._links for prop in _properties(link)))
        self.statuses.hint("Links", *wrong)
        self._say_problems()

    def _place(self, link: DrawnLink) -> None:
        prefix, frames = self["TF Prefix"], self.context.frames
        frame = f"{prefix}/{link.name}" if prefix else link.name
        transform = frames.transform(frame)
        if transform is None:
            self.statuses.set("error", frame, f"No transform from [{frame}] to [{frames.fixed_frame}]")
        else:
            self.statuses.set("ok", frame, "Transform OK")
            link.place(transform)
        here = f"Links/{link.name}"
        ticked = self[here] if link.has_geometry else True
        shown = {kind: ticked and self[label] for kind, label in _SWITCHES.items()}
        shown |= {kind: ticked and self[f"{here}/{label}"] for kind, label in _OF_LINKS.items()}
        alpha = self["Alpha"] * self[f"{here}/Alpha"]
        link.show(Wanted(shown, alpha, transform is None, self.context.is_seen))

    def _problems(self) -> str:
        """List in RViz's words the shapes that could not be loaded."""
        failed = (link for link in self._links if link.looks.errors)
        return "".join(f"\n• for link '{link.name}':\n" + "\n".join(link.looks.errors) for link in failed)

    def _say_problems(self) -> None:
        if problems := self._problems():
            self.statuses.set("error", "URDF", f"Errors loading geometries:{problems}")


def _properties(link: DrawnLink) -> Iterator[Property]:
    """Yield the properties of a link; it has no box to tick if it cannot be seen."""
    here, names = f"Links/{link.name}", ("Links", link.name)
    if link.has_geometry:
        yield Property(here, True, flag, names)
    yield Property(f"{here}/Alpha", 1.0, number(0.0, 1.0), (*names, "Alpha"))
    for label in _OF_LINKS.values():
        yield Property(f"{here}/{label}", False, flag, (*names, label))
