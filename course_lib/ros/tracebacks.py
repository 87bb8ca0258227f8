"""Tracebacks that show the student's own lines, not the kit's, and the line in which code is or failed."""

import linecache
import sys
import sysconfig
import threading
from collections.abc import Iterable, Sequence
from pathlib import Path
from traceback import FrameSummary, StackSummary, TracebackException, walk_stack, walk_tb
from types import TracebackType
from typing import Any

from course_lib.ros.hints import add_hint

KIT = str(Path(__file__).resolve().parent.parent)
OTHERS = (KIT, *sysconfig.get_paths().values())
SHOWN = 6  # frames at each end of a very long traceback


class _Folded(StackSummary):
    """Frames of which the middle is left out where there are very many, as in an endless recursion."""

    def format(self, **kwargs: Any) -> list[str]:
        """Return the lines of a traceback; the arguments are those of later Python versions."""
        hidden = len(self) - 2 * SHOWN
        if hidden <= SHOWN:
            return super().format(**kwargs)
        first, last = (StackSummary.from_list(part) for part in (self[:SHOWN], self[-SHOWN:]))
        again = " of the same lines" if _repeat(self) else ""
        return [*first.format(**kwargs), f"  … {hidden} more frames{again} …\n", *last.format(**kwargs)]


def _repeat(frames: Sequence[FrameSummary]) -> bool:
    """Return whether the frames in the middle are at few lines."""
    return len({(frame.filename, frame.lineno) for frame in frames[SHOWN:-SHOWN]}) <= SHOWN


def without_the_kit(trace: TracebackType | None) -> tuple[TracebackType | None, int]:
    """Copy a traceback without the kit's frames and without the middle of very many frames.

    Returns:
        The copy, and how many frames of the middle it lacks. Where all frames are the kit's, it has them.
    """
    frames = []
    step = trace
    while step is not None:
        frames.append(step)
        step = step.tb_next
    own = [frame for frame in frames if not frame.tb_frame.f_code.co_filename.startswith(KIT)]
    hidden = len(own) - 2 * SHOWN
    if hidden > SHOWN:
        own = own[:SHOWN] + own[-SHOWN:]
    shortened: TracebackType | None = None
    for frame in reversed(own):
        shortened = TracebackType(shortened, frame.tb_frame, frame.tb_lasti, frame.tb_lineno)
    return shortened or trace, hidden if hidden > SHOWN else 0


def shorten_causes(error: BaseException) -> None:
    """Leave the kit's frames out of an error's causes, and causes inside the kit out of the error."""
    seen = {id(error)}
    outer = error
    while (inner := outer.__cause__ or outer.__context__) is not None and id(inner) not in seen:
        seen.add(id(inner))
        if all(frame.f_code.co_filename.startswith(KIT) for frame, _ in walk_tb(inner.__traceback__)):
            outer.__cause__ = outer.__context__ = None
            return
        inner.__traceback__ = without_the_kit(inner.__traceback__)[0]
        outer = inner


def print_error(error: BaseException) -> None:
    """Show an error on stderr as Python does, without the kit's frames and without causes inside the kit."""
    add_hint(error)
    shown = TracebackException.from_exception(error)
    _shorten(shown)
    sys.stderr.write("".join(shown.format()))


def print_error_of_thread(args: threading.ExceptHookArgs) -> None:
    """Show what ended a thread, as `threading.excepthook` does."""
    if args.exc_value is not None and not isinstance(args.exc_value, SystemExit):
        name = args.thread.name if args.thread else "unknown"
        sys.stderr.write(f"Exception in thread {name}:\n")
        print_error(args.exc_value)


def _shorten(shown: TracebackException) -> None:
    own = [frame for frame in shown.stack if not frame.filename.startswith(KIT)]
    shown.stack = _Folded(own or shown.stack)
    for name in ("__cause__", "__context__"):
        inner: TracebackException | None = getattr(shown, name)
        if inner is not None and all(frame.filename.startswith(KIT) for frame in inner.stack):
            setattr(shown, name, None)
        elif inner is not None:
            _shorten(inner)


def line_of_traceback(trace: TracebackType | None) -> str:
    """Return the innermost own line: "cell In[3], line 2: 1 / 0"; "" if there is none."""
    return _innermost((frame.f_code.co_filename, line) for frame, line in walk_tb(trace))


def line_of_thread(ident: int) -> str:
    """Return the own line that a thread is in right now; "" if there is none."""
    frame = sys._current_frames().get(ident)
    stack = [(frame.f_code.co_filename, line) for frame, line in walk_stack(frame)] if frame else []
    return _innermost(reversed(stack))


def is_own(filename: str) -> bool:
    """Return whether a file is the student's: neither the kit's nor Python's nor a library's."""
    return not filename.startswith(("<frozen", *OTHERS))


def name_line(filename: str, line: int) -> str:
    """Return the name of a line and its text; cells have the name that IPython gives them."""
    code = linecache.getline(filename, line).strip()
    return f"{_cell(filename)}line {line}{code and f': {code}'}"


def _innermost(places: Iterable[tuple[str, int | None]]) -> str:
    own = [(name, line) for name, line in places if line and is_own(name)]
    return name_line(*own[-1]) if own else ""


def _cell(filename: str) -> str:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    named = shell.compile.format_code_name(filename) if shell is not None else None
    if named is not None:
        return f"{named[0].lower()} {named[1]}, "
    return f"{Path(filename).name}, " if filename and not filename.startswith("<") else ""
