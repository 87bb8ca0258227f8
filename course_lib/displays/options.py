"""RViz's Global Options."""

from typing import TYPE_CHECKING

from course_lib.displays.properties import Property, PropertyHolder, color, frame, integer

if TYPE_CHECKING:
    from course_lib.displays.session import RvizSession


class Options(PropertyHolder):
    """RViz's Global Options, as properties of a session."""

    properties = (
        Property("Fixed Frame", "base_link", frame),
        Property("Background Color", (48, 48, 48), color),
        Property("Frame Rate", 30, integer(1)),  # [Hz]
    )

    def __init__(self, session: "RvizSession") -> None:
        super().__init__()
        values = (session.fixed_frame, session.context.scene.background, session.frame_rate)
        self._values = dict(zip(self._values, values, strict=True))
        self._session = session
        self.config = session.layout.options

    def __repr__(self) -> str:
        return "Global Options"

    def changed(self, label: str) -> None:
        """Let the session have it."""
        if label == "Fixed Frame":
            self._session.fixed_frame = self[label]
        elif label == "Background Color":
            self._session.context.scene.background = self[label]
        else:
            self._session.frame_rate = self[label]
