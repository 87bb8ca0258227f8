"""Pipes and files behind a command, `%ros2 … | grep … > file`, without a shell."""

import re
import shlex
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, redirect_stdout, suppress
from io import TextIOBase
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO

from course_lib.errors import CourseError
from course_lib.tools.verb import Write

SHELLS = ("sh", "cmd")  # every machine has one of them; the root in which notebooks are graded has none
_QUOTED = r""""(?:\\.|[^"\\])*"|'[^']*'|\\."""
_PARTS = re.compile(rf"{_QUOTED}|(>>|>|\||&+|;)")  # what is quoted, and what parts a line
_ERRORS = re.compile(  # where a shell puts them; here they are raised
    rf"{_QUOTED}|((?<!\S)2>(?:&1|>?\s*[^\s|>&;]+))"
)


def split(line: str) -> tuple[list[list[str]], tuple[str, Path] | None]:
    """Split a line into the commands between `|`, and the mode and path of the file behind `>` or `>>`.

    Raises:
        CourseError: There is nothing on one side of `|` or `>`, or a sign is a shell's.
        ValueError: A quotation mark is not closed.
    """
    line = _ERRORS.sub(lambda found: "" if found[1] else found[0], line)
    pieces, signs, start = [], [], 0
    for found in _PARTS.finditer(line):
        if found[1]:
            pieces.append(line[start : found.start()])
            signs.append(found[1])
            start = found.end()
    for sign in signs:
        if sign[0] in "&;":
            raise CourseError(
                f"A line is one command, without {sign}: write each in a line of its own, and what goes on "
                "while the next cells run with run_live or %ros2 launch."
            )
    commands = [shlex.split(piece) for piece in (*pieces, line[start:])]
    if signs and not all(commands):
        raise CourseError(
            f"Something is missing beside {' or '.join(sorted(set(signs)))}: ros2 {line.strip()}"
        )
    arrows = [sign for sign in signs if sign != "|"]
    if not arrows:
        return commands, None
    (file, *more) = commands.pop()
    if signs[-1] == "|" or arrows[1:] or more:
        raise CourseError(f"Write one file, at the end: ros2 topic list > topics.txt, not: ros2 {line}")
    return commands, ("a" if arrows == [">>"] else "w", Path(file).expanduser())


def run_piped(line: str, ros2: Callable[[Sequence[str], Write], None], write: Write) -> None:
    """Run a command line without its `ros2`; `write` receives the output of the last command.

    Raises:
        CourseError: One of the tools is not there, or the line cannot be read.
        ValueError: A quotation mark is not closed.
    """
    (words, *filters), target = split(line)
    if filters and filters[0][0] == "ros2":  # ros2 topic type /chatter | ros2 interface show -
        told: list[str] = []
        ros2(words, told.append)
        words = ["".join(told).strip() if word == "-" else word for word in filters.pop(0)[1:]]
    with ExitStack() as stack:
        if target is not None:
            write = stack.enter_context(target[1].open(target[0], encoding="utf-8")).write
        try:
            write = stack.enter_context(through(filters, write)) if filters else write
        except PermissionError:  # as where notebooks are graded
            write(f"No program may be started here; this is what {filters[0][0]} would be given:\n")
        if words[:1] == ["run"] and (filters or target):  # a program prints by itself
            stack.enter_context(redirect_stdout(_Printed(write)))
        with suppress(BrokenPipeError):  # `head` has enough
            ros2(words, write)


class _Printed(TextIOBase):
    """A stream whose text is passed to a function."""

    def __init__(self, pass_on: Write) -> None:
        self._pass_on = pass_on

    def write(self, text: str) -> int:
        """Pass the text on."""
        self._pass_on(text)
        return len(text)


@contextmanager
def through(commands: Sequence[Sequence[str]], write: Write) -> Iterator[Write]:
    """Start commands as a pipeline; provides a function that writes to the first one's input.

    What comes out of the last one is passed on at once. Raises a CourseError if one is not there, and a
    PermissionError where no program is.
    """
    if not any(map(shutil.which, SHELLS)):
        raise PermissionError("no programs in this root")
    for name in (command[0] for command in commands if shutil.which(command[0]) is None):
        raise CourseError(f"There is no program {name} on this machine: leave out `| {name} …`.")
    running: list[subprocess.Popen[bytes]] = []
    with ExitStack() as stack:
        result = Path(stack.enter_context(TemporaryDirectory()), "result")
        come, out = stack.enter_context(result.open("a+b")), stack.enter_context(result.open("ab"))
        stack.callback(_end, running)
        for command in commands:
            _start(command, running, out if command is commands[-1] else subprocess.PIPE, out)
        first = running[0].stdin
        assert first is not None  # it is a pipe

        def feed(text: str) -> None:
            first.write(text.encode())
            first.flush()
            _pass_on(come, write)

        try:
            yield feed
        finally:
            with suppress(BrokenPipeError):
                first.close()
            for process in running:
                process.wait()
            _pass_on(come, write)


def _start(
    words: Sequence[str], running: list[subprocess.Popen[bytes]], out: IO[bytes] | int, errors: IO[bytes]
) -> None:
    """Start a program that reads from the last of the running ones."""
    at_once = ["stdbuf", "-oL"] if shutil.which("stdbuf") else []  # lines come as in a terminal
    source = running[-1].stdout if running else subprocess.PIPE
    started = subprocess.Popen(
        [*at_once, *words],
        stdin=source,
        stdout=out,
        stderr=errors,
        start_new_session=True,  # ■ is not for it
    )
    running.append(started)
    if source and not isinstance(source, int):
        source.close()  # now the new one alone holds it


def _end(running: Sequence[subprocess.Popen[bytes]]) -> None:
    """Kill the programs that still run after a second ■."""
    for process in running:
        process.kill()
        process.wait()


def _pass_on(out: IO[bytes], write: Write) -> None:
    """Write the text that has been appended to a file since the last call."""
    write(out.read().decode(errors="replace"))
