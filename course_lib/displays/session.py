"""RViz without a window: displays, and the order in which messages and time change the scene.

RViz receives messages in one thread, and draws frames in another. Here everything runs inside
`publish()` or inside a call that requests the scene, and yet the result must not depend on how many
pages watch. So a session separates the two in robot time: a received message is only queued by its
display, and the scene changes in `update`, the next frame, which is due 1/30 s of robot time after
the first queued message. A message that arrives later than that first runs the frames that were due
before it.
"""

from collections import deque
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import Any

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.display import (
    GROUP,
    Context,
    Display,
    Group,
    Subscription,
    is_deliverable,
    node_name,
)
from course_lib.displays.frames import Frames, ViewTime, frame_name, nanoseconds
from course_lib.displays.layout import Layout, Options, text_at
from course_lib.displays.panel.tools import advertise_tools, all_tools, load_tools
from course_lib.displays.registry import make_display
from course_lib.displays.statuses import Statuses, StatusRow, StatusTable, exceptions_as_status
from course_lib.displays.tf import ReferenceDisplay
from course_lib.displays.views import Framing, Orbit, ViewController, view_of
from course_lib.ros.graph.graph import Graph, Sample
from course_lib.ros.graph.topics import CLOCK, CLOCK_QOS, Qos
from course_lib.viewer.drawables import Camera
from course_lib.viewer.scene import Scene, summary

TF = "tf2_msgs/msg/TFMessage"
_NOT_SPUN = (
    "the node {} was created but is not spun, so its callbacks never run: pass it to "
    "run_live(...), spin_for(2.0, ...) or rclpy.spin(...)."
)
CLOCK_WAS_SET_BACK = (
    "If a robot or a bag started again with an earlier time, the newer transforms of before hide "
    "its own: viewer.reset(), or open the view again."
)
_TF_TOPICS = {"/tf": Qos(depth=100), "/tf_static": Qos(depth=100, durability="transient_local")}


@dataclass
class _AttachedNode:
    """A scene node that follows a frame ("" is the fixed frame), and the state drawn last."""

    frame: str
    transform_node_to_frame: Matrix
    transform_node_to_fixed: Matrix = field(default_factory=lambda: np.full((4, 4), np.nan))
    is_visible: bool | None = None


class RvizSession:
    """RViz's displays without a window. It receives messages and updates a scene frame by frame.

    Args:
        scene: Displays draw into it.
        fixed_frame: RViz's Fixed Frame.
        start_ns: Robot time, [ns].
        match_qos: Whether QoS policies of publishers must match, as live; a recording has all
            messages.
        use_sim_time: RViz's parameter of that name.
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
        self.context = Context(scene, Frames(fixed_frame), self.time, self.deliver_latched, self.refresh)
        self.tree = Group()
        # The layout that was applied last.
        self.layout = Layout()
        self.saved_views: list[ViewController] = []
        self._view: ViewController = Orbit()
        self._view.on_change = self._on_view_set
        # None after the user has set the view.
        self._framing: Framing | None = Framing(scene)
        # Whether the session shows a recording frame by frame.
        self.is_replay = False
        # The camera that the view set last.
        self._camera: Camera | None = None
        # RViz's Global Status.
        self.statuses = Statuses()
        # Returns the names of nodes that have timers or messages, but are not spun by any program.
        self.unspun_nodes: Callable[[], Iterable[str]] = tuple
        # Returns the errors that stopped live nodes.
        self.node_errors: Callable[[], Iterable[str]] = tuple
        # Returns why nothing arrives from a linked robot, or "".
        self.link_error: Callable[[], str] = str
        # Returns the types of a topic's publishers.
        self.published_types: Callable[[str], Collection[str]] = lambda topic: ()
        # Returns the messages that publishers keep.
        self.latched_samples: Callable[[], Iterable[Sample]] = tuple
        self.tools = all_tools()
        self.after_frame: list[Callable[[], None]] = []
        # Nodes of the scene that follow a frame, by their paths.
        self._attached: dict[str, _AttachedNode] = {}
        self._match_qos = match_qos
        # Message types by the topics on which messages were received.
        self.types: dict[str, str] = {}
        self._tf_subscriptions = [
            Subscription(topic, TF, qos, partial(self._on_tf, topic == "/tf_static"), self.statuses)
            for topic, qos in _TF_TOPICS.items()
        ]
        self._clock_subscription = Subscription(*CLOCK, CLOCK_QOS, self._on_clock, self.statuses)

    @property
    def subscriptions(self) -> list[Subscription]:
        """The session's own subscriptions: tf and, with `use_sim_time`, the clock."""
        return [*self._tf_subscriptions, *([self._clock_subscription] if self.time.use_sim_time else [])]

    def set_sim_time(self, use_sim_time: bool) -> None:
        """Set RViz's parameter `use_sim_time`: whether /clock is the time source.

        A change resets all displays.
        """
        if use_sim_time != self.time.use_sim_time:
            self.time.use_sim_time = use_sim_time
            self._on_time_jump("Detected time source change.")
            self.refresh()

    @property
    def displays(self) -> list[Display]:
        """The displays, in the order of RViz's tree."""
        return list(self.tree.displays())

    @property
    def fixed_frame(self) -> str:
        """RViz's Fixed Frame; setting another one resets all displays."""
        return self.context.frames.fixed_frame

    @fixed_frame.setter
    def fixed_frame(self, frame: str) -> None:
        if frame_name(frame) == self.fixed_frame:
            return
        self.context.frames.fixed_frame = frame
        if self._framing is not None:
            self._framing = Framing(self.context.scene)
        for display in self.displays:
            display.run_safely(display.reset)
        self.refresh()

    @property
    def options(self) -> Options:
        """RViz's Global Options."""

        def set_option(label: str, value: Any) -> None:
            self.context.process_backlog()
            if label == "Fixed Frame":
                self.fixed_frame = value
            elif label == "Background Color":
                self.context.scene.background = value
            elif label == "Look":
                self.context.scene.look = value
            else:
                self.time.frame_rate = value
            # Open panels show the new value, even while no node runs.
            self.refresh()

        scene = self.context.scene
        values = (self.fixed_frame, scene.background, self.time.frame_rate, scene.look)
        return Options(values, self.layout.options, set_option)

    @property
    def view(self) -> ViewController:
        """The current view controller."""
        return self._view

    @view.setter
    def view(self, view: ViewController) -> None:
        self._view = view
        view.on_change = self._on_view_set
        self._on_view_set()

    def _on_view_set(self) -> None:
        self._framing = None
        self.refresh()

    def on_view_turn(self, camera: Camera) -> None:
        """Set the view from a camera that the user turned in a page."""
        self._framing = None
        self._view.set_from_camera(camera)
        self.context.scene.remember_camera(self._view.camera(self.context.frames))
        self._announce_camera()

    def _announce_camera(self) -> None:
        for display in self.displays:
            with exceptions_as_status(display.statuses, "View"):
                display.on_view_turn(self.context.scene.camera)

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
            class_name: RViz's class name, with its package.
            name: The display's name.
            config: Its part of a layout; invalid values are skipped and reported as a hint.
            group: The group to append it to; the root if None.
            properties: Values by label; an invalid value is an error.
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
        self.tree.update_visibility()
        display.run_safely(display.start)
        display.statuses.hint("Properties", *wrong)
        self.refresh()
        return display

    def group(self, name: str) -> Group:
        """Return the first group with a name; it is created if there is none."""
        return next((g for g in self.tree.groups() if g.name == name), None) or self.add_group(name)

    def add_group(self, name: str, group: Group | None = None) -> Group:
        """Add a group of displays to another one, or to the root of the tree."""
        new_group = Group(name)
        (group or self.tree).members.append(new_group)
        self._notify()
        return new_group

    def apply(self, layout: Layout) -> None:
        """Apply a layout, replacing all displays."""
        for display in self.displays:
            self.remove(display)
        self.tree, self.layout = Group(), layout
        options = self.options
        options.load({option.label: option.default for option in options.properties})
        self.statuses.hint("Layout", *layout.problems, *options.load(layout.options))
        self._add_members(self.tree, layout.displays)
        framing = None if layout.view else Framing(self.context.scene)
        self.view, *wrong = view_of(layout.view)
        self._framing = framing
        self.saved_views = [view_of(config)[0] for config in layout.saved_views]
        self.statuses.hint("View", *wrong)
        self.tools = all_tools()
        self.statuses.hint("Tools", *load_tools(self.tools, layout.tools))
        if self.context.node is not None:
            advertise_tools(self.context.node, self.tools, layout.tools)

    def _add_members(self, group: Group, configs: Iterable[Mapping[str, Any]]) -> None:
        for config in configs:
            # RViz's text.
            class_name = text_at(config, "Class") or "(no class name found)"
            name = text_at(config, "Name") or class_name
            if class_name == GROUP:
                inner = Group(name, config, text_at(config, "Enabled").lower() != "false")
                group.members.append(inner)
                self._add_members(inner, config.get("Displays") or ())
            else:
                self.add(class_name, name, config, group=group)

    def remove(self, member: Display | Group) -> None:
        """Remove a display with its drawing, or a group with all its displays."""
        self.tree.find_group_of(member).members.remove(member)
        for display in member.displays() if isinstance(member, Group) else (member,):
            display.run_safely(display.reset)
            self.context.scene.delete(display.path)
        self._notify()

    def topics(self) -> set[str]:
        """Return the topics to which the session and its enabled displays are subscribed."""
        enabled = (display.subscriptions for display in self.displays if display.enabled)
        return {subscription.topic for subscription in chain(self.subscriptions, *enabled)}

    def receive(self, sample: Sample) -> None:
        """Deliver a published message, after the frames that were due before it.

        An exception becomes a status: it must not reach the node that publishes.
        """
        with exceptions_as_status(self.statuses, "Message"):
            # A message is older than the last one after a recording was rewound.
            if sample.stamp_ns < self.time.message_ns:
                self._on_time_jump("Detected jump back in time.")
                self.time.restart()
            if (due_ns := self.time.overdue_ns(sample.stamp_ns)) is not None:
                self.update(due_ns, is_look=False)
            self.time.on_message(sample.stamp_ns)
            self.types[sample.topic] = sample.type_name
            self._deliver(
                sample, chain(self.subscriptions, *(display.subscriptions for display in self.displays))
            )

    def tick(self, now_ns: int) -> None:
        """Update the scene if a frame is due at a robot time, [ns].

        Objects expire even without a message.
        """
        if self.time.is_frame_due(now_ns):
            self.update(now_ns, is_look=False)

    def refresh(self) -> None:
        """Update the scene now."""
        self.context.process_backlog()
        self.update(self.time.robot_ns)

    def update(self, now_ns: int, *, is_look: bool = True, is_opened: bool = False) -> None:
        """Update the scene at a robot time [ns], because an update was requested or a frame is due.

        Args:
            now_ns: The robot time.
            is_look: Whether it was requested.
            is_opened: Whether a cell or a picture is about to show the scene.
        """
        self.context.is_drawn = is_look or self.context.is_seen
        self.time.begin_frame(now_ns)
        for display in self.displays:
            if display.enabled:
                with exceptions_as_status(display.statuses, "Update"):
                    display.update()
        if self.context.is_drawn:
            self._place_attached_nodes()
        with exceptions_as_status(self.statuses, "View"):
            camera = self._view.camera(self.context.frames) if self.context.is_drawn else None
            is_framed = camera is not None and self._frame_drawings(camera, is_opened)
            if is_framed:
                camera = self._view.camera(self.context.frames)
            # An unchanged camera is not set again, because another one may have been set in the
            # scene itself.
            if camera not in (None, self._camera):
                self._camera = self.context.scene.camera = camera
            if is_framed:
                self._announce_camera()
        self._notify()

    def attach(self, path: str, frame: str, at: Sequence[float]) -> None:
        """Let a node of the scene follow a frame.

        Args:
            path: The node.
            frame: The frame; "" is the fixed frame.
            at: The position of the node in the frame, [m].
        """
        transform_node_to_frame = np.eye(4)
        transform_node_to_frame[:3, 3] = at
        self._attached[path] = _AttachedNode(frame, transform_node_to_frame)
        self.refresh()

    def _place_attached_nodes(self) -> None:
        """Move the attached nodes whose frames have moved.

        Others are left alone, because each change is drawn again.
        """
        for path, node in self._attached.items():
            transform_frame_to_fixed = self.context.frames.transform(node.frame or self.fixed_frame)
            is_known = transform_frame_to_fixed is not None
            if is_known is not node.is_visible:
                self.context.scene.set_visible(path, is_known)
                node.is_visible = is_known
            if transform_frame_to_fixed is not None:
                transform_node_to_fixed = transform_frame_to_fixed @ node.transform_node_to_frame
                if not np.array_equal(transform_node_to_fixed, node.transform_node_to_fixed):
                    self.context.scene.set_transform(path, transform_node_to_fixed)
                    node.transform_node_to_fixed = transform_node_to_fixed

    def _frame_drawings(self, camera: Camera, is_opened: bool) -> bool:
        """Move a default view to the drawn objects. Return whether it has changed."""
        is_replaced = self._camera is not None and self.context.scene.camera is not self._camera
        # The view does not depend on invisible frames, because these may be postponed.
        is_watched = is_opened or self.is_replay or bool(self.after_frame)
        if self._framing is None or not isinstance(self._view, Orbit) or is_replaced or not is_watched:
            return False
        references = {display.path for display in self.displays if isinstance(display, ReferenceDisplay)}
        return self._framing.choose(self._view, camera, references, is_opened=is_opened)

    def default_camera(self) -> Camera | None:
        """Return the camera of a view that neither a program nor the user has set, else None."""
        return self._camera if self._framing is not None and isinstance(self._view, Orbit) else None

    def show_all(self, scenes: Iterable[Scene]) -> None:
        """Move a default view so that it shows all objects in several scenes."""
        camera = self.default_camera()
        if self._framing is None or not isinstance(self._view, Orbit) or camera is None:
            return
        if self.context.scene.camera is camera and self._framing.include(self._view, camera, scenes):
            self._camera = self.context.scene.camera = self._view.camera(self.context.frames)
            self._announce_camera()

    def rows(self) -> list[StatusRow]:
        """Return all statuses as in RViz's tree, with hints."""
        return [*self.global_rows(), *(row for display in self.displays for row in self.rows_of(display))]

    def global_rows(self) -> list[StatusRow]:
        """Return RViz's Global Status, with hints."""
        self.statuses.delete("Robot")
        if error := self.link_error():
            self.statuses.set("error", "Robot", error)
        level, text = self.context.frames.global_status()
        self.statuses.set(level, "Fixed Frame", text)
        self.statuses.hint("Target Frame", *self.view.target_frame_hints(self.context.frames))
        self.statuses.delete("Nodes")
        # The nodes of one run have the same error.
        if errors := "; ".join(dict.fromkeys(self.node_errors())):
            self.statuses.set("error", "Nodes", errors)
        self.statuses.hint("Nodes", *(_NOT_SPUN.format(name) for name in self.unspun_nodes()))
        return self.statuses.rows("Global Status")

    def rows_of(self, display: Display) -> list[StatusRow]:
        """Return a display's statuses, with hints.

        A display without messages gets the names of other topics with messages of its type, unless
        its own topic has a publisher: the first message of a slow node takes a while.
        """
        with exceptions_as_status(display.statuses, "Statuses"):
            rows = list(display.rows())
            topics = {subscription.topic for subscription in display.subscriptions}
            types = {subscription.type_name for subscription in display.subscriptions}
            other_topics = sorted(topic for topic, type_name in self.types.items() if type_name in types)
            is_silent = bool(topics) and not topics & self.types.keys()
            if (
                is_silent
                and other_topics
                and not any(types & set(self.published_types(topic)) for topic in topics)
            ):
                others_text = ", ".join(other_topics)
                text = (
                    f"no message has arrived on {min(topics)}; messages of its type arrive on {others_text}."
                )
                rows.append(StatusRow(display.name, "Topic", "hint", text))
            return rows
        return display.statuses.rows(display.name)

    def summary(self) -> str:
        """Describe in words the drawn objects, their positions in the fixed frame, and the statuses."""
        names = [f"{display.name}{'' if display.enabled else ' (off)'}" for display in self.displays]
        head = f"Fixed frame {self.fixed_frame}. Displays: {', '.join(names) or 'none'}. Positions in metres."
        return "\n".join([head, *summary(self.context.scene), str(StatusTable(self.rows()))])

    def deliver_latched(self, subscriptions: Iterable[Subscription]) -> None:
        """Deliver latched messages to transient-local subscriptions, and add a hint for others."""
        samples = list(self.latched_samples())
        late_joining = [s for s in subscriptions if s.qos.is_latched]
        for sample in samples:
            self._deliver(sample, late_joining)
        for missing in (s for s in subscriptions if s not in late_joining):
            if any(sample.topic == missing.topic for sample in samples):
                text = (
                    f"{missing.topic} was published before this display existed, and its publisher "
                    "keeps messages for late-joining subscriptions; set Durability Policy to "
                    "Transient Local."
                )
                missing.statuses.hint(f"Topic {missing.topic}", text)

    def _notify(self) -> None:
        for listener in tuple(self.after_frame):
            with exceptions_as_status(self.statuses, "Page"):
                listener()

    def _deliver(self, sample: Sample, subscriptions: Iterable[Subscription]) -> None:
        """Deserialize a message once, for all subscriptions that match it."""
        on_topic = (s for s in subscriptions if s.topic == sample.topic)
        matching = [s for s in on_topic if is_deliverable(sample, s, self._match_qos)]
        if not matching:
            return
        message = None
        for subscription in matching:
            with exceptions_as_status(subscription.statuses, "Message"):
                message = sample.message() if message is None else message
                subscription.callback(message)
        self.time.request_frame()

    def _on_tf(self, is_static: bool, message: Any) -> None:
        complaints = self.context.frames.add_transforms(message.transforms, is_static)
        if complaints:
            is_old = any(complaint.startswith("TF_OLD_DATA") for complaint in complaints)
            self.statuses.hint("TF", *complaints, *[CLOCK_WAS_SET_BACK] * is_old)

    def _on_clock(self, message: Any) -> None:
        if self.time.on_clock(nanoseconds(message.clock)):
            self._on_time_jump("Detected jump back in time.")

    def reset(self) -> None:
        """Discard all transforms, and the messages of all displays."""
        self.context.frames.clear()
        self.statuses.hint("TF")
        for display in self.displays:
            display.run_safely(display.reset)
        self.time.request_frame()

    def _on_time_jump(self, reason: str) -> None:
        """Reset all displays because time has jumped, as RViz does."""
        self.reset()
        self.statuses.hint("Time", f"RViz's log: {reason} Resetting RViz.")


# The maximum number of waiting samples and times.
MAX_WAITING = 20_000
# The maximum size of the waiting samples.
MAX_BYTES = 16 << 20


class Backlog:
    """Passes samples and robot time to a session, or delays them while no page can show the scene.

    Most viewers of a graded notebook are never displayed, so converting their messages would be
    wasted. `Context.process_backlog` replays the waiting samples and times in order, each at its
    own robot time. The session's state is then the same as if they had not waited.

    Args:
        session: Receives the samples and times.
        graph: Publishes them.
    """

    def __init__(self, session: RvizSession, graph: Graph) -> None:
        self._session, self._graph = session, graph
        # Samples, and robot times [ns] that were reached.
        self._waiting: deque[Sample | int] = deque()
        self._bytes = 0
        # Subscribed topics; None while nothing may wait.
        self._topics: set[str] | None = None
        # Whether `_topics` is up to date.
        self._is_current = False
        # Robot time of the sample or time that is being replayed.
        self._replayed_ns: int | None = None
        session.context.process_backlog = self.process

    @property
    def now_ns(self) -> int:
        """The robot time of the sample or time that is being processed, [ns]."""
        return self._graph.now_ns if self._replayed_ns is None else self._replayed_ns

    def receive(self, sample: Sample) -> None:
        """Process a published message, or queue it."""
        topics = self._waiting_topics()
        if topics is None:
            self._session.receive(sample)
            return
        # The session reads only time and type of messages on other topics.
        if sample.topic not in topics:
            sample = replace(sample, cdr=b"")
        self._bytes += len(sample.cdr)
        self._wait(sample)

    def tick(self, now_ns: int) -> None:
        """Process a new robot time [ns], or queue it."""
        if self._waiting_topics() is None:
            self._session.tick(now_ns)
        else:
            self._wait(now_ns)

    def process(self) -> None:
        """Process all waiting samples and times."""
        if self._replayed_ns is not None:
            return
        self._is_current = False
        try:
            while self._waiting:
                item = self._waiting.popleft()
                if isinstance(item, Sample):
                    self._replayed_ns = item.stamp_ns
                    self._session.receive(item)
                else:
                    self._replayed_ns = item
                    self._session.tick(item)
        finally:
            self._replayed_ns = None
            self._session.context.has_backlog = bool(self._waiting)
        self._bytes = 0

    def _wait(self, item: Sample | int) -> None:
        self._waiting.append(item)
        self._session.context.has_backlog = True
        if len(self._waiting) > MAX_WAITING or self._bytes > MAX_BYTES:
            self.process()

    def _waiting_topics(self) -> set[str] | None:
        """Return the topics whose messages are queued, or None if nothing may be queued."""
        if not self._is_current:
            session = self._session
            is_unseen = not (session.context.is_seen or session.after_frame)
            may_wait = is_unseen and not any(display.has_side_effects for display in session.displays)
            self._topics = session.topics() if may_wait else None
            self._is_current = True
        return self._topics
