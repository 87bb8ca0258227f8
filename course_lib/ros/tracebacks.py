"""Tracebacks without the kit's frames, and the line of the student's code that runs or failed."""

import ast
import contextlib
import importlib
import linecache
import os
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from traceback import StackSummary, TracebackException, walk_stack, walk_tb
from types import TracebackType
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.hints import add_hint
from course_lib.ros.notices import print_notice
from course_lib.ros.student_code import KIT, is_student_file

# Frames between an import and the module, which Python does not show either, and frames of context
# managers.
_HIDDEN = (KIT, "<frozen importlib", importlib.__file__, contextlib.__file__)
# Number of frames at each end of a very long traceback.
SHOWN_FRAMES = 6


class _AbbreviatedStack(StackSummary):
    """A stack whose middle is omitted if it is very long, as after infinite recursion."""

    def format(self, **kwargs: Any) -> list[str]:
        """Format the lines of a traceback.

        The arguments are the same as in later Python versions.
        """
        hidden_count = len(self) - 2 * SHOWN_FRAMES
        if hidden_count <= SHOWN_FRAMES:
            return super().format(**kwargs)
        first, last = (StackSummary.from_list(part) for part in (self[:SHOWN_FRAMES], self[-SHOWN_FRAMES:]))
        lines = {(frame.filename, frame.lineno) for frame in self[SHOWN_FRAMES:-SHOWN_FRAMES]}
        repeated_text = " of the same lines" if len(lines) <= SHOWN_FRAMES else ""
        return [
            *first.format(**kwargs),
            f"  … {hidden_count} more frames{repeated_text} …\n",
            *last.format(**kwargs),
        ]


def hide_kit_frames(trace: TracebackType | None) -> tuple[TracebackType | None, int]:
    """Copy a traceback without the kit's frames, and without the middle of a very long stack.

    Returns:
        The copy, and the number of omitted frames of the middle. A traceback with frames of the kit
            only is returned whole.
    """
    frames = []
    step = trace
    while step is not None:
        frames.append(step)
        step = step.tb_next
    own_frames = [frame for frame in frames if not frame.tb_frame.f_code.co_filename.startswith(_HIDDEN)]
    hidden_count = len(own_frames) - 2 * SHOWN_FRAMES
    if hidden_count > SHOWN_FRAMES:
        own_frames = own_frames[:SHOWN_FRAMES] + own_frames[-SHOWN_FRAMES:]
    shortened: TracebackType | None = None
    for frame in reversed(own_frames):
        shortened = TracebackType(shortened, frame.tb_frame, frame.tb_lasti, frame.tb_lineno)
    return shortened or trace, hidden_count if hidden_count > SHOWN_FRAMES else 0


def shorten_causes(error: BaseException) -> None:
    """Remove the kit's frames from an error's causes, and causes that are entirely in the kit."""
    visited = {id(error)}
    outer = error
    while (inner := outer.__cause__ or outer.__context__) is not None and id(inner) not in visited:
        visited.add(id(inner))
        if all(frame.f_code.co_filename.startswith(KIT) for frame, _ in walk_tb(inner.__traceback__)):
            outer.__cause__ = outer.__context__ = None
            return
        inner.__traceback__ = hide_kit_frames(inner.__traceback__)[0]
        outer = inner


def print_error(error: BaseException) -> None:
    """Print an error to stderr as Python does, without frames and causes in the kit."""
    add_hint(error)
    trace = TracebackException.from_exception(error)
    _shorten(trace)
    # The whole package, because nothing may have imported rclpy._rclpy_pybind11 yet.
    module = sys.modules.get(type(error).__module__.partition(".")[0])
    is_of_standin = str(getattr(module, "__file__", "")).startswith(os.path.join(KIT, "ros", "standin", ""))
    # An error of the kit or the stand-in, like a wrong argument of one of the kit's programs, needs
    # no traceback unless a line of the user's code has caused it.
    if (isinstance(error, CourseError) or is_of_standin) and not line_of_traceback(error.__traceback__):
        sys.stderr.write("".join(trace.format_exception_only()).replace(f"{CourseError.__module__}.", ""))
        return
    sys.stderr.write("".join(trace.format()))


def print_error_of_thread(args: threading.ExceptHookArgs) -> None:
    """Print the error that ended a thread, as `threading.excepthook` does."""
    if args.exc_value is not None and not isinstance(args.exc_value, SystemExit):
        name = args.thread.name if args.thread else "unknown"
        sys.stderr.write(f"Exception in thread {name}:\n")
        print_error(args.exc_value)


def _shorten(trace: TracebackException) -> None:
    own_frames = [frame for frame in trace.stack if not frame.filename.startswith(_HIDDEN)]
    # A syntax error contains its file and line; any other error without a line of the user's code
    # needs all frames.
    trace.stack = _AbbreviatedStack(
        own_frames if own_frames or trace.exc_type is SyntaxError else trace.stack
    )
    for name in ("__cause__", "__context__"):
        inner: TracebackException | None = getattr(trace, name)
        if inner is not None and all(frame.filename.startswith(KIT) for frame in inner.stack):
            setattr(trace, name, None)
        elif inner is not None:
            _shorten(inner)


def line_of_traceback(trace: TracebackType | None) -> str:
    """Return the innermost line of the student's code: "cell In[3], line 2: 1 / 0", or ""."""
    return _innermost_own_line((frame.f_code.co_filename, line) for frame, line in walk_tb(trace))


def loop_of_traceback(trace: TracebackType | None) -> str:
    """Return the line of the loop that the student's code was executing, else the innermost line, or "".

    The line at which an endless loop is interrupted is a matter of chance. A `while` loop is
    preferred to a `for` loop, which rarely is the endless one, and an inner loop to an outer one.
    """
    while_loops: list[tuple[str, int]] = []
    for_loops: list[tuple[str, int]] = []
    for frame, line in walk_tb(trace):
        code = frame.f_code
        if not is_student_file(code.co_filename):
            continue
        # A file that changed in the meantime may not be Python.
        with contextlib.suppress(SyntaxError):
            tree = ast.parse("".join(linecache.getlines(code.co_filename)))
            # Inner loops follow outer ones.
            for node in ast.walk(tree):
                if isinstance(node, ast.While | ast.For):
                    is_running = code.co_firstlineno <= node.lineno <= line <= (node.end_lineno or line)
                    loops = while_loops if isinstance(node, ast.While) else for_loops
                    loops += [(code.co_filename, node.lineno)] * is_running
    places = while_loops or for_loops
    return format_location(*places[-1]) if places else line_of_traceback(trace)


def line_of_thread(ident: int) -> str:
    """Return the line of the student's code that a thread is executing, or ""."""
    frame = sys._current_frames().get(ident)
    stack = [(frame.f_code.co_filename, line) for frame, line in walk_stack(frame)] if frame else []
    return _innermost_own_line(reversed(stack))


def is_importing(ident: int) -> bool:
    """Return whether a thread is importing a library's module, which may take seconds."""
    for frame, _ in walk_stack(sys._current_frames().get(ident)):
        if is_student_file(frame.f_code.co_filename):
            return False
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
    return False


def format_location(filename: str, line: int) -> str:
    """Return the description of a line, with its text.

    Cells have the names that IPython gives them.
    """
    code = linecache.getline(filename, line).strip()
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    cell = shell.compile.format_code_name(filename) if shell is not None else None
    prefix = f"{Path(filename).name}, " if filename and not filename.startswith("<") else ""
    if cell is not None:
        prefix = f"{cell[0].lower()} {cell[1]}, "
    return f"{prefix}line {line}{code and f': {code}'}"


def _innermost_own_line(places: Iterable[tuple[str, int | None]]) -> str:
    own_places = [(name, line) for name, line in places if line and is_student_file(name)]
    return format_location(*own_places[-1]) if own_places else ""


@contextlib.contextmanager
def explain_interrupts(why: Callable[[], str]) -> Iterator[None]:
    """Print the program's line and `why()` if the end of the run or Ctrl+C interrupts the `with` block.

    It prints nothing if `why()` is empty. In a notebook the traceback shows the line.
    """
    try:
        yield
    except KeyboardInterrupt:
        describe_interruption(why())
        raise


@dataclass
class _ExplainedThreads:
    """The threads of a program whose interruption has been explained."""

    idents: set[int] = field(default_factory=set)


def was_explained() -> bool:
    """Return whether the interruption of the calling thread has been explained."""
    return threading.get_ident() in current_graph().state(_ExplainedThreads).idents


def describe_interruption(reason: str, line: str = "") -> None:
    """Print a hint with a line of the student, by default the calling thread's current line.

    It prints nothing if the reason is empty, if an inner wait has been explained, or in a notebook,
    whose traceback shows the line.
    """
    ident, graph = threading.get_ident(), current_graph()
    explained = graph.state(_ExplainedThreads).idents
    if reason and not graph.notebook and ident not in explained:
        explained.add(ident)
        place = line or line_of_thread(ident) or "a wait"
        print_notice(f"hint: interrupted in {place.rstrip(':')}: {reason}")
