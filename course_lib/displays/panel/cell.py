"""A viewer in notebook cells: the scene with RViz's panels around it."""

import asyncio
import base64
import weakref
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from course_lib.displays.panel.panels import LiveTime, PanelController, TimePanel
from course_lib.displays.session import RvizSession
from course_lib.displays.statuses import StatusTable
from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time import pace, wall
from course_lib.ros.time.time_lock import time_lock
from course_lib.viewer.page_link import Click, PageLink
from course_lib.viewer.scene_recording import SceneRecording

if TYPE_CHECKING:
    from course_lib.displays.panel.resting_view import RestingView
    from course_lib.viewer.page_server import PageServer
    from course_lib.viewer.widget import SceneWidget
# The time for a page to render an image [s], by the wall clock.
_ANSWER = 3.0


class ViewerCell:
    """A viewer in any number of cells. The widget is created for the first one."""

    def __init__(self, session: RvizSession, graph: Graph) -> None:
        self._session = session
        self._graph = graph
        self._view: SceneWidget | None = None
        self._server: PageServer | None = None
        # Functions that close the widgets and servers created for pages.
        self._close_callbacks: list[Callable[[], None]] = []
        session.time.is_hidden = self._is_hidden
        # Called with each click into the view.
        self.on_click: list[Callable[[Click], None]] = []

    async def next_click(self) -> Click:
        """Wait for a click into the view; see `Viewer.pick`."""
        if not self._is_displayed():
            raise CourseError(
                "No page shows this viewer, so no click can occur. Write viewer on the last line "
                "of a cell in JupyterLab, and call pick() in a cell below."
            )
        click: asyncio.Future[Click] = asyncio.get_running_loop().create_future()
        self.on_click.append(click.set_result)
        try:
            return await click
        finally:
            self.on_click.remove(click.set_result)

    def mime_bundle(self, viewer: object, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return the cell's output; pages without scripts get an image and the status table.

        The viewer that owns this panel lives as long as a page shows it.
        """
        from course_lib.viewer.widget import side_panel, with_description

        widget = self._widget(viewer)
        side_panel.take(widget)
        bundle = widget._repr_mimebundle_(**kwargs)
        text = f"{bundle[0]['text/plain']}\n{StatusTable(self._session.rows())}"
        return with_description(bundle, text)

    def dock(self, viewer: object) -> None:
        """Show the viewer in a cell.

        JupyterLab moves this view and all later ones to a side panel.
        """
        # Imported here because they are slow to load and not needed outside notebooks.
        from IPython.display import display

        from course_lib.viewer.widget import side_panel

        side_panel.is_enabled = True
        side_panel.take(self._widget(viewer))
        display(viewer)

    def resting_view(
        self,
        recording: SceneRecording,
        seconds: float,
        *,
        plays: bool = False,
    ) -> "RestingView":
        """Return a view that can play the last part of a recording until no page shows it."""
        # Imported here because anywidget is slow to load.
        from course_lib.displays.panel.resting_view import RestingView

        view = RestingView(self._session, recording, seconds, plays=plays)

        def on_views(count: int) -> None:
            if not count:
                _remove_from_history(view)
                view.close()

        view.on_views = on_views
        return view

    def close(self) -> None:
        """Remove the viewer from all cells."""
        pace.pages.discard(self._is_displayed)
        pace.views.discard(self._is_displayed)
        for end in self._close_callbacks:
            end()
        self._close_callbacks.clear()
        self._view = self._server = None

    def open_page(self, port: int, token: str | None) -> str:
        """Return the URL of a page outside notebooks, served by this process."""
        if self._server is None:
            # Imported here because tornado is slow to load.
            from course_lib.viewer.page_server import PageServer

            server = PageServer(self._session.context.scene, "RViz view", port, token, turn=time_lock.hold)
            # A thread of the program would follow robot time.
            with time_lock.as_ordinary_thread():
                server.start()
            self._server = server
            self._add_panels(server.link, server.close)
        return self._server.url

    def picture(self, size: tuple[int, int]) -> bytes | None:
        """Request a PNG with a size in [px] from an open page, or return None if no page answers."""
        answers: list[dict[str, Any]] = []
        for link in (link for link in self._links() if link.is_ready):
            link.immediate_handlers["picture"] = answers.append
            link.send_all()
            link.post({"type": "capture", "width": size[0], "height": size[1]})
            deadline = wall.monotonic() + _ANSWER
            while not answers and wall.monotonic() < deadline:
                wall.sleep(0.01)
            if answers:
                return base64.b64decode(str(answers[0].get("png", "")).partition(",")[2])
        return None

    def _add_panels(self, link: PageLink, close: Callable[[], None]) -> None:
        """Add RViz's panels to the view of a page."""
        controller = PanelController(self._session, link, self._graph)
        time_panel = TimePanel(self._session, link, LiveTime(self._graph, self._session.time))
        link.on_click.append(self._click)
        self._close_callbacks += [controller.close, time_panel.close, close]

    def _widget(self, viewer: object) -> "SceneWidget":
        """Return the view for a cell's output; it keeps the viewer alive as long as a page shows it."""
        from course_lib.viewer.widget import SceneWidget

        if self._view is not None and self._view.comm is not None:
            self._view.keeps = viewer
            return self._view
        # There is none yet, or the page has closed it.
        pace.pages.add(self._is_displayed)
        pace.views.add(self._is_displayed)
        view = SceneWidget(self._session.context.scene, label="RViz view")
        self._add_panels(view.link, view.close)
        viewer_reference = weakref.ref(viewer)

        def on_views(count: int) -> None:
            view.keeps = owner = viewer_reference()
            if not count and owner is not None:
                view.keeps = None
                _remove_from_history(owner)

        view.on_views, view.keeps = on_views, viewer
        self._view = view
        return view

    def _click(self, click: Click) -> None:
        for callback in tuple(self.on_click):
            callback(click)

    def _links(self) -> list[PageLink]:
        """Return the connections to pages."""
        return [page.link for page in (self._view, self._server) if page is not None]

    def _is_hidden(self) -> bool:
        """Return whether all pages that show the scene are in hidden tabs."""
        links = self._links()
        return any(link.is_hidden for link in links) and not any(link.is_ready for link in links)

    def _is_displayed(self) -> bool:
        """Return whether a page shows the scene."""
        return self._view is not None and self._view.link.is_ready


def _remove_from_history(result: object) -> None:
    """Remove a cell's result from IPython's history (Out, _, __, _7, ...), which would keep it alive."""
    from IPython.core.getipython import get_ipython

    shell = get_ipython()
    if shell is None:
        return
    names, hook = shell.user_ns, vars(shell.displayhook)
    for holder in (names, names.get("_oh", {}), shell.user_ns_hidden, hook):
        for name in [name for name, value in holder.items() if value is result]:
            if isinstance(name, int) or name.strip("_").isdigit():
                del holder[name]
            elif not name.strip("_"):
                # IPython's initial value.
                holder[name] = ""


def close_viewer(stops: Iterable[Callable[[], None]], cell: ViewerCell) -> None:
    """Close a viewer: its subscriptions and its cells."""
    for stop in stops:
        stop()
    cell.close()
