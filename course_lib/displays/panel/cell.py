"""The viewer's place in a cell: the scene with RViz's panels around it."""

import asyncio
import base64
import weakref
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from course_lib.displays.panel.desk import Desk
from course_lib.displays.panel.time_panel import LiveTime, TimePanel
from course_lib.displays.session import RvizSession
from course_lib.displays.statuses import StatusTable
from course_lib.errors import CourseError
from course_lib.ros import pace, wall
from course_lib.ros.baton import baton
from course_lib.ros.graph import Graph
from course_lib.viewer.film import Film
from course_lib.viewer.page_link import Click, PageLink

if TYPE_CHECKING:
    from course_lib.displays.panel.resting_view import RestingView
    from course_lib.viewer.page_server import PageServer
    from course_lib.viewer.widget import SceneWidget
_ANSWER = 3.0  # [s] of the wall clock that a page has to draw a picture


class ViewerCell:
    """The place of a viewer in any number of cells; its page is made for the first one."""

    def __init__(self, session: RvizSession, graph: Graph) -> None:
        self._session = session
        self._graph = graph
        self._view: SceneWidget | None = None
        self._server: PageServer | None = None
        self._ends: list[Callable[[], None]] = []  # of what was made for pages
        session.time.is_hidden = self._is_hidden
        self.on_click: list[Callable[[Click], None]] = []  # called with each click into the view

    async def next_click(self) -> Click:
        """Wait for a click into the view; see `Viewer.pick`."""
        if not self._is_there():
            raise CourseError(
                "No page shows this viewer, so nobody can click into it. Write viewer on the last line of a "
                "cell in JupyterLab, and call pick() in a cell below."
            )
        clicked: asyncio.Future[Click] = asyncio.get_running_loop().create_future()
        self.on_click.append(clicked.set_result)
        try:
            return await clicked
        finally:
            self.on_click.remove(clicked.set_result)

    def shown(self, viewer: object, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return what a cell displays; pages that run no scripts get a picture and the table.

        The viewer, whose panel this is, lives as long as a page shows it.
        """
        data, metadata = self._widget(viewer)._repr_mimebundle_(**kwargs)
        words = f"{data['text/plain']}\n{StatusTable(self._session.rows())}"
        return data | {"text/plain": words}, metadata

    def dock(self, viewer: object) -> None:
        """Show the viewer in a cell, from where JupyterLab moves it into a panel beside the notebook."""
        from IPython.display import display  # here: slow, and programs outside notebooks do without

        self._widget(viewer).beside = True
        display(viewer)  # type: ignore[no-untyped-call]

    def at_rest(self, film: Film, seconds: float) -> "RestingView":
        """Return a view that plays the last part of a film; it ends with the last page that shows it."""
        from course_lib.displays.panel.resting_view import RestingView  # here: anywidget is slow to load

        view = RestingView(self._session, film, seconds)
        view.on_views = lambda count: None if count else _end(view)
        return view

    def close(self) -> None:
        """Remove the viewer from all cells."""
        pace.pages.discard(self._is_there)
        pace.views.discard(self._is_there)
        for end in self._ends:
            end()
        self._ends.clear()
        self._view = self._server = None

    def opened(self, port: int, token: str | None) -> str:
        """Return the address of a page outside notebooks, served by this process from now on."""
        if self._server is None:
            from course_lib.viewer.page_server import PageServer  # here: tornado is slow to load

            server = PageServer(self._session.context.scene, "RViz view", port, token, turn=baton.known)
            with baton.unknown():  # a thread of the program's own would live by robot time
                server.start()
            self._server = server
            self._furnish(server.link, server.close)
        return self._server.url

    def picture(self, size: tuple[int, int]) -> bytes | None:
        """Request a PNG of a size in [px] from an open page; None if no page is open, or none answers."""
        answers: list[dict[str, Any]] = []
        for link in (link for link in self._links() if link.ready):
            link.at_once["picture"] = answers.append
            link.catch_up()
            link.post({"type": "capture", "width": size[0], "height": size[1]})
            deadline = wall.monotonic() + _ANSWER
            while not answers and wall.monotonic() < deadline:
                wall.sleep(0.01)
            if answers:
                return base64.b64decode(str(answers[0].get("png", "")).partition(",")[2])
        return None

    def _furnish(self, link: PageLink, close: Callable[[], None]) -> None:
        """Put RViz's panels around the view of a page."""
        desk = Desk(self._session, link, self._graph)
        time_panel = TimePanel(self._session, link, LiveTime(self._graph, self._session.time))
        link.on_click.append(self._click)
        self._ends += [desk.close, time_panel.close, close]

    def _widget(self, viewer: object) -> "SceneWidget":
        if self._view is None or self._view.comm is None:  # the page may have closed it
            self._view = self._made(viewer)
        self._view.keeps = viewer
        return self._view

    def _made(self, viewer: object) -> "SceneWidget":
        from course_lib.viewer.widget import SceneWidget

        pace.pages.add(self._is_there)
        pace.views.add(self._is_there)
        view = SceneWidget(self._session.context.scene, label="RViz view")
        self._furnish(view.link, view.close)
        known = weakref.ref(viewer)

        def on_views(count: int) -> None:
            view.keeps = owner = known()
            if not count and owner is not None:
                view.keeps = None
                _forget(owner)

        view.on_views = on_views
        return view

    def _click(self, click: Click) -> None:
        for callback in tuple(self.on_click):
            callback(click)

    def _links(self) -> list[PageLink]:
        """List the connections to pages."""
        return [shown.link for shown in (self._view, self._server) if shown is not None]

    def _is_hidden(self) -> bool:
        """Return whether all pages that show the scene are behind others."""
        links = self._links()
        return any(link.hidden for link in links) and not any(link.ready for link in links)

    def _is_there(self) -> bool:
        """Return whether a page shows the scene."""
        return self._view is not None and self._view.link.ready


def _end(view: "RestingView") -> None:
    _forget(view)
    view.close()


def _forget(result: object) -> None:
    """Remove a cell's result from IPython's history, which would hold it for ever: Out, _, __, _7 ..."""
    from IPython.core.getipython import get_ipython

    shell = get_ipython()
    if shell is None:
        return
    names, hook = shell.user_ns, vars(shell.displayhook)
    for holder in (names, names.get("_oh", {}), shell.user_ns_hidden, hook):
        for name in [name for name, held in holder.items() if held is result]:
            if isinstance(name, int) or name.strip("_").isdigit():
                del holder[name]
            elif not name.strip("_"):
                holder[name] = ""  # as if nothing had been shown yet


def end_all(stops: Iterable[Callable[[], None]], cell: ViewerCell) -> None:
    """End a viewer: what it listens to, and its place in cells."""
    for stop in stops:
        stop()
    cell.close()
