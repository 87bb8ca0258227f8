"""The output of a launch's processes: each line behind the name of its process, `[talker-1] `."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from course_lib.ros.graph import program

Hear = Callable[[str, int, str], object]  # a process, its stream (1 is standard output, 2 the other), lines


class Prefixes:
    """The names of processes, by the program that runs in them, and the lines that they have not ended.

    `hear` gets what they write, in whole lines.
    """

    def __init__(self, hear: Hear) -> None:
        self.by_program: dict[str, str] = {}
        self._hear = hear
        self._streams: list[_Prefixed] = []

    @contextmanager
    def shown(self) -> Iterator[None]:
        """Prefix what the processes write within a `with` block."""
        former = sys.stdout, sys.stderr
        hears = [partial(self._hear_program, number) for number in (1, 2)]
        self._streams = [
            _Prefixed(stream, self.by_program, hear) for stream, hear in zip(former, hears, strict=True)
        ]
        sys.stdout, sys.stderr = self._streams
        try:
            yield
        finally:
            if [sys.stdout, sys.stderr] == self._streams:  # else another launch began meanwhile
                sys.stdout, sys.stderr = former

    def _hear_program(self, number: int, name: str, text: str) -> None:
        self._hear(self.by_program[name], number, text)

    @contextmanager
    def behind(self, process: str) -> Iterator[None]:
        """Prefix what the calling program writes within a `with` block."""
        self.by_program[program.name] = process
        try:
            yield
        finally:
            for stream in self._streams:
                stream.end(program.name)


class _Prefixed:
    """A stream that holds back lines of processes until they are complete, as launch does."""

    def __init__(self, stream: Any, by_program: dict[str, str], hear: Callable[[str, str], object]) -> None:
        self._stream, self._by_program, self._hear = stream, by_program, hear
        self._begun: dict[str, str] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write text; that of a process line by line, behind its name."""
        if program.name not in self._by_program:
            return int(self._stream.write(text))
        *lines, rest = (self._begun.get(program.name, "") + text).split("\n")
        self._begun[program.name] = rest
        if lines:
            self._pass_on(program.name, lines)
        return len(text)

    def _pass_on(self, name: str, lines: list[str]) -> None:
        process = self._by_program[name]
        self._stream.write("".join(f"[{process}] {line}\n" for line in lines))
        self._hear(name, "".join(f"{line}\n" for line in lines))

    def writelines(self, lines: list[str]) -> None:
        """Write each of the lines."""
        self.write("".join(lines))

    def end(self, name: str) -> None:
        """Write the line that a program has begun and not ended."""
        rest = self._begun.pop(name, "")
        if rest:
            self._pass_on(name, [rest])
