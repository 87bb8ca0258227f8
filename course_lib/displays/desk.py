"""RViz's panels around a view, for one page: what they show, and what is done there."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from course_lib.displays import rows
from course_lib.displays.display import Display
from course_lib.displays.group import GROUP, Group
from course_lib.displays.layout import read_layout
from course_lib.displays.publishing import ToolNode
from course_lib.displays.registry import REGISTRY, RVIZ_ONLY, short_name
from course_lib.displays.rows import Row
from course_lib.displays.selection import selected
from course_lib.displays.session import Session
from course_lib.displays.statuses import StatusTable
from course_lib.displays.tools import settings_of
from course_lib.displays.topic_display import TopicDisplay
from course_lib.displays.views import VIEWS, view_of
from course_lib.displays.writer import member_config, save_rviz, view_config
from course_lib.errors import CourseError, counted
from course_lib.ros import wall
from course_lib.ros.graph import Graph
from course_lib.viewer.camera import Camera
from course_lib.viewer.flow import running_loop
from course_lib.viewer.page_link import PageLink

PERIOD = 0.5  # [s] of the wall clock between two changes of what the page shows
Order = Mapping[str, Any]


class Desk:
    """Keeps a page's panels equal to a session, and carries out what is done in them.

    Args:
        session: What is shown.
        link: To the page.
        graph: The running graph, whose topics can be added, and in which tools publish.
    """

    def __init__(self, session: Session, link: PageLink, graph: Graph | None = None) -> None:
        self._session, self._link, self._graph = session, link, graph
        self._node = ToolNode(graph) if graph else None
        self._sent: dict[str, Any] = {}
        self._rows: dict[str, Row] = {}
        self._extra: dict[str, Any] = {"selection": "", "notice": {}}
        self._file = "view.rviz"
        self._posted = 0.0  # [s] when the page was last told
        self._waiting = False
        self._loop = running_loop()  # that of the cells, if this is a kernel
        self._orders: dict[str, Callable[[Order], None]] = {
            "open": lambda _: self._sent.clear(),
            "look": lambda _: None,
            "set": lambda order: self._edit(order)(order["value"]),
            "add": self._add,
            "duplicate": self._duplicate,
            "rename": self._rename,
            "remove": lambda order: session.remove(self._member(order)),
            "save": self._save,
            "load": self._load,
            "view": self._take_view,
            "camera": self._turn,
            "select": self._select,
            "publish": self._publish,
        }
        link.listen("desk", self.hear)
        session.after_frame.append(self.refresh)

    def close(self) -> None:
        """Follow the session no more, and take the tools' node out of the graph."""
        if self.refresh in self._session.after_frame:
            self._session.after_frame.remove(self.refresh)
        if self._node:
            self._node.close()

    def hear(self, order: Order) -> None:
        """Do what somebody did in the page; what is wrong with it is shown there."""
        try:
            self._extra["notice"] = {}
            self._orders[order["act"]](order)
        except CourseError as error:
            self._extra["notice"] = {"level": "error", "text": str(error)}
        except (AttributeError, LookupError, TypeError, ValueError) as error:
            said = f"The page asked for something that makes no sense here: {error!r} in {str(order)[:200]}"
            self._extra["notice"] = {"level": "error", "text": said}
        self.post()

    def refresh(self) -> None:
        """Tell the page what has changed, now or a little later; called after every frame, by any thread."""
        if not self._link.ready:
            return
        if wall.monotonic() - self._posted >= PERIOD:
            self.post()
        elif self._loop is not None and not self._waiting:
            self._waiting = True
            self._loop.call_soon_threadsafe(self._loop.call_later, PERIOD, self.post)

    def post(self) -> None:
        """Tell the page what has changed."""
        self._waiting, self._posted = False, wall.monotonic()
        state = self._state()
        changed = {key: value for key, value in state.items() if self._sent.get(key) != value}
        gone = [key for key in self._sent if key not in state]
        self._sent = state
        if changed or gone:
            self._link.post({"type": "desk", "changed": changed, "gone": gone}, [])

    def _state(self) -> dict[str, Any]:
        """Return all that the panels show; rows one by one, as they change one by one."""
        session, tree, view = self._session, rows.display_rows(self._session), rows.view_rows(self._session)
        tools = rows.tool_rows(session)
        self._rows = tree | view | tools
        statuses = StatusTable(session.rows())
        worst = rows.worst_of(row.level for row in statuses)
        told_first = [row for row in statuses if row.level == worst]
        topics = self._topics()
        return {
            "tree": list(tree),
            "view": list(view),
            "toolRows": list(tools),
            "settings": settings_of(session.tools),
            "hands": session.view.hands(),
            "views": [repr(session.view), list(VIEWS), [saved.name for saved in session.saved_views]],
            "status": {**rows.marked(worst), "text": _line(told_first, len(session.displays))},
            "types": [(name, short_name(name)) for name in (*sorted(REGISTRY), GROUP)],
            "undrawn": list(RVIZ_ONLY),
            "topics": topics,
            "frames": sorted({session.fixed_frame, *session.context.frames.buffer.frames()}),
            "tools": [(tool.label, tool.key, tool.gesture) for tool in session.tools],
            "layouts": [self._file, sorted(path.name for path in Path.cwd().glob("*.rviz"))],
            "summary": session.summary(),
            **self._extra,
            **{f"row {key}": {"key": key, **row.data} for key, row in self._rows.items()},
        }

    def _topics(self) -> list[tuple[str, str, str]]:
        """Return what can be shown: topic, type, and the class of display for it."""
        known = dict(self._session.types)
        if self._graph:
            known |= {end.topic: end.type_name for end in self._graph.endpoints() if end.kind == "pub"}
        wanted = [
            (name, display.type_name)
            for name, display in REGISTRY.items()
            if issubclass(display, TopicDisplay)
        ]
        wanted += RVIZ_ONLY.items()
        shows = [
            (topic, kind, name) for topic, kind in known.items() for name, takes in wanted if takes == kind
        ]
        return sorted(shows)

    def _edit(self, order: Order) -> Callable[[Any], Any]:
        edit = self._row(order).edit
        if edit is None:
            raise CourseError(f"{order['row']!r} cannot be edited.")
        return edit

    def _row(self, order: Order) -> Row:
        if order["row"] not in self._rows:
            raise CourseError(f"{order['row']!r} is not there any more.")
        return self._rows[order["row"]]

    def _member(self, order: Order) -> Display | Group:
        member = self._row(order).member
        if member is None:
            raise CourseError("Choose a display for that, in the tree.")
        return member

    def _add(self, order: Order) -> None:
        name, chosen = str(order["class"]), self._rows.get(str(order.get("row")))
        group = chosen.member if chosen and isinstance(chosen.member, Group) else None
        if name == GROUP:
            self._session.add_group("Group", group)
            return
        if name not in REGISTRY and name not in RVIZ_ONLY:
            raise CourseError(f"There is no display {name!r} here.")
        display = REGISTRY.get(name)
        label = display.topic_label if display and issubclass(display, TopicDisplay) else "Topic"
        config = {label: {"Value": str(order["topic"])}} if order.get("topic") else {}
        self._session.add(name, short_name(name), config, group=group)

    def _duplicate(self, order: Order) -> None:
        member = self._member(order)
        if isinstance(member, Group):
            raise CourseError("Groups are not duplicated here; duplicate the displays in it.")
        config = member_config(member)
        holder = self._session.tree.holder(member)
        self._session.add(str(config["Class"]), member.name, config, group=holder)

    def _rename(self, order: Order) -> None:
        self._member(order).name = str(order["name"]).strip() or self._member(order).name

    def _save(self, order: Order) -> None:
        path = self._path(order)
        save_rviz(self._session, path)
        self._extra["notice"] = {"level": "ok", "text": f"Saved {path.name}."}

    def _load(self, order: Order) -> None:
        path = self._path(order)
        self._session.apply(read_layout(path))
        self._extra["notice"] = {"level": "ok", "text": f"Opened {path.name}."}

    def _path(self, order: Order) -> Path:
        """Return a layout in the notebook's folder."""
        name = Path(str(order["name"]).strip()).name
        if not name or name != str(order["name"]).strip():
            raise CourseError(f"{order['name']!r} is no name of a file; write one like view.rviz.")
        self._file = name if name.endswith(".rviz") else f"{name}.rviz"
        return Path.cwd() / self._file

    def _take_view(self, order: Order) -> None:
        """Change the type of view, or do something with the saved ones."""
        session, saved = self._session, self._session.saved_views
        if "class" in order:
            view = VIEWS[order["class"]]()
            view.mimic(session.view, session.context.frames)
            session.view = view
        elif order.get("home"):
            session.view.return_home()
        elif order.get("save"):
            view = view_of(view_config(session.view))[0]
            view.name = str(order["save"])
            saved.append(view)
        elif "select" in order:
            session.view = view_of({**view_config(saved[order["select"]]), "Name": "Current View"})[0]
        elif "remove" in order:
            del saved[order["remove"]]
        else:
            saved[order["rename"]].name = str(order["name"])

    def _turn(self, order: Order) -> None:
        camera = Camera(order["eye"], order["target"], order["up"], orthographic_scale=order["scale"] or None)
        self._session.turned(camera)

    def _select(self, order: Order) -> None:
        self._extra["selection"] = selected(self._session, order.get("path"), order.get("index"))

    def _publish(self, order: Order) -> None:
        if self._node is None:
            raise CourseError("This page shows a recording: nothing can be published into it.")
        said = self._node.publish(self._session, str(order["tool"]), order)
        self._extra["notice"] = {"level": "ok", "text": said}


def _line(worst: StatusTable | list[Any], displays: int) -> str:
    """Say how things are in one line."""
    first = worst[0] if worst else None
    if first is None or first.level == "ok":
        return counted(displays, "display")
    return f"{first.display}: {first.text}" + (f" (and {len(worst) - 1} more)" if len(worst) > 1 else "")
