"""What a viewer shows, in words."""

from course_lib.displays.session import Session
from course_lib.displays.statuses import StatusTable
from course_lib.viewer.summary import summary


def told(session: Session) -> str:
    """Tell what is drawn, where it is in the fixed frame, and what the statuses say."""
    off = [display.name for display in session.displays if not display.enabled]
    names = ", ".join(f"{d.name}{' (off)' if d.name in off else ''}" for d in session.displays) or "none"
    return "\n".join(
        [
            f"Fixed frame {session.fixed_frame}. Displays: {names}. Positions in metres.",
            *summary(session.context.scene),
            str(StatusTable(session.rows())),
        ]
    )
