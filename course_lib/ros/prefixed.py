"""The output of a launch's processes: each line behind the name of its process, `[talker-1] `."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from course_lib.ros.graph import program


class Prefixes:
    """The names of processes, by the program that runs in them, and the lines that they have not ended."""

    def __init__(self) -> None:
        self.by_program: dict[str, str] = {}
        self._streams: list[_Prefixed] = []

    @contextmanager
    def shown(self) -> Iterator[None]:
        """Prefix what the processes write within a `with` block."""
        former = sys.stdout, sys.stderr
        self._streams = [_Prefixed(stream, self.by_program) for stream in former]
        sys.stdout, sys.stderr = self._streams
        try:
            yield
        finally:
            if [sys.stdout, sys.stderr] == self._streams:  # else another launch began meanwhile
                sys.stdout, sys.stderr = former

    @contextmanager
    def behind(self, process: str) -> Iterator[None]:
        """Prefix what the calling program writes within a `with` block."""
        self.by_program[program.name] = f"[{process}] "
        try:
            yield
        finally:
            for stream in self._streams:
                stream.end(program.name)


class _Prefixed:
    """A stream that holds back lines of processes until they are complete, as launch does."""

    def __init__(self, stream: Any, by_program: dict[str, str]) -> None:
        self._stream, self._by_program = stream, by_program
        self._begun: dict[str, str] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write text; that of a process line by line, behind its name."""
        prefix = self._by_program.get(program.name)
        if prefix is None:
            return int(self._stream.write(text))
        *lines, rest = (self._begun.get(program.name, "") + text).split("\n")
        self._begun[program.name] = rest
        if lines:
            self._stream.write("".join(f"{prefix}{line}\n" for line in lines))
        return len(text)

    def writelines(self, lines: list[str]) -> None:
        """Write each of the lines."""
        self.write("".join(lines))

    def end(self, name: str) -> None:
        """Write the line that a program has begun and not ended."""
        rest = self._begun.pop(name, "")
        if rest:
            self._stream.write(f"{self._by_program[name]}{rest}\n")
