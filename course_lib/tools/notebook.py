"""`%ros2 …`, `%timeout 5 ros2 …` and `%rqt …` in a notebook, and short tracebacks."""

import re
import shlex
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from functools import partial
from io import StringIO
from types import TracebackType
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from course_lib.ros.hints import add_hint
from course_lib.ros.tracebacks import line_of_traceback, shorten_causes, without_the_kit
from course_lib.tools.pipes import run_piped
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource
from course_lib.tools.verb import Write

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell


def register(shell: "InteractiveShell") -> None:
    """Register the magics; a second call changes nothing."""
    from IPython.core.magic import no_var_expand  # braces are YAML's

    shell.register_magic_function(no_var_expand(ros2_magic), "line", "ros2")  # type: ignore[arg-type]  # wrongly typed there
    shell.register_magic_function(rqt_magic, "line", "rqt")  # type: ignore[arg-type]  # as above
    catch_shell(shell)
    shell.register_magic_function(no_var_expand(timeout_magic), "line", "timeout")  # type: ignore[arg-type]  # as above


def ros2_magic(line: str, *, interrupted: bool = False) -> None:
    """Run a `ros2` command on this notebook's nodes, like %ros2 topic list | grep image.

    Args:
        line: The command without its `ros2`.
        interrupted: Whether the caller ends an endless command, so that no page is needed for that.
    """
    from IPython.core.error import UsageError

    source = GraphSource(current_graph(), interrupted=interrupted)

    def run(words: Sequence[str], write: Write) -> None:
        ros2(words, source, write)

    try:
        run_piped(line, run, sys.stdout.write)
    except (CourseError, ValueError, OSError) as error:  # an open quotation mark; a file, a program
        raise UsageError(str(error)) from None


def timeout_magic(line: str) -> None:
    """Run a `ros2` command and interrupt it, as ■ does, after so many seconds of robot time.

    No signal is sent: `course run` counts those as the user's Ctrl+C, and rclpy shuts down at one.
    """
    from IPython.core.error import UsageError

    found = re.fullmatch(r"([\d.]+)s?\s+ros2\s+(.+)", line.strip())
    if not found or found[1].count(".") > 1:
        raise UsageError(
            f"%timeout {line}: write the seconds, then the command: %timeout 5 ros2 topic hz /scan"
        )
    graph, thread = current_graph(), threading.current_thread()
    due_ns = graph.now_ns + round(float(found[1]) * 1e9)
    alarm = graph.call_at(due_ns, lambda: baton.interrupt(thread), node=0, entity=0)
    try:
        ros2_magic(found[2], interrupted=True)
    finally:
        alarm.cancel()


def rqt_magic(line: str) -> None:
    """Show a view of this notebook's nodes, like %rqt graph."""
    from IPython.core.error import UsageError

    from course_lib.tools.rqt.rqt import rqt

    try:
        rqt(shlex.split(line))
    except (CourseError, ValueError) as error:  # an open quotation mark
        raise UsageError(str(error)) from None


def catch_shell(shell: "InteractiveShell") -> None:
    """Run `!ros2 …` and `x = !ros2 …` as %ros2: a shell has no access to this notebook's nodes."""
    system: Callable[[str], Any] = shell.system
    getoutput: Callable[..., Any] = shell.getoutput
    if getattr(system, "__module__", "") == __name__:
        return  # the extension was loaded before

    def run(command: str) -> Any:
        magic = _magic_for(command)
        return magic() if magic else system(command)

    def captured(command: str, *args: Any, **settings: Any) -> Any:
        magic = _magic_for(command)
        if magic is None:
            return getoutput(command, *args, **settings)
        from IPython.utils.text import SList

        with redirect_stdout(StringIO()) as written:
            magic()
        return SList(written.getvalue().splitlines())

    vars(shell).update(system=run, getoutput=captured)
    for name in ("bash", "sh"):
        if name in shell.magics_manager.magics["cell"]:
            known: Callable[[str, str], Any] = shell.magics_manager.magics["cell"][name]
            shell.register_magic_function(partial(_script, known), "cell", name)  # type: ignore[arg-type]  # as above


def _script(known: Callable[[str, str], Any], line: str, cell: str) -> Any:
    """Run a cell of shell script; where it calls `ros2`, name the magic first."""
    found = re.search(r"^\s*((?:timeout\s+\S+\s+)?ros2\s.+)", cell, re.MULTILINE)
    if found:
        sys.stderr.write(f"A shell can't see this notebook's nodes. In a cell write %{found[1].strip()}\n")
    return known(line, cell)


def _magic_for(command: str) -> Callable[[], None] | None:
    """Return the magic for a line that was meant for the shell, if one exists."""
    found = re.fullmatch(r"\s*(ros2|rqt|timeout(?=\s+\S+\s+ros2\s))\b(.*)", command, re.DOTALL)
    if found is None:
        return None
    name, line = found[1], found[2].strip()
    sys.stderr.write(f"In a notebook write %{name} {line}\n")
    return partial({"ros2": ros2_magic, "rqt": rqt_magic, "timeout": timeout_magic}[name], line)


def shorten_tracebacks(shell: "InteractiveShell") -> None:
    """Leave the kit's frames out of tracebacks; print CourseError and interrupts as one line."""
    shell.set_custom_exc((Exception, KeyboardInterrupt), _show_error)  # type: ignore[no-untyped-call]  # IPython does not annotate it


def _show_error(
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
        shorten_causes(error)
        if hidden:
            error.add_note(f"({hidden} frames in the middle are not shown)")
        shell.showtraceback((kind, error, own), tb_offset=tb_offset)
    return []
