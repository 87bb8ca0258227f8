"""Tracebacks of cells."""

from types import TracebackType
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.ros.hints import add_hint
from course_lib.ros.tracebacks import line_of_traceback, without_the_kit

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell


def shorten(shell: "InteractiveShell") -> None:
    """Leave the kit's frames out of what cells show, and say in one line what needs no traceback."""
    shell.set_custom_exc((Exception, KeyboardInterrupt), _show)  # type: ignore[no-untyped-call]  # IPython does not annotate it


def _show(
    shell: Any,
    kind: type[BaseException],
    error: BaseException,
    trace: TracebackType,
    tb_offset: int | None = None,
) -> list[str]:
    if isinstance(error, CourseError | KeyboardInterrupt):
        line = line_of_traceback(trace) if isinstance(error, KeyboardInterrupt) else ""
        said = str(error) or f"the cell was stopped{line and f' in {line}'}."
        shell._showtraceback(kind, error, [f"{kind.__name__}: {said}"])
    else:
        add_hint(error)
        own, hidden = without_the_kit(trace)
        if hidden:
            error.add_note(f"({hidden} frames in the middle are not shown)")
        shell.showtraceback((kind, error, own), tb_offset=tb_offset)
    return []
