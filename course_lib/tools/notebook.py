"""The magics `%ros2 …`, `%timeout 5 ros2 …` and `%rqt …` of a notebook, and short tracebacks."""

import re
import shlex
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, redirect_stdout, suppress
from functools import partial
from io import StringIO, TextIOBase
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.hints import add_hint
from course_lib.ros.time.time_lock import time_lock
from course_lib.ros.tracebacks import hide_kit_frames, line_of_traceback, shorten_causes
from course_lib.tools.resume import line_that_defines
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource
from course_lib.tools.verb import Write

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

# Every machine has one of these shells, except the sandbox in which notebooks are graded.
SHELLS = ("sh", "cmd")
_QUOTED = r""""(?:\\.|[^"\\])*"|'[^']*'|\\."""
# Quoted strings, and the separators of a command line.
_PARTS = re.compile(rf"{_QUOTED}|(>>|>|\||&+|;)")
# Redirections of standard error. They have no effect here, because errors are raised.
_ERRORS = re.compile(rf"{_QUOTED}|((?<!\S)2>(?:&1|>?\s*[^\s|>&;]+))")

# The beginning of a shell command that sources one or more workspaces.
_SOURCED = re.compile(r"^\s*(?:(?:source|\.)\s+[^\s;&|]*setup\.(?:ba|z)?sh\s*(?:&&|;)\s*)+")


def split(line: str) -> tuple[list[list[str]], tuple[str, Path] | None]:
    """Split a line into the commands between `|`, and the mode and path of the file after `>` or `>>`.

    Raises:
        CourseError: A side of `|` or `>` is empty, or the line uses other syntax of a shell.
        ValueError: A quotation mark is not closed.
    """
    line = _ERRORS.sub(lambda match: "" if match[1] else match[0], line)
    segments, signs, segment_start = [], [], 0
    for match in _PARTS.finditer(line):
        if match[1]:
            segments.append(line[segment_start : match.start()])
            signs.append(match[1])
            segment_start = match.end()
    for sign in signs:
        if sign[0] in "&;":
            raise CourseError(
                f"A line holds one command, without {sign}. Write each command on a line of its "
                "own, and start programs that keep running with run_live or %ros2 launch."
            )
    commands = [shlex.split(segment) for segment in (*segments, line[segment_start:])]
    if signs and not all(commands):
        raise CourseError(
            f"A command or a file is missing next to {' or '.join(sorted(set(signs)))}: ros2 {line.strip()}"
        )
    arrows = [sign for sign in signs if sign != "|"]
    if not arrows:
        return commands, None
    (file, *more) = commands.pop()
    if signs[-1] == "|" or arrows[1:] or more:
        raise CourseError(f"Redirect to one file, at the end: ros2 topic list > topics.txt, not: ros2 {line}")
    return commands, ("a" if arrows == [">>"] else "w", Path(file).expanduser())


def run_pipeline(line: str, ros2: Callable[[Sequence[str], Write], None], write: Write) -> None:
    """Run a command line without its `ros2`. `write` receives the output of the last command.

    Raises:
        CourseError: A program of the pipeline does not exist, or the line is invalid.
        ValueError: A quotation mark is not closed.
    """
    (arguments, *filters), target = split(line)
    # For example: ros2 topic type /chatter | ros2 interface show -
    if filters and filters[0][0] == "ros2":
        output: list[str] = []
        ros2(arguments, output.append)
        arguments = [
            "".join(output).strip() if argument == "-" else argument for argument in filters.pop(0)[1:]
        ]
    with ExitStack() as stack:
        if target is not None:
            write = stack.enter_context(target[1].open(target[0], encoding="utf-8")).write
        try:
            write = stack.enter_context(pipe_through(filters, write)) if filters else write
        # Programs cannot be started during grading.
        except PermissionError:
            write(f"Programs cannot be started here. The input of {filters[0][0]} would be:\n")
        # A program prints to standard output itself.
        if arguments[:1] == ["run"] and (filters or target):
            stack.enter_context(redirect_stdout(_CallbackStream(write)))
        # A program like `head` may close the pipe early.
        with suppress(BrokenPipeError):
            ros2(arguments, write)


class _CallbackStream(TextIOBase):
    """A stream whose text is passed to a function."""

    def __init__(self, pass_on: Write) -> None:
        self._pass_on = pass_on

    def write(self, text: str) -> int:
        """Pass the text to the function."""
        self._pass_on(text)
        return len(text)


@contextmanager
def pipe_through(commands: Sequence[Sequence[str]], write: Write) -> Iterator[Write]:
    """Start commands as a pipeline and provide a function that writes to the input of the first.

    The output of the last command is written as soon as it is available. Raises a CourseError if a
    program does not exist, and a PermissionError where programs cannot be started.
    """
    if not any(map(shutil.which, SHELLS)):
        raise PermissionError("no programs in this root")
    for name in (command[0] for command in commands if shutil.which(command[0]) is None):
        raise CourseError(f"There is no program {name} on this machine: leave out `| {name} …`.")
    running: list[subprocess.Popen[bytes]] = []
    with ExitStack() as stack:
        result = Path(stack.enter_context(TemporaryDirectory()), "result")
        captured, output = stack.enter_context(result.open("a+b")), stack.enter_context(result.open("ab"))
        stack.callback(_end, running)
        for command in commands:
            # Line buffering, as in a terminal.
            line_buffered = ["stdbuf", "-oL"] if shutil.which("stdbuf") else []
            source = running[-1].stdout if running else subprocess.PIPE
            process = subprocess.Popen(
                [*line_buffered, *command],
                stdin=source,
                stdout=output if command is commands[-1] else subprocess.PIPE,
                stderr=output,
                # In its own session, so that ■ does not interrupt it.
                start_new_session=True,
            )
            running.append(process)
            if source and not isinstance(source, int):
                # From now on only the new process reads from the pipe.
                source.close()
        input_stream = running[0].stdin
        # The process was started with a pipe as its standard input.
        assert input_stream is not None

        def feed(text: str) -> None:
            input_stream.write(text.encode())
            input_stream.flush()
            write(captured.read().decode(errors="replace"))

        try:
            yield feed
        finally:
            with suppress(BrokenPipeError):
                input_stream.close()
            for process in running:
                process.wait()
            write(captured.read().decode(errors="replace"))


def _end(running: Sequence[subprocess.Popen[bytes]]) -> None:
    """Kill the programs that still run after a second ■."""
    for process in running:
        process.kill()
        process.wait()


def register(shell: "InteractiveShell") -> None:
    """Register the magics. Calling it again has no effect."""
    # Braces belong to YAML, so IPython must not expand them.
    from IPython.core.magic import no_var_expand

    shell.register_magic_function(no_var_expand(ros2_magic), "line", "ros2")  # type: ignore[arg-type]  # wrongly typed there
    shell.register_magic_function(rqt_magic, "line", "rqt")  # type: ignore[arg-type]  # as above
    shell.register_magic_function(rviz2_magic, "line", "rviz2")  # type: ignore[arg-type]  # as above
    shell.register_magic_function(check_magic, "line", "check")  # type: ignore[arg-type]  # as above
    catch_shell(shell)
    shell.register_magic_function(no_var_expand(timeout_magic), "line", "timeout")  # type: ignore[arg-type]  # as above


def ros2_magic(line: str, *, interrupted: bool = False) -> None:
    """Run a `ros2` command on this notebook's nodes, like %ros2 topic list | grep image.

    Args:
        line: The command without its `ros2`.
        interrupted: Whether the caller interrupts an endless command, so that it may run without a
            page.
    """
    from IPython.core.error import UsageError

    source = GraphSource(current_graph(), interrupted=interrupted)

    def run(arguments: Sequence[str], write: Write) -> None:
        ros2(arguments, source, write)

    try:
        run_pipeline(line, run, sys.stdout.write)
    # An open quotation mark, a missing file or a missing program.
    except (CourseError, ValueError, OSError) as error:
        raise UsageError(str(error)) from None


def timeout_magic(line: str) -> None:
    """Run a `ros2` command and interrupt it, as ■ does, after a number of seconds of robot time.

    It sends no signal, because `course run` counts signals as the user's Ctrl+C, and rclpy shuts
    down.
    """
    from IPython.core.error import UsageError

    match = re.fullmatch(r"([\d.]+)s?\s+ros2\s+(.+)", line.strip())
    if not match or match[1].count(".") > 1:
        raise UsageError(
            f"%timeout {line}: write the seconds, then the command: %timeout 5 ros2 topic hz /scan"
        )
    graph, thread = current_graph(), threading.current_thread()
    due_ns = graph.now_ns + round(float(match[1]) * 1e9)
    alarm = graph.call_at(due_ns, lambda: time_lock.interrupt(thread), node=0, entity=0)
    try:
        ros2_magic(match[2], interrupted=True)
    finally:
        alarm.cancel()


def rqt_magic(line: str) -> None:
    """Show a view of this notebook's nodes, like %rqt graph."""
    from IPython.core.error import UsageError

    from course_lib.tools.rqt.rqt import rqt

    try:
        rqt(shlex.split(line))
    # A ValueError means an open quotation mark.
    except (CourseError, ValueError) as error:
        raise UsageError(str(error)) from None


def rviz2_magic(line: str) -> None:
    """Print how to show RViz's view in a notebook. `line` contains the arguments of `rviz2`."""
    arguments = line.split()
    layout = arguments[arguments.index("-d") + 1] if "-d" in arguments[:-1] else None
    call = "Viewer()" if layout is None else f"Viewer.from_rviz({layout!r})"
    sys.stderr.write(
        f"There is no window here. A cell shows the view: from course_lib import Viewer; viewer = {call}; "
        "viewer\n"
    )


def check_magic(line: str) -> None:
    """Print the call of `check` for a student who types %check week01.red_cube RedCube."""
    from IPython.core.error import UsageError

    words = re.findall(r"[\w.]+", line)
    task, answer = words[:2] if len(words) > 1 else ("week01.red_cube", "RedCube")
    raise UsageError(f'check is a function: write check("{task}", {answer}), without the %.')


def catch_shell(shell: "InteractiveShell") -> None:
    """Run `!ros2 …` and `x = !ros2 …` as %ros2, because a shell has no access to this notebook's nodes."""
    system: Callable[[str], Any] = shell.system
    getoutput: Callable[..., Any] = shell.getoutput
    if getattr(system, "__module__", "") == __name__:
        # The extension was loaded before.
        return

    def run(command: str) -> Any:
        magic = _magic_for(command)
        return magic() if magic else system(command)

    def capture_output(command: str, *args: Any, **settings: Any) -> Any:
        magic = _magic_for(command)
        if magic is None:
            return getoutput(command, *args, **settings)
        from IPython.utils.text import SList

        with redirect_stdout(StringIO()) as output:
            magic()
        return SList(output.getvalue().splitlines())

    vars(shell).update(system=run, getoutput=capture_output)
    for name in ("bash", "sh"):
        shell.register_magic_function(partial(_script, shell, name), "cell", name)  # type: ignore[arg-type]  # as above


def _script(shell: "InteractiveShell", program: str, line: str, cell: str) -> Any:
    """Run a cell of shell script. If it calls `ros2`, first print a hint about the magic."""
    match = re.search(r"^\s*((?:timeout\s+\S+\s+)?ros2\s.+)", cell, re.MULTILINE)
    if match:
        sys.stderr.write(f"A shell can't see this notebook's nodes. In a cell write %{match[1].strip()}\n")
    # IPython's own %%bash does the same. It is looked up here, not earlier, because IPython then
    # imports its script magics, which would take most of the time of `%load_ext course_lib`.
    script = shell.find_cell_magic("script")
    return script(f"{program} {line}", cell)


def _magic_for(command: str) -> Callable[[], None] | None:
    """Return the magic that replaces a shell command, or None."""
    # Programs find their workspace without `source install/setup.bash`.
    command = _SOURCED.sub("", command)
    if command.split()[:1] == ["rviz2"]:
        return partial(rviz2_magic, command.partition("rviz2")[2])
    # In ROS, `rqt_graph` is a separate program.
    command = re.sub(r"^\s*rqt_(?=\w)", "rqt ", command)
    match = re.fullmatch(r"\s*(ros2|rqt|timeout(?=\s+\S+\s+ros2\s))\b(.*)", command, re.DOTALL)
    if match is None:
        return None
    name, line = match[1], match[2].strip()
    sys.stderr.write(f"In a notebook write %{name} {line}\n")
    return partial({"ros2": ros2_magic, "rqt": rqt_magic, "timeout": timeout_magic}[name], line)


def shorten_tracebacks(shell: "InteractiveShell") -> None:
    """Hide the kit's frames in tracebacks, and print CourseError and interrupts as one line."""
    shell.set_custom_exc((Exception, KeyboardInterrupt), _show_error)
    format_syntax_error = shell.SyntaxTB.structured_traceback

    # IPython passes some syntax errors to no handler, like a wrong indentation.
    def format_with_hint(
        kind: type[BaseException],
        error: BaseException,
        *args: Any,
        **options: Any,
    ) -> Any:
        add_hint(error)
        return format_syntax_error(kind, error, *args, **options)

    setattr(shell.SyntaxTB, "structured_traceback", format_with_hint)  # noqa: B010 - mypy rejects a method


def _show_error(
    shell: Any,
    kind: type[BaseException],
    error: BaseException,
    trace: TracebackType,
    tb_offset: int | None = None,
) -> list[str]:
    if isinstance(error, CourseError):
        shell.showtraceback((kind, error, trace))
    elif isinstance(error, KeyboardInterrupt):
        line = line_of_traceback(trace)
        message = str(error) or f"the cell was stopped{line and f' in {line}'}."
        shell._showtraceback(kind, error, [f"{kind.__name__}: {message}"])
    else:
        if isinstance(error, NameError) and (line := line_that_defines(shell, error.name or "")):
            error.add_note(f"hint: a cell above has {line!r}: run it first.")
        add_hint(error)
        own_trace, hidden_count = hide_kit_frames(trace)
        shorten_causes(error)
        if hidden_count:
            error.add_note(f"({hidden_count} frames in the middle are not shown)")
        shell.showtraceback((kind, error, own_trace), tb_offset=tb_offset)
    return []
