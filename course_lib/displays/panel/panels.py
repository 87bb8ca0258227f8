"""RViz's panels around a view: the rows that a page receives, its commands, and the Time panel."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from math import isfinite
from pathlib import Path
from typing import Any

import msgspec
from msgspec.structs import replace

from course_lib.displays.display import GROUP, Display, Group
from course_lib.displays.frames import NS, ViewTime
from course_lib.displays.interactive import InteractiveMarkersDisplay
from course_lib.displays.layout import read_layout, yaml_text
from course_lib.displays.panel import protocol
from course_lib.displays.panel.tools import publish, settings_of
from course_lib.displays.properties import (
    Convert,
    LimitedConversion,
    Property,
    PropertyHolder,
    booleans,
    color,
    flag,
    frame,
    read_only,
    vector,
)
from course_lib.displays.registry import REGISTRY, describe_class, short_name
from course_lib.displays.session import RvizSession
from course_lib.displays.statuses import (
    LEVELS,
    NOTES,
    Level,
    StatusRow,
    describe,
    exceptions_as_status,
    shorten_middle,
)
from course_lib.displays.views import VIEWS, ViewController, view_of
from course_lib.displays.writer import member_config, save_rviz, view_config
from course_lib.errors import CourseError, format_count
from course_lib.recording import Recording
from course_lib.ros.graph.graph import Graph
from course_lib.ros.messages.cdr import to_plain
from course_lib.ros.time import pace, wall
from course_lib.viewer.drawables import Camera
from course_lib.viewer.encoding import Message, MessageError, from_json, to_json
from course_lib.viewer.page_link import PageLink, running_loop

_EDITORS: tuple[tuple[Convert, protocol.EditorKind], ...] = (
    (flag, "bool"),
    (color, "color"),
    (vector, "vector"),
    (frame, "frame"),
    (read_only, "none"),
    (booleans, "none"),
)
Edit = Callable[[Any], Any]
_WORST_FIRST: tuple[Level, ...] = ("error", "warn", "hint", "ok")


@dataclass(frozen=True)
class RowEntry:
    """A row that the page draws, and the effect of editing it."""

    row: protocol.PanelRow
    edit: Edit | None = None
    # The tree's member, which can be renamed, removed, ...
    member: Display | Group | None = None


class Rows(dict[str, RowEntry]):
    """Rows by their key, parents first."""

    def put(
        self,
        key: str,
        parent: str,
        label: str,
        edit: Edit | None = None,
        member: Any = None,
        **shown: Any,
    ) -> None:
        """Add a row."""
        self[key] = RowEntry(protocol.PanelRow(key, parent, shorten_middle(label), **shown), edit, member)

    def put_properties(self, holder: PropertyHolder, parent: str, others: Iterable[str] = ()) -> None:
        """Add the properties of an object that RViz displays, without its check box.

        Args:
            holder: The object.
            parent: The key of its row.
            others: The names of the other displays, which a Camera lists below Visibility.
        """
        for path, prop in holder.panel_rows():
            if prop.label == "Enabled":
                continue
            above = parent
            for depth, name in enumerate(path[:-1], 1):
                key = f"{above}#{name}"
                if key not in self:
                    row = path[:depth]
                    self.put(key, above, holder.row_name(row), open=holder.is_expanded(row))
                above = key
            self._put_property(holder, prop, path, above, others)

    def put_statuses(self, key: str, parent: str, label: str, rows: list[StatusRow]) -> None:
        """Add statuses below a row that shows the worst level."""
        worst = worst_of(row.level for row in rows)
        self.put(key, parent, f"{label}: {LEVELS[worst][1].capitalize()}", mark=mark_of(worst))
        for index, row in enumerate(rows):
            mark, title = mark_of(row.level), NOTES.get(row.name, "")
            self.put(f"{key}!{index}", key, row.name, text=row.text, mark=mark, title=title)

    def _put_property(
        self,
        holder: PropertyHolder,
        prop: Property,
        path: tuple[str, ...],
        parent: str,
        others: Iterable[str],
    ) -> None:
        key, value = f"{parent}#{prop.path[-1]}", holder[prop.label]
        editor = _editor(prop, holder)
        is_map = isinstance(value, dict)
        shown_value = value
        if is_map:
            shown_value = ""
        elif editor.kind == "none":
            shown_value = f"{value:.6g}" if isinstance(value, float) else str(value)
        shown = {"value": shown_value, "title": holder.describe(prop)}
        is_open = holder.is_expanded(path)
        self.put(
            key,
            parent,
            prop.path[-1],
            partial(holder.__setitem__, prop.label),
            editor=editor,
            open=is_open,
            **shown,
        )
        if prop.convert is booleans:
            # Without an entry a display is enabled. The order does not depend on the entries.
            enabled = dict.fromkeys(others, True) if prop.label == "Visibility" else {}
            for name, on in (enabled | value).items():
                tick = partial(self.check, holder, prop.label, name)
                title, editor = name or "(no name)", protocol.Editor("bool")
                self.put(f"{key}#{name}", key, title, tick, editor=editor, value=on)
        elif is_map:
            # A tree of unique names, which can be deeper than Python's recursion limit.
            waiting = [(key, *item) for item in reversed(value.items())]
            while waiting:
                above, name, below = waiting.pop()
                row = f"{key}#{name}"
                self.put(row, above, name)
                waiting += [(row, *item) for item in reversed(below.items())]

    @staticmethod
    def check(holder: PropertyHolder, label: str, name: str, is_enabled: Any) -> None:
        """Set one entry of a map of check boxes."""
        holder[label] = {**holder[label], name: is_enabled}


def display_rows(session: RvizSession) -> Rows:
    """Return the rows of the Displays panel."""
    rows = Rows()
    rows.put("options", "", "Global Options", open=True)
    rows.put_properties(session.options, "options")
    rows.put_statuses("status", "", "Global Status", session.global_rows())
    for member, parent in _members(session.tree, ""):
        _put_member(rows, session, member, parent)
    return rows


def view_rows(session: RvizSession) -> Rows:
    """Return the rows of the Views panel."""
    rows = Rows()
    rows.put_properties(session.view, "view")
    return rows


def worst_of(levels: Iterable[Level]) -> Level:
    """Return the most severe level; hints rank after RViz's warnings."""
    return min(levels, key=_WORST_FIRST.index, default="ok")


def _members(group: Group, parent: str) -> Iterator[tuple[Display | Group, str]]:
    for member in group.members:
        yield member, parent
        if isinstance(member, Group):
            yield from _members(member, _key(member))


def _put_member(rows: Rows, session: RvizSession, member: Display | Group, parent: str) -> None:
    key = _key(member)
    if isinstance(member, Group):

        def tick(on: Any) -> None:
            member.is_enabled = flag(on)
            session.tree.update_visibility()
            session.refresh()

        rows.put(key, parent, member.name, tick, member, checked=member.is_enabled)
        return

    enable = partial(member.__setitem__, "Enabled")
    statuses = session.rows_of(member)
    level = worst_of(row.level for row in statuses)
    shown = {"title": member.class_name, "checked": bool(member["Enabled"])}
    rows.put(key, parent, member.name, enable, member, mark=mark_of(level) if statuses else None, **shown)
    if statuses:
        rows.put_statuses(f"{key}!", key, "Status", statuses)
    rows.put_properties(member, key, [other.name for other in session.displays if other is not member])


def _key(member: Display | Group) -> str:
    return f"group {id(member)}" if isinstance(member, Group) else member.path


def mark_of(level: Level) -> protocol.LevelMark:
    """Return the icon and the word for a level."""
    icon, word, _ = LEVELS[level]
    return protocol.LevelMark(level, icon, word)


def _editor(prop: Property, holder: PropertyHolder) -> protocol.Editor:
    """Return the control that edits a property, with its limits."""
    if isinstance(prop.convert, LimitedConversion):
        low, high = (limit if isfinite(limit) else None for limit in (prop.convert.low, prop.convert.high))
        return protocol.Editor(prop.convert.editor, low, high, tuple(prop.convert.options))
    # The attribute is read from the class, because an instance without it would search for similar
    # names, which is slow.
    type_name = getattr(type(holder), "type_name", None)
    if prop.path[-1].endswith("Topic") and type_name:
        return protocol.Editor("topic", type=type_name)
    kinds = (kind for convert, kind in _EDITORS if convert is prop.convert)
    return protocol.Editor(next(kinds, "text"))


# Maximum length of a list or string of a selected message that is shown completely.
_LONGEST = 16
# Folders with layouts: the notebook's folder, and the folder for files of lessons.
_FOLDERS = ("", "my_files")
# The commands of a page by subject.
_TREE_COMMANDS = (
    protocol.SetValue,
    protocol.AddDisplay,
    protocol.DuplicateDisplay,
    protocol.RenameRow,
    protocol.RemoveRow,
    protocol.SaveLayout,
    protocol.LoadLayout,
)
_VIEW_COMMANDS = (
    protocol.ChangeView,
    protocol.HomeView,
    protocol.SaveView,
    protocol.UseView,
    protocol.RenameView,
    protocol.RemoveView,
    protocol.TurnView,
)
_SCENE_COMMANDS = (
    protocol.SelectObject,
    protocol.PublishGesture,
    protocol.UseControl,
    protocol.ChooseEntry,
)


class CommandHandler:
    """Executes the commands of a page.

    `rows` are the page's rows, `notice` is the response to the last command.

    Args:
        session: The session to change; tools publish through its node.
    """

    def __init__(self, session: RvizSession) -> None:
        self.rows: Mapping[str, RowEntry] = {}
        self.notice = protocol.Notice()
        self.selection = ""
        self.menu = protocol.ContextMenu()
        self.file = "view.rviz"
        self._session = session
        self._acts: dict[type[protocol.Command], Callable[[Any], None]] = {
            protocol.RequestUpdate: lambda command: None,
            **dict.fromkeys(_TREE_COMMANDS, self._edit_tree),
            **dict.fromkeys(_VIEW_COMMANDS, self._set_view),
            **dict.fromkeys(_SCENE_COMMANDS, self._act_in_scene),
        }

    def execute(self, command: protocol.Command) -> None:
        """Execute a command.

        Raises:
            CourseError: The command is impossible; the message is for the page.
        """
        self._acts[type(command)](command)

    def _entry(self, row: str) -> RowEntry:
        if row not in self.rows:
            raise CourseError(f"{row!r} no longer exists.")
        return self.rows[row]

    def _member(self, row: str) -> Display | Group:
        member = self._entry(row).member
        if member is None:
            raise CourseError("Select a display in the tree first.")
        return member

    def _edit_tree(self, command: protocol.Command) -> None:
        """Edit a row, or add, copy, rename or remove a display; save or open a layout."""
        session = self._session
        match command:
            case protocol.SetValue(row=row, value=value):
                edit = self._entry(row).edit
                if edit is None:
                    raise CourseError(f"{row!r} cannot be edited.")
                edit(value)
            case protocol.AddDisplay(display=class_name, topic=topic, row=row):
                row_entry = self.rows.get(row)
                group = row_entry.member if row_entry and isinstance(row_entry.member, Group) else None
                if class_name == GROUP:
                    session.add_group("Group", group)
                elif class_name not in REGISTRY:
                    raise CourseError(f"There is no display {class_name!r}.")
                else:
                    label = getattr(REGISTRY[class_name], "topic_label", "Topic")
                    config = {label: {"Value": topic}} if topic else {}
                    session.add(class_name, short_name(class_name), config, group=group)
            case protocol.DuplicateDisplay(row=row):
                member = self._member(row)
                if isinstance(member, Group):
                    raise CourseError("A group cannot be duplicated; duplicate its displays.")
                config = member_config(member)
                holder = session.tree.find_group_of(member)
                session.add(str(config["Class"]), member.name, config, group=holder)
            case protocol.RenameRow(row=row, name=name):
                member = self._member(row)
                member.name = name.strip() or member.name
            case protocol.RemoveRow(row=row):
                session.remove(self._member(row))
            case protocol.SaveLayout(name=name):
                save_rviz(session, self._path(name))
                self.notice = protocol.Notice("ok", f"Saved {self.file}.")
            case protocol.LoadLayout(name=name):
                session.apply(read_layout(self._path(name)))
                self.notice = protocol.Notice("ok", f"Opened {self.file}.")

    def _path(self, text: str) -> Path:
        """Return the path of a layout in one of the folders of layouts."""
        name = text.strip()
        folder, _, last = name.rpartition("/")
        if not last or last != Path(last).name or folder not in _FOLDERS:
            raise CourseError(f"{text!r} is not a file name; use one like view.rviz.")
        self.file = name if name.endswith(".rviz") else f"{name}.rviz"
        return Path.cwd() / self.file

    def _saved_view(self, index: int) -> ViewController:
        if not 0 <= index < len(self._session.saved_views):
            raise CourseError("This saved view no longer exists. Select another one.")
        return self._session.saved_views[index]

    def _set_view(self, command: protocol.Command) -> None:
        """Change the current view or the saved ones."""
        session = self._session
        match command:
            case protocol.ChangeView(view=name):
                if name not in VIEWS:
                    raise CourseError(f"There is no view {name!r}; the views are {', '.join(VIEWS)}.")
                view = VIEWS[name]()
                view.mimic(session.view, session.context.frames)
                session.view = view
            case protocol.HomeView():
                session.view.return_home()
            case protocol.SaveView(name=name):
                view = view_of(view_config(session.view))[0]
                view.name = name.strip() or str(view)
                session.saved_views.append(view)
            case protocol.UseView(index=index):
                config = view_config(self._saved_view(index))
                session.view = view_of({**config, "Name": "Current View"})[0]
            case protocol.RenameView(index=index, name=name):
                view = self._saved_view(index)
                view.name = name.strip() or view.name
            case protocol.RemoveView(index=index):
                session.saved_views.remove(self._saved_view(index))
            case protocol.TurnView(eye=eye, target=target, up=up, scale=scale):
                session.on_view_turn(Camera(eye, target, up, orthographic_scale=scale or None))

    def _act_in_scene(self, command: protocol.Command) -> None:
        """Describe the clicked object, publish with a tool, or use an interactive marker."""
        session = self._session
        match command:
            case protocol.SelectObject(path=path, index=index):
                self.selection = describe_selection(session, path, index)
            case protocol.PublishGesture():
                node = session.context.node
                if node is None:
                    raise CourseError("This page shows a recording, in which nothing can be published.")
                confirmation = publish(node, session.tools, session.fixed_frame, command)
                self.notice = protocol.Notice("ok", confirmation)
            case protocol.UseControl(path=path, event=event):
                for display in handles(session):
                    entries = display.use(command)
                    if event != "move":
                        tool = next(tool for tool in session.tools if tool.gesture == "interact")
                        hides_others = event == "down" and tool["Hide Inactive Objects"]
                        display.show_only(path if hides_others else None)
                    if entries:
                        self.menu = protocol.ContextMenu(self.menu.number + 1, path, entries)
            case protocol.ChooseEntry(path=path, entry=entry):
                for display in handles(session):
                    if display.message_at(path) is not None:
                        self.notice = protocol.Notice("ok", display.choose(path, entry))


def handles(session: RvizSession) -> list[InteractiveMarkersDisplay]:
    """Return the displays with draggable markers; a recording has none."""
    live = session.displays if session.context.node is not None else ()
    return [display for display in live if isinstance(display, InteractiveMarkersDisplay)]


def describe_selection(session: RvizSession, path: str | None, index: int | None) -> str:
    """Describe the object at a path of the scene; empty if there is none.

    Args:
        session: The session whose displays have drawn it.
        path: The path of its node; None for the background.
        index: The index of its instance, point or triangle.
    """
    if path is None:
        return ""
    for display in session.displays:
        if not display.get("Selectable", True):
            continue
        message = display.message_at(path)
        if message is not None:
            frame = getattr(getattr(message, "header", None), "frame_id", "")
            part = "" if index is None else f", part {index}"
            fields = yaml_text(to_plain(message, truncate=_LONGEST))
            return f"{display.name}{part}, in frame {frame!r}\n{fields}"
        if f"{path}/".startswith(f"{display.path}/"):
            return f"{display.name} ({display.class_name})"
    return path


# The time between two updates of the page [s], by the wall clock.
PERIOD = 0.5


class PanelController:
    """The panels of a page, synchronized with a session.

    Args:
        session: The session to show.
        link: The connection to the page.
        graph: The running graph, whose topics can be added.
    """

    def __init__(self, session: RvizSession, link: PageLink, graph: Graph | None = None) -> None:
        self._session, self._link, self._graph = session, link, graph
        self._commands = CommandHandler(session)
        self._sent_state: protocol.PanelState | None = None
        self._sent_rows: dict[str, protocol.PanelRow] = {}
        # The pages with an open panel. Only these receive new rows, because computing them is slow.
        self._row_watchers: set[str] = set()
        # Wall-clock time of the last message [s].
        self._posted = 0.0
        self._is_post_scheduled = False
        # The event loop of the cells, if this is a kernel.
        self._loop = running_loop()
        link.listen("panels", self._on_command)
        link.listen("ready", self._wake)
        session.after_frame.append(self.refresh)

    def close(self) -> None:
        """Stop following the session."""
        if self.refresh in self._session.after_frame:
            self._session.after_frame.remove(self.refresh)

    def _on_command(self, content: Mapping[str, Any]) -> None:
        """Execute a command of the page. The page shows errors."""
        self._commands.notice = protocol.Notice()
        command: protocol.Command | None = None
        try:
            command = from_json(protocol.AnyCommand, content)
            if isinstance(command, protocol.OpenPanels):
                self._sent_state, self._sent_rows = None, {}
            elif isinstance(command, protocol.WatchRows):
                change = self._row_watchers.add if command.watched else self._row_watchers.discard
                change(str(content.get("page", "")))
            else:
                self._commands.execute(command)
        except Exception as error:
            # The page shows all errors, including errors of the kit.
            self._commands.notice = protocol.Notice("error", describe(error))
        if isinstance(command, protocol.UseControl) and command.event == "move":
            # These commands are frequent, so updates are throttled.
            self.refresh()
        else:
            self.post()

    def _wake(self, _: Mapping[str, Any]) -> None:
        """Send changes to a page that was hidden. A newly loaded page sends a command first."""
        if self._sent_state is not None:
            self.post()

    def refresh(self) -> None:
        """Send changes now or a little later; called after every frame, by any thread."""
        if not self._link.is_watched:
            return
        if wall.monotonic() - self._posted >= PERIOD:
            self._post_regularly()
        elif self._loop is not None and not self._is_post_scheduled:
            self._is_post_scheduled = True
            self._loop.call_soon_threadsafe(self._loop.call_later, PERIOD, self._post_regularly)

    def _post_regularly(self) -> None:
        """Send the changes, without the rows while the panels are folded in all pages."""
        self._row_watchers &= self._link.pages
        self.post(with_rows=bool(self._row_watchers))

    def post(self, *, with_rows: bool = True) -> None:
        """Send the fields of the state and the rows that have changed."""
        with exceptions_as_status(self._session.statuses, "Panels"):
            self._is_post_scheduled, self._posted = False, wall.monotonic()
            sent = self._sent_state
            if with_rows or sent is None:
                state, rows = self.full_state()
            else:
                state, rows = self._state(sent.tree, sent.view, sent.tools), self._sent_rows
            now = msgspec.structs.asdict(state)
            changed_fields = {
                name: value for name, value in now.items() if value != getattr(sent, name, None)
            }
            changed_rows = {key: row for key, row in rows.items() if row != self._sent_rows.get(key)}
            update = protocol.PanelUpdate(
                changed_fields, changed_rows, tuple(self._sent_rows.keys() - rows.keys())
            )
            self._sent_state, self._sent_rows = state, rows
            if changed_fields or changed_rows or update.gone:
                self._link.post({"type": "panels", **to_json(update)})

    def full_state(self) -> tuple[protocol.PanelState, dict[str, protocol.PanelRow]]:
        """Return the complete state of the panels, and its rows."""
        session = self._session
        tree, view, tools = display_rows(session), view_rows(session), Rows()
        for tool in (tool for tool in session.tools if tool.properties):
            tools.put(f"tool {tool}", "", tool.label)
            tools.put_properties(tool, f"tool {tool}")
        self._commands.rows = tree | view | tools
        rows = {key: entry.row for key, entry in self._commands.rows.items()}
        return self._state(tuple(tree), tuple(view), tuple(tools)), rows

    def _state(
        self,
        tree: tuple[str, ...],
        view: tuple[str, ...],
        tools: tuple[str, ...],
    ) -> protocol.PanelState:
        """Return the state of the panels.

        Args:
            tree: The keys of the rows of the Displays panel.
            view: The keys of the rows of the Views panel.
            tools: The keys of the rows of the Tool Properties panel.
        """
        session, commands = self._session, self._commands
        view_names = tuple(view_names.name for view_names in session.saved_views)
        working_folder = Path.cwd()
        files = (path for folder in _FOLDERS for path in sorted((working_folder / folder).glob("*.rviz")))
        layouts = tuple(path.relative_to(working_folder).as_posix() for path in files)
        # The status line shows the first of the worst statuses; if all are ok, the number of
        # displays.
        statuses = session.rows()
        level = worst_of(row.level for row in statuses)
        worst = [row for row in statuses if row.level == level]
        status = format_count(len(session.displays), "display")
        if worst and level != "ok":
            more = f" (and {len(worst) - 1} more)" if len(worst) > 1 else ""
            status = f"{worst[0].display}: {worst[0].text}{more}"
        return protocol.PanelState(
            tree=tree,
            view=view,
            tools=tools,
            toolbar=tuple(protocol.ToolButton(tool.label, tool.key, tool.gesture) for tool in session.tools),
            settings=settings_of(session.tools),
            drag=session.view.drag_rules(),
            views=protocol.ViewChoice(repr(session.view), tuple(VIEWS), view_names),
            status=protocol.StatusLine(mark_of(level), status),
            notice=commands.notice,
            selection=commands.selection,
            types=tuple(
                protocol.AddableType(name, short_name(name), describe_class(name))
                for name in (*sorted(REGISTRY), GROUP)
            ),
            topics=self._topics(),
            handles=tuple(display.handles for display in handles(session)),
            menu=commands.menu,
            frames=tuple(sorted({session.fixed_frame, *session.context.frames.buffer.frames()})),
            layouts=protocol.Layouts(commands.file, layouts),
            summary=session.summary(),
        )

    def _topics(self) -> tuple[protocol.AddableTopic, ...]:
        """Return the topics with messages or publishers, with each display class for them."""
        types_by_topic = dict(self._session.types)
        if self._graph:
            types_by_topic |= {
                end.topic: end.type_name for end in self._graph.endpoints() if end.kind == "pub"
            }
        types = [(name, getattr(display, "type_name", "")) for name, display in REGISTRY.items()]
        addable = (
            protocol.AddableTopic(topic, kind, name)
            for topic, kind in types_by_topic.items()
            for name, takes in types
            if takes == kind
        )
        return tuple(sorted(addable))


# The time between two updates [s], by the wall clock.
TIME_PERIOD = 0.1
RATES = (0.01, 100.0)
# Robot time of a step.
_STEP_NS = NS // 10


class TimeState(Message, frozen=True):
    """The state of a time bar, [s]; wall time only for a live graph, the range only for a recording."""

    elapsed: float
    paused: bool
    rate: float
    # ROS time.
    now: float | None = None
    range: tuple[float, float] | None = None
    wall: float | None = None
    wall_elapsed: float | None = None
    loop: bool = False
    note: str = ""


class TimeChange(Message, frozen=True):
    """A command of a time bar; without any field it requests the time."""

    now: float | None = None  # [s] since the start
    # The number of frames to step.
    step: int | None = None
    rate: float | None = None
    loop: bool | None = None
    paused: bool | None = None


class LiveTime:
    """The robot time of the running graph, which can be paused, stepped, slowed or accelerated."""

    def __init__(self, graph: Graph, view_time: ViewTime) -> None:
        self._graph = graph
        self._view_time = view_time
        self._speed = pace.speed_of(graph)
        # The source of ROS time, and its first time, [ns].
        self._start: tuple[bool, int] | None = None
        self._wall = wall.monotonic()

    def time(self) -> TimeState:
        """Return ROS time and wall time."""
        now_ns = self._view_time.ros_ns(self._graph.now_ns)
        wall_now, wall_elapsed = wall.time_ns() / NS, wall.monotonic() - self._wall
        # ROS time restarts with another source, and after a jump back.
        source = self._view_time.use_sim_time
        if self._start is None or self._start[0] != source or not 0 < self._start[1] <= now_ns:
            self._start = source, now_ns
        return TimeState(
            (now_ns - self._start[1]) / NS,
            self._speed.is_paused,
            self._speed.rate,
            now_ns / NS,
            wall=wall_now,
            wall_elapsed=wall_elapsed,
        )

    def act(self, change: TimeChange) -> None:
        """Step, pause or change the rate, or raise a MessageError if a robot controls the time."""
        if self._graph.keeps_wall_time and change != TimeChange():
            raise MessageError("The time of a robot cannot be paused, accelerated or slowed down.")
        if change.step == 1:
            self._speed.is_paused = True
            self._speed.step_ns += _STEP_NS
        if change.rate is not None and RATES[0] <= change.rate <= RATES[1]:
            self._speed.rate = change.rate
        if change.paused is not None:
            self._speed.is_paused = change.paused


class Playback:
    """Plays a recording to a session up to any time; to go back, it restarts from the beginning."""

    def __init__(self, session: RvizSession, recording: Recording) -> None:
        self.session = session
        self.start_ns, self.end_ns = recording.start_ns, recording.end_ns
        self.now_ns = self.start_ns
        self.is_paused = False
        self.rate = 1.0
        self.loop = False
        self._samples = recording.samples
        # The first sample that was not delivered yet.
        self._next = 0

    def go_to(self, now_ns: int) -> None:
        """Show the state at a robot time, [ns]."""
        if now_ns < self.now_ns:
            # The session detects the jump back in time.
            self._next = 0
        while self._next < len(self._samples) and self._samples[self._next].stamp_ns <= now_ns:
            self._next += 1
            self.session.receive(self._samples[self._next - 1])
        self.now_ns = now_ns
        self.session.update(now_ns)

    def advance(self, seconds: float) -> None:
        """Play for a duration of wall time, [s]."""
        if self.is_paused:
            return
        now_ns = self.now_ns + round(seconds * self.rate * NS)
        if now_ns < self.end_ns:
            self.go_to(now_ns)
        elif self.loop and self.end_ns > self.start_ns:
            self.go_to(self.start_ns + (now_ns - self.start_ns) % (self.end_ns - self.start_ns))
        else:
            self.go_to(self.end_ns)
            self.is_paused = True

    def act(self, change: TimeChange) -> None:
        """Seek, step, pause or change the rate."""
        if change.now is not None:
            self._seek(self.start_ns + round(change.now * NS))
        if change.step is not None:
            self.is_paused = True
            self._seek(self.now_ns + change.step * NS // self.session.time.frame_rate)
        if change.rate is not None and 0 < change.rate <= RATES[1]:
            self.rate = change.rate
        self.loop = self.loop if change.loop is None else change.loop
        self.is_paused = self.is_paused if change.paused is None else change.paused
        if change.paused is False and self.now_ns >= self.end_ns:
            self.go_to(self.start_ns)

    def time(self) -> TimeState:
        """Return the time in the recording."""
        elapsed, end = ((ns - self.start_ns) / NS for ns in (self.now_ns, self.end_ns))
        return TimeState(
            elapsed, self.is_paused, self.rate, self.now_ns / NS, range=(0.0, end), loop=self.loop
        )

    def _seek(self, now_ns: int) -> None:
        self.go_to(min(max(now_ns, self.start_ns), self.end_ns))


class TimePanel:
    """The time bars of pages, synchronized with a source of time that executes their commands."""

    def __init__(self, session: RvizSession, link: PageLink, source: LiveTime | Playback) -> None:
        self._session = session
        self._link = link
        self._source = source
        # Wall-clock time of the last message [s].
        self._posted = 0.0
        self._posted_state: TimeState | None = None
        link.listen("time", self._execute)
        session.after_frame.append(self.refresh)

    def close(self) -> None:
        """Stop following the session."""
        self._session.after_frame.remove(self.refresh)

    def refresh(self) -> None:
        """Send the time if it has changed and the last message is old enough."""
        period = max(TIME_PERIOD, self._link.interval)
        is_due = self._link.is_watched and wall.monotonic() - self._posted >= period
        if is_due and self._source.time() != self._posted_state:
            self._post()

    def _execute(self, content: dict[str, Any]) -> None:
        note = ""
        try:
            self._source.act(from_json(TimeChange, content))
        except Exception as error:
            # The page shows all errors, including errors of the kit.
            note = describe(error)
        self._post(note)
        # The effect is shown with the next frame.
        self._posted = 0.0

    def _post(self, note: str = "") -> None:
        self._posted, self._posted_state = wall.monotonic(), self._source.time()
        self._link.post({"type": "time", **to_json(replace(self._posted_state, note=note))})
