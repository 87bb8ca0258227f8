"""Orders of a page, carried out on a session."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from course_lib.displays.display import GROUP, Display, Group
from course_lib.displays.interactive.display import InteractiveMarkersDisplay
from course_lib.displays.layout import read_layout, yaml_text
from course_lib.displays.panel.controls import ChooseEntry, ContextMenu, UseControl
from course_lib.displays.panel.protocol import (
    ORDERS,
    AddDisplay,
    ChangeView,
    DuplicateDisplay,
    HomeView,
    LoadLayout,
    LookAgain,
    Notice,
    Order,
    PublishGesture,
    RemoveRow,
    RemoveView,
    RenameRow,
    RenameView,
    SaveLayout,
    SaveView,
    SelectObject,
    SetValue,
    TurnView,
    UseView,
)
from course_lib.displays.panel.rows import RowEntry
from course_lib.displays.panel.tools import publish
from course_lib.displays.registry import REGISTRY, short_name
from course_lib.displays.session import RvizSession
from course_lib.displays.views import VIEWS, ViewController, view_of
from course_lib.displays.writer import member_config, save_rviz, view_config
from course_lib.errors import CourseError
from course_lib.ros.messages.wire import to_plain
from course_lib.viewer.camera import Camera
from course_lib.viewer.wire import MessageError, from_json

_LONGEST = 16  # list or text of a selected message that is shown whole
_FOLDERS = ("", "my_files")  # of layouts: the notebook's, and that of the files that lessons write


def order_of(content: Mapping[str, Any]) -> Order:
    """Check an order of a page; its "act" is the name of its class.

    Raises:
        MessageError: If there is no such order, or it is malformed.
    """
    fields = dict(content)
    kind = ORDERS.get(str(fields.pop("act", "")))
    if kind is None:
        raise MessageError(
            f"{content.get('act')!r} from the page is not an order, expected one of {[*ORDERS]}."
        )
    return from_json(kind, fields)


def layout_names() -> tuple[str, ...]:
    """Return the layouts that can be opened, as paths below the notebook's folder."""
    here = Path.cwd()
    found = (path for folder in _FOLDERS for path in sorted((here / folder).glob("*.rviz")))
    return tuple(path.relative_to(here).as_posix() for path in found)


class OrderDesk:
    """Executor of orders; `rows` are those that the page has, `notice` answers the last order.

    Args:
        session: What is changed; tools publish through its node.
    """

    def __init__(self, session: RvizSession) -> None:
        self.rows: Mapping[str, RowEntry] = {}
        self.notice = Notice()
        self.selection = ""
        self.menu = ContextMenu()
        self.file = "view.rviz"
        self._session = session
        self._acts: dict[type, Callable[[Any], None]] = {
            LookAgain: lambda order: None,
            SetValue: self._set,
            AddDisplay: self._add,
            DuplicateDisplay: self._duplicate,
            RenameRow: self._rename,
            RemoveRow: lambda order: session.remove(self._member(order.row)),
            SaveLayout: self._save,
            LoadLayout: self._load,
            ChangeView: self._change_view,
            HomeView: lambda order: session.view.return_home(),
            SaveView: self._save_view,
            UseView: self._use_view,
            RenameView: lambda order: setattr(self._saved(order.index), "name", order.name),
            RemoveView: lambda order: session.saved_views.remove(self._saved(order.index)),
            TurnView: self._turn,
            SelectObject: self._select,
            PublishGesture: self._publish,
            UseControl: self._use,
            ChooseEntry: self._choose,
        }

    def carry_out(self, order: Order) -> None:
        """Change the session.

        Raises:
            CourseError: If that is impossible; the message is for the page.
        """
        self._acts[type(order)](order)

    def _entry(self, row: str) -> RowEntry:
        if row not in self.rows:
            raise CourseError(f"{row!r} is not there any more.")
        return self.rows[row]

    def _member(self, row: str) -> Display | Group:
        member = self._entry(row).member
        if member is None:
            raise CourseError("Choose a display for that, in the tree.")
        return member

    def _set(self, order: SetValue) -> None:
        edit = self._entry(order.row).edit
        if edit is None:
            raise CourseError(f"{order.row!r} cannot be edited.")
        edit(order.value)

    def _add(self, order: AddDisplay) -> None:
        chosen = self.rows.get(order.row)
        group = chosen.member if chosen and isinstance(chosen.member, Group) else None
        if order.display == GROUP:
            self._session.add_group("Group", group)
            return
        if order.display not in REGISTRY:
            raise CourseError(f"There is no display {order.display!r} here.")
        label = getattr(REGISTRY[order.display], "topic_label", "Topic")
        config = {label: {"Value": order.topic}} if order.topic else {}
        self._session.add(order.display, short_name(order.display), config, group=group)

    def _duplicate(self, order: DuplicateDisplay) -> None:
        member = self._member(order.row)
        if isinstance(member, Group):
            raise CourseError("Groups are not duplicated here; duplicate the displays in it.")
        config = member_config(member)
        holder = self._session.tree.holder(member)
        self._session.add(str(config["Class"]), member.name, config, group=holder)

    def _rename(self, order: RenameRow) -> None:
        member = self._member(order.row)
        member.name = order.name.strip() or member.name

    def _save(self, order: SaveLayout) -> None:
        path = self._path(order.name)
        save_rviz(self._session, path)
        self.notice = Notice("ok", f"Saved {self.file}.")

    def _load(self, order: LoadLayout) -> None:
        path = self._path(order.name)
        self._session.apply(read_layout(path))
        self.notice = Notice("ok", f"Opened {self.file}.")

    def _path(self, wanted: str) -> Path:
        """Return the path of a layout in one of the folders of layouts."""
        name = wanted.strip()
        folder, _, last = name.rpartition("/")
        if not last or last != Path(last).name or folder not in _FOLDERS:
            raise CourseError(f"{wanted!r} is not the name of a file; write one like view.rviz.")
        self.file = name if name.endswith(".rviz") else f"{name}.rviz"
        return Path.cwd() / self.file

    def _saved(self, index: int) -> ViewController:
        if not 0 <= index < len(self._session.saved_views):
            raise CourseError("That saved view is not there any more.")
        return self._session.saved_views[index]

    def _change_view(self, order: ChangeView) -> None:
        if order.view not in VIEWS:
            raise CourseError(f"There is no view {order.view!r}, but {', '.join(VIEWS)}.")
        view = VIEWS[order.view]()
        view.mimic(self._session.view, self._session.context.frames)
        self._session.view = view

    def _save_view(self, order: SaveView) -> None:
        view = view_of(view_config(self._session.view))[0]
        view.name = order.name
        self._session.saved_views.append(view)

    def _use_view(self, order: UseView) -> None:
        config = view_config(self._saved(order.index))
        self._session.view = view_of({**config, "Name": "Current View"})[0]

    def _turn(self, order: TurnView) -> None:
        scale = order.scale or None
        self._session.turned(Camera(order.eye, order.target, order.up, orthographic_scale=scale))

    def _select(self, order: SelectObject) -> None:
        self.selection = selected(self._session, order.path, order.index)

    def _publish(self, order: PublishGesture) -> None:
        node = self._session.context.node
        if node is None:
            raise CourseError("This page shows a recording: nothing can be published into it.")
        self.notice = Notice("ok", publish(node, self._session.tools, self._session.fixed_frame, order))

    def _use(self, order: UseControl) -> None:
        for display in handles(self._session):
            entries = display.use(order)
            if order.event != "move":
                display.show_only(order.path if order.event == "down" and self._hides() else None)
            if entries:
                self.menu = ContextMenu(self.menu.number + 1, order.path, entries)

    def _hides(self) -> bool:
        tool = next(tool for tool in self._session.tools if tool.gesture == "interact")
        return bool(tool["Hide Inactive Objects"])

    def _choose(self, order: ChooseEntry) -> None:
        for display in handles(self._session):
            if display.message_at(order.path) is not None:
                self.notice = Notice("ok", display.choose(order.path, order.entry))


def handles(session: RvizSession) -> list[InteractiveMarkersDisplay]:
    """Return the displays whose markers a page can drag: none where a recording is shown."""
    live = session.displays if session.context.node is not None else ()
    return [display for display in live if isinstance(display, InteractiveMarkersDisplay)]


def selected(session: RvizSession, path: str | None, index: int | None) -> str:
    """Describe what is at a path of the scene; empty if nothing is.

    Args:
        session: Whose displays have drawn it.
        path: Its node, None for the background.
        index: Which instance, point or triangle of it.
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
