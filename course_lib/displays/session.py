"""RViz without a window: its displays, and the order in which messages change the scene."""

from collections.abc import Callable, Iterable, Mapping
from itertools import chain
from typing import Any

from course_lib.displays.display import (
    GROUP,
    Context,
    Display,
    Group,
    Interest,
    hint_at_held,
    node_name,
    reaches,
    silence,
)
from course_lib.displays.frames import Frames, frame_name
from course_lib.displays.layout import Layout, Options, text_at
from course_lib.displays.own_topics import OwnTopics
from course_lib.displays.panel.tools import all_tools, load_tools
from course_lib.displays.registry import make_display
from course_lib.displays.statuses import Statuses, StatusRow, StatusTable
from course_lib.displays.view_time import ViewTime
from course_lib.displays.views import Orbit, ViewController, view_of
from course_lib.ros.graph import Sample
from course_lib.viewer.camera import Camera
from course_lib.viewer.scene import Scene, summary


class RvizSession:
    """RViz's displays without a window: messages come in, and a scene is kept of them frame by frame.

    What has come waits for the next frame; then it is placed, expired things go, what follows a frame of the
    robot moves. A frame is due 1/30 s of robot time after the first thing that waits, or when somebody looks.

    Args:
        scene: What to draw into.
        fixed_frame: RViz's Fixed Frame.
        start_ns: Robot time, [ns].
        match_qos: Whether messages only come from publishers that match, as live; a recording has them all.
        use_sim_time: RViz's parameter.
    """

    def __init__(
        self,
        scene: Scene,
        fixed_frame: str = "map",
        start_ns: int = 0,
        match_qos: bool = True,
        use_sim_time: bool = False,
    ) -> None:
        self.time = ViewTime(start_ns, use_sim_time)
        self.context = Context(scene, Frames(fixed_frame), self.time, self.catch_up, self.refresh)
        self.tree = Group()  # of the displays
        self.layout = Layout()  # that was taken over last
        self.saved_views: list[ViewController] = []
        self._view: ViewController = Orbit()
        self._view.touched = self.refresh
        self._camera: Camera | None = None  # where the view put it
        self.statuses = Statuses()  # Global Status
        self.latched: Callable[[], Iterable[Sample]] = tuple  # what publishers hold for latecomers
        self.tools = all_tools()
        self.after_frame: list[Callable[[], None]] = []
        self._match_qos = match_qos
        self.types: dict[str, str] = {}  # of the topics with messages
        self._own = OwnTopics(self.context.frames, self.time, self.statuses, self._reset)

    @property
    def interests(self) -> list[Interest]:
        """Its own subscriptions, besides those of its displays."""
        return self._own.interests

    def follow_clock(self, use_sim_time: bool) -> None:
        """Set RViz's parameter `use_sim_time`: whether time is that on /clock; a change resets all."""
        if use_sim_time != self.time.use_sim_time:
            self.time.use_sim_time = use_sim_time
            self._reset("Detected time source change.")
            self.refresh()

    @property
    def displays(self) -> list[Display]:
        """The displays, in the order of RViz's tree."""
        return list(self.tree.displays())

    @property
    def fixed_frame(self) -> str:
        """RViz's Fixed Frame; another one resets all displays."""
        return self.context.frames.fixed_frame

    @fixed_frame.setter
    def fixed_frame(self, frame: str) -> None:
        if frame_name(frame) == self.fixed_frame:
            return
        self.context.frames.fixed_frame = frame
        for display in self.displays:
            display.reset()
        self.refresh()

    @property
    def options(self) -> Options:
        """RViz's Global Options, as they are now."""
        values = (self.fixed_frame, self.context.scene.background, self.time.frame_rate)
        return Options(values, self.layout.options, self._set_option)

    def _set_option(self, label: str, value: Any) -> None:
        self.context.settle()
        if label == "Fixed Frame":
            self.fixed_frame = value
        elif label == "Background Color":
            self.context.scene.background = value
        else:
            self.time.frame_rate = value

    @property
    def view(self) -> ViewController:
        """The current view controller."""
        return self._view

    @view.setter
    def view(self, view: ViewController) -> None:
        self._view = view
        view.touched = self.refresh
        self.refresh()

    def turned(self, camera: Camera) -> None:
        """Set the view from a camera that was turned by hand in a page."""
        self._view.take(camera)
        self.context.scene.remember_camera(self._view.camera(self.context.frames))
        for display in self.displays:
            display.look_from(self.context.scene.camera)

    def add(
        self,
        class_name: str,
        name: str,
        config: Mapping[str, Any],
        *,
        group: Group | None = None,
        **properties: Any,
    ) -> Display:
        """Add a display.

        Args:
            class_name: With its package.
            name: How it is called.
            config: Its part of a layout; what is wrong there is left out, and shown as a hint.
            group: Where in the tree, at its end.
            properties: By label; what is wrong there is an error.
        """
        nodes = {display.path for display in self.displays}
        names = (f"{name} {number}" if number > 1 else name for number in range(1, len(nodes) + 2))
        path = next(path for path in (f"displays/{node_name(n)}" for n in names) if path not in nodes)
        display = make_display(self.context, class_name, name, path)
        display.config = config
        wrong = display.load(config)
        for label, value in properties.items():
            display[label] = value
        (group or self.tree).members.append(display)
        self.tree.tick()
        display.start()
        display.statuses.hint("Properties", *wrong)
        self.refresh()
        return display

    def group(self, name: str) -> Group:
        """Return the first group with a name, which is made if there is none."""
        return next((g for g in self.tree.groups() if g.name == name), None) or self.add_group(name)

    def add_group(self, name: str, group: Group | None = None) -> Group:
        """Add a group of displays, in another one or at the end of the tree."""
        made = Group(name)
        (group or self.tree).members.append(made)
        self._tell()
        return made

    def apply(self, layout: Layout) -> None:
        """Apply a layout, in place of all displays."""
        for display in self.displays:
            self.remove(display)
        self.tree, self.layout = Group(), layout
        options = self.options
        options.load({option.label: option.default for option in options.properties})
        self.statuses.hint("Layout", *layout.problems, *options.load(layout.options))
        self._fill(self.tree, layout.displays)
        self.view, *wrong = view_of(layout.view)
        self.saved_views = [view_of(config)[0] for config in layout.saved_views]
        self.statuses.hint("View", *wrong)
        self.tools = all_tools()
        self.statuses.hint("Tools", *load_tools(self.tools, layout.tools))

    def _fill(self, group: Group, configs: Iterable[Mapping[str, Any]]) -> None:
        for config in configs:
            class_name = text_at(config, "Class") or "(no class name found)"  # RViz's words
            name = text_at(config, "Name") or class_name
            if class_name == GROUP:
                inner = Group(name, config, text_at(config, "Enabled").lower() != "false")
                group.members.append(inner)
                self._fill(inner, config.get("Displays") or ())
            else:
                self.add(class_name, name, config, group=group)

    def remove(self, member: Display | Group) -> None:
        """Remove a display with all it has drawn, or a group with all that is in it."""
        self.tree.holder(member).members.remove(member)
        for display in member.displays() if isinstance(member, Group) else (member,):
            display.reset()
            self.context.scene.delete(display.path)
        self._tell()

    def topics(self) -> set[str]:
        """Return the topics that displays that are switched on listen to, and those of tf."""
        shown = (display.interests for display in self.displays if display.enabled)
        return {interest.topic for interest in chain(self.interests, *shown)}

    def receive(self, sample: Sample) -> None:
        """Deliver a published message, after the frames that were due before it."""
        if self.time.has_passed(sample.stamp_ns):
            self._reset("Detected jump back in time.")
            self.time.restart()
        if (due_ns := self.time.overdue_ns(sample.stamp_ns)) is not None:
            self.update(due_ns, is_look=False)
        self.time.hear(sample.stamp_ns)
        self.types[sample.topic] = sample.type_name
        self._deliver(sample, chain(self.interests, *(display.interests for display in self.displays)))

    def tick(self, now_ns: int) -> None:
        """Update the scene if a frame is due at a robot time, [ns]; things expire without a message."""
        if self.time.is_frame_due(now_ns):
            self.update(now_ns, is_look=False)

    def refresh(self) -> None:
        """Update the scene now."""
        self.context.settle()
        self.update(self.time.robot_ns)

    def update(self, now_ns: int, *, is_look: bool = True) -> None:
        """Update the scene at a robot time, [ns]: when somebody looks, or when a frame is due."""
        self.context.draws = is_look or self.context.is_seen
        self.time.begin_frame(now_ns)
        for display in self.displays:
            if display.enabled:
                display.update()
        camera = self._view.camera(self.context.frames) if self.context.draws else None
        if camera not in (None, self._camera):  # a camera set in the scene itself stays
            self._camera = self.context.scene.camera = camera
        self._tell()

    def rows(self) -> list[StatusRow]:
        """List all statuses as RViz's tree does, with our hints."""
        return [*self.global_rows(), *(row for display in self.displays for row in self.rows_of(display))]

    def global_rows(self) -> list[StatusRow]:
        """List RViz's Global Status, with our hints."""
        level, text = self.context.frames.global_status()
        self.statuses.set(level, "Fixed Frame", text)
        self.statuses.hint("Target Frame", *self.view.lost(self.context.frames))
        return self.statuses.rows("Global Status")

    def rows_of(self, display: Display) -> list[StatusRow]:
        """List a display's statuses, with our hints."""
        return [*display.rows(), *silence(display, self.types)]

    def summary(self) -> str:
        """Describe in words the objects drawn, their places in the fixed frame, and the statuses."""
        names = [f"{display.name}{'' if display.enabled else ' (off)'}" for display in self.displays]
        head = f"Fixed frame {self.fixed_frame}. Displays: {', '.join(names) or 'none'}. Positions in metres."
        return "\n".join([head, *summary(self.context.scene), str(StatusTable(self.rows()))])

    def catch_up(self, interests: Iterable[Interest]) -> None:
        """Deliver the messages held for latecomers to interests that request them; add a hint to others."""
        held = list(self.latched())
        wanting = [s for s in interests if s.qos.durability == "transient_local"]
        for sample in held:
            self._deliver(sample, wanting)
        for missing in (s for s in interests if s not in wanting):
            if any(sample.topic == missing.topic for sample in held):
                hint_at_held(missing)

    def _tell(self) -> None:
        for listener in tuple(self.after_frame):
            listener()

    def _deliver(self, sample: Sample, interests: Iterable[Interest]) -> None:
        """Deserialise a message once, for all that want it and can have it."""
        here = (interest for interest in interests if interest.topic == sample.topic)
        reached = [interest for interest in here if reaches(sample, interest, self._match_qos)]
        if not reached:
            return
        message = sample.message()
        for interest in reached:
            interest.take(message)
        self.time.request_frame()

    def _reset(self, why: str) -> None:
        """Restart when time jumps, as RViz does."""
        self.context.frames.buffer.clear()
        for display in self.displays:
            display.reset()
        self.statuses.hint("Time", f"RViz's log: {why} Resetting RViz.")
