"""A frozen view: the current state of a viewer, and a recording that the page can play."""

import json
import weakref
from typing import Any

import msgspec
from msgspec.structs import replace

from course_lib.displays.panel.panels import PanelController
from course_lib.displays.panel.protocol import Gesture, Notice, PanelUpdate
from course_lib.displays.session import RvizSession
from course_lib.displays.statuses import StatusTable
from course_lib.viewer.encoding import to_json
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene
from course_lib.viewer.scene_recording import SceneRecording, copy_of
from course_lib.viewer.widget import MimeBundle, SceneWidget, with_description

# Tools that need no Python.
_OF_THE_PAGE: tuple[Gesture, ...] = ("interact", "camera", "focus", "measure")
RECORDED = "Recorded. Press play to watch it again."
REPLAY = "Recorded. It plays again and again; press pause to look closely."


class RestingView(SceneWidget):
    """The scene and the panels of a viewer in their current state, with a recording.

    Args:
        session: The viewer's session.
        recording: The recording of its scene.
        seconds: The length of the recording to keep [s].
        plays: Whether the page plays it again and again, from the start on.
    """

    def __init__(
        self,
        session: RvizSession,
        recording: SceneRecording,
        seconds: float,
        *,
        plays: bool = False,
    ) -> None:
        self._status_text = str(StatusTable(session.rows()))
        # The only message to the panels has read-only rows, and tools that need no Python.
        controller = PanelController(session, PageLink(Scene(), lambda content, buffers: None))
        state, rows = controller.full_state()
        controller.close()
        tools = tuple(tool for tool in state.toolbar if tool.gesture in _OF_THE_PAGE)
        notice = Notice("", REPLAY if plays else RECORDED)
        state = replace(state, toolbar=tools, handles=(), notice=notice)
        for key, row in rows.items():
            text = row.text if row.editor is None or row.value is None else str(row.value)
            is_off = row.checked is False
            rows[key] = replace(row, text="off" if is_off else text, value=None, checked=None, editor=None)
        panels = json.dumps(to_json(PanelUpdate(msgspec.structs.asdict(state), rows, ())))
        self._source, self._span = weakref.ref(recording), (seconds, recording.time)
        super().__init__(
            copy_of(recording.scene),
            label="RViz replay" if plays else "RViz view at rest",
            recording=recording.pack(seconds),
            plays=plays,
            panels=panels,
        )

    def pack(self, interval: float) -> bytes:
        """Return the recording with frames at least `interval` [s] apart, while its viewer exists."""
        recording = self._source()
        return recording.pack(*self._span, interval) if recording else self.recording

    def _repr_mimebundle_(self, **kwargs: Any) -> MimeBundle:
        bundle = super()._repr_mimebundle_(**kwargs)
        return with_description(bundle, f"{bundle[0]['text/plain']}\n{self._status_text}")
