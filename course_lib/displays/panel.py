"""The viewer's place in a cell: the scene, and below it the statuses."""

import asyncio
import weakref
from typing import TYPE_CHECKING, Any

from course_lib.displays.session import Session
from course_lib.displays.statuses import StatusTable
from course_lib.ros import pace, wall

if TYPE_CHECKING:
    import ipywidgets

_PERIOD = 0.5  # [s] of the wall clock between two changes of the table


class Panel:
    """Shows a session in as many cells as ask for it; made when the first one does."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._box: ipywidgets.VBox | None = None
        self._written = 0.0  # [s] when the table was last changed
        self._waiting = False
        self._loop: asyncio.AbstractEventLoop | None = None

    def shown(self, viewer: object, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return what a cell displays; pages that run no scripts get a picture and the table.

        The viewer, whose panel this is, lives as long as a page shows it.
        """
        if self._box is None:
            self._box = self._made(viewer)
        view = self._box.children[0]
        view.keeps = viewer
        self._write()
        picture, metadata = view._repr_mimebundle_(**kwargs)
        words = f"{picture['text/plain']}\n{StatusTable(self._session.rows())}"
        return picture | self._box._repr_mimebundle_(**kwargs) | {"text/plain": words}, metadata

    def refresh(self) -> None:
        """Change the table, now or a little later; called after every frame, from any thread."""
        if self._box is None:
            return
        if wall.monotonic() - self._written >= _PERIOD:
            self._write()
        elif self._loop is not None and not self._waiting:
            self._waiting = True
            self._loop.call_soon_threadsafe(self._loop.call_later, _PERIOD, self._write)

    def close(self) -> None:
        """Take the viewer out of all cells."""
        if self._box is not None:
            pace.pages.discard(self._is_there)
            for widget in (*self._box.children, self._box):
                widget.close()
            self._box = None

    def _made(self, viewer: object) -> "ipywidgets.VBox":
        import ipywidgets

        from course_lib.viewer.widget import SceneWidget

        try:
            self._loop = asyncio.get_running_loop()
        except RuntimeError:  # no kernel
            self._loop = None
        self._session.after_frame.append(self.refresh)
        pace.pages.add(self._is_there)
        view = SceneWidget(self._session.context.scene, label="RViz view")
        known = weakref.ref(viewer)

        def on_views(count: int) -> None:
            view.keeps = owner = known()
            if not count and owner is not None:
                view.keeps = None
                _forget(owner)

        view.on_views = on_views
        return ipywidgets.VBox([view, ipywidgets.HTML()])

    def _is_there(self) -> bool:
        """Say whether a page shows the scene."""
        return self._box is not None and bool(self._box.children[0].link.ready)

    def _write(self) -> None:
        self._waiting = False
        if self._box is None:
            return
        self._written = wall.monotonic()
        self._box.children[1].value = StatusTable(self._session.rows())._repr_html_()


def _forget(result: object) -> None:
    """Take a cell's result out of IPython's history, which would hold it for ever: Out, _, __, _7 ..."""
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
