"""RViz's panels around a view, for one page: the state that the page is sent, and the orders it sends."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from course_lib.displays.display import GROUP
from course_lib.displays.panel.controls import UseControl
from course_lib.displays.panel.orders import OrderDesk, handles, layout_names, order_of
from course_lib.displays.panel.protocol import (
    AddableTopic,
    AddableType,
    Layouts,
    Notice,
    OpenPanels,
    PanelNews,
    PanelRow,
    PanelState,
    StatusLine,
    ToolButton,
    ViewChoice,
)
from course_lib.displays.panel.rows import display_rows, mark_of, tool_rows, view_rows, worst_of
from course_lib.displays.panel.tools import settings_of
from course_lib.displays.registry import REGISTRY, short_name
from course_lib.displays.session import RvizSession
from course_lib.displays.statuses import StatusRow
from course_lib.displays.views import VIEWS
from course_lib.errors import CourseError, counted
from course_lib.ros import wall
from course_lib.ros.graph import Graph
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.stream import running_loop
from course_lib.viewer.wire import to_json

PERIOD = 0.5  # [s] of the wall clock between two changes of what the page shows


class Desk:
    """The panels of a page, kept equal to a session; its orders are carried out.

    Args:
        session: What is shown.
        link: To the page.
        graph: The running graph, whose topics can be added.
    """

    def __init__(self, session: RvizSession, link: PageLink, graph: Graph | None = None) -> None:
        self._session, self._link, self._graph = session, link, graph
        self._orders = OrderDesk(session)
        self._sent: PanelState | None = None
        self._sent_rows: dict[str, PanelRow] = {}
        self._posted = 0.0  # [s] of the last post
        self._waiting = False
        self._loop = running_loop()  # that of the cells, if this is a kernel
        link.listen("desk", self._take)
        link.listen("ready", self._wake)
        session.after_frame.append(self.refresh)

    def close(self) -> None:
        """Stop following the session."""
        if self.refresh in self._session.after_frame:
            self._session.after_frame.remove(self.refresh)

    def _take(self, content: Mapping[str, Any]) -> None:
        """Carry out an order of the page; errors are shown there."""
        self._orders.notice = Notice()
        order = None
        try:
            order = order_of(content)
            if isinstance(order, OpenPanels):
                self._sent, self._sent_rows = None, {}
            else:
                self._orders.carry_out(order)
        except CourseError as error:
            self._orders.notice = Notice("error", str(error))
        if isinstance(order, UseControl) and order.event == "move":
            self.refresh()  # many of them come
        else:
            self.post()

    def _wake(self, _: Mapping[str, Any]) -> None:
        """Post to a page that was hidden; one that has just been loaded sends an order first."""
        if self._sent is not None:
            self.post()

    def refresh(self) -> None:
        """Post changes, now or a little later; called after every frame, by any thread."""
        if not self._link.watched:
            return
        if wall.monotonic() - self._posted >= PERIOD:
            self.post()
        elif self._loop is not None and not self._waiting:
            self._waiting = True
            self._loop.call_soon_threadsafe(self._loop.call_later, PERIOD, self.post)

    def post(self) -> None:
        """Send the page the fields of the state and the rows that have changed."""
        self._waiting, self._posted = False, wall.monotonic()
        state, rows = self.whole()
        names = (field.name for field in fields(PanelState))
        now = {name: getattr(state, name) for name in names}
        changed = {name: value for name, value in now.items() if value != getattr(self._sent, name, None)}
        changed_rows = {key: row for key, row in rows.items() if row != self._sent_rows.get(key)}
        news = PanelNews(changed, changed_rows, tuple(self._sent_rows.keys() - rows.keys()))
        self._sent, self._sent_rows = state, rows
        if changed or changed_rows or news.gone:
            self._link.post({"type": "desk", **to_json(news)})

    def whole(self) -> tuple[PanelState, dict[str, PanelRow]]:
        """Return all that the panels show now: the state and its rows."""
        state = self._state()
        return state, {key: entry.row for key, entry in self._orders.rows.items()}

    def _state(self) -> PanelState:
        session, orders = self._session, self._orders
        tree, view, tools = display_rows(session), view_rows(session), tool_rows(session)
        orders.rows = tree | view | tools
        saved = tuple(saved.name for saved in session.saved_views)
        return PanelState(
            tree=tuple(tree),
            view=tuple(view),
            tools=tuple(tools),
            toolbar=tuple(ToolButton(tool.label, tool.key, tool.gesture) for tool in session.tools),
            settings=settings_of(session.tools),
            hands=session.view.hands(),
            views=ViewChoice(repr(session.view), tuple(VIEWS), saved),
            status=_status_line(session.rows(), len(session.displays)),
            notice=orders.notice,
            selection=orders.selection,
            types=tuple(AddableType(name, short_name(name)) for name in (*sorted(REGISTRY), GROUP)),
            topics=self._topics(),
            handles=tuple(display.handles for display in handles(session)),
            menu=orders.menu,
            frames=tuple(sorted({session.fixed_frame, *session.context.frames.buffer.frames()})),
            layouts=Layouts(orders.file, layout_names()),
            summary=session.summary(),
        )

    def _topics(self) -> tuple[AddableTopic, ...]:
        """Return the topics with messages or publishers, with each class of display for them."""
        known = dict(self._session.types)
        if self._graph:
            known |= {end.topic: end.type_name for end in self._graph.endpoints() if end.kind == "pub"}
        types = [(name, getattr(display, "type_name", "")) for name, display in REGISTRY.items()]
        addable = (
            AddableTopic(topic, kind, name)
            for topic, kind in known.items()
            for name, takes in types
            if takes == kind
        )
        return tuple(sorted(addable))


def _status_line(rows: list[StatusRow], displays: int) -> StatusLine:
    """Return the first of the worst statuses; if all is well, the number of displays."""
    level = worst_of(row.level for row in rows)
    worst = [row for row in rows if row.level == level]
    text = counted(displays, "display")
    if worst and level != "ok":
        more = f" (and {len(worst) - 1} more)" if len(worst) > 1 else ""
        text = f"{worst[0].display}: {worst[0].text}{more}"
    return StatusLine(mark_of(level), text)
