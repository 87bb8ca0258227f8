"""What RViz's Selection panel says of an object: its display, its frame and its message."""

from course_lib.displays.session import Session
from course_lib.displays.yaml_file import yaml_text
from course_lib.ros.messages.plain import to_plain

_LONGEST = 16  # list or text that is shown whole


def selected(session: Session, path: str | None, index: int | None) -> str:
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
