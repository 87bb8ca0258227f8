"""A view at rest: what a viewer has shown, to be played again in the page."""

import json
import weakref
from dataclasses import fields, replace
from typing import Any

from course_lib.displays.panel.desk import Desk
from course_lib.displays.panel.protocol import Gesture, Notice, PanelNews, PanelRow
from course_lib.displays.session import RvizSession
from course_lib.displays.statuses import StatusTable
from course_lib.viewer.film import Film, copied
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget
from course_lib.viewer.wire import to_json

_OF_THE_PAGE: tuple[Gesture, ...] = ("interact", "camera", "focus", "measure")  # need no Python


class RestingView(SceneWidget):
    """The picture and the panels of a viewer as they are now, and a film; nothing changes them any more.

    Args:
        session: Of the viewer.
        film: What it has shown.
        seconds: How much of the film is kept, [s].
    """

    def __init__(self, session: RvizSession, film: Film, seconds: float) -> None:
        self._words = str(StatusTable(session.rows()))
        panels = json.dumps(_panels(session))
        self._source, self._span = weakref.ref(film), (seconds, film.time)
        super().__init__(
            copied(film.scene), label="RViz view at rest", film=film.packed(seconds), panels=panels
        )

    def packed(self, interval: float) -> bytes:
        """Write its film with pictures that are at least so many [s] apart, as long as its viewer lives."""
        film = self._source()
        return film.packed(*self._span, interval) if film else self.film

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        data, metadata = super()._repr_mimebundle_(**kwargs)
        return data | {"text/plain": f"{data['text/plain']}\n{self._words}"}, metadata


def _panels(session: RvizSession) -> Any:
    """Return the only news of the panels: rows to read, and tools that need no Python."""
    desk = Desk(session, PageLink(Scene(), lambda content, buffers: None))
    state, rows = desk.whole()
    desk.close()
    tools = tuple(tool for tool in state.toolbar if tool.gesture in _OF_THE_PAGE)
    state = replace(
        state, toolbar=tools, handles=(), notice=Notice("", "At rest: press play to see it again.")
    )
    changed = {field.name: getattr(state, field.name) for field in fields(state)}
    return to_json(PanelNews(changed, {key: _readable(row) for key, row in rows.items()}, ()))


def _readable(row: PanelRow) -> PanelRow:
    """Return a row whose value is a text."""
    text = row.text if row.editor is None or row.value is None else str(row.value)
    is_off = row.checked is False
    return replace(row, text="off" if is_off else text, value=None, checked=None, editor=None)
