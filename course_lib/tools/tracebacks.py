"""Tracebacks that show the student's own lines, not the kit's."""

from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

KIT = str(Path(__file__).resolve().parent.parent)


def shorten(shell: "InteractiveShell") -> None:
    """Leave the kit's frames out of what cells show, and say in one line what needs no traceback."""
    shell.set_custom_exc((Exception, KeyboardInterrupt), _show)  # type: ignore[no-untyped-call]  # IPython does not annotate it


def without_the_kit(trace: TracebackType | None) -> TracebackType | None:
    """Copy a traceback without the kit's frames; one that has no others stays whole."""
    frames = []
    step = trace
    while step is not None:
        frames.append(step)
        step = step.tb_next
    own = [frame for frame in frames if not frame.tb_frame.f_code.co_filename.startswith(KIT)]
    shortened: TracebackType | None = None
    for frame in reversed(own):
        shortened = TracebackType(shortened, frame.tb_frame, frame.tb_lasti, frame.tb_lineno)
    return shortened or trace


def _show(
    shell: Any,
    kind: type[BaseException],
    error: BaseException,
    trace: TracebackType,
    tb_offset: int | None = None,
) -> list[str]:
    if isinstance(error, CourseError | KeyboardInterrupt):
        said = str(error) or "the cell was stopped."
        shell._showtraceback(kind, error, [f"{kind.__name__}: {said}"])
    else:
        shell.showtraceback((kind, error, without_the_kit(trace)), tb_offset=tb_offset)
    return []
