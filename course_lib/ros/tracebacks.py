"""Tracebacks that show the student's own lines, not the kit's."""

import sys
import threading
from pathlib import Path
from traceback import TracebackException
from types import TracebackType

from course_lib.ros.hints import add_hint

KIT = str(Path(__file__).resolve().parent.parent)


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
    shown.stack[:] = own or shown.stack
    for name in ("__cause__", "__context__"):
        inner: TracebackException | None = getattr(shown, name)
        if inner is not None and all(frame.filename.startswith(KIT) for frame in inner.stack):
            setattr(shown, name, None)
        elif inner is not None:
            _shorten(inner)
