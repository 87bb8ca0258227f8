"""Programs that tests start, with time limits; all are killed at the end of their test."""

import _thread
import atexit
import re
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import psutil

LIMIT = 300.0  # [s]
LIMIT_OF_A_SERVER = 1800.0  # [s], of one that serves all tests of a file
# [s], of one that serves the files of a folder, which take half an hour on a busy machine
LIMIT_OF_A_SESSION = 24 * 3600.0


class Program(subprocess.Popen[str]):
    """A process whose pipes carry text. The end of a `with` block kills it together with its children.

    A process that runs longer than its limit is killed, too. That ends every wait for it:
    `readline` returns an empty string, `wait` and `communicate` raise `TimeoutExpired`.

    Args:
        command: The program and its arguments.
        limit: How long the process may run, [s].
        options: Of `subprocess.Popen`.
    """

    def __init__(self, command: Sequence[str | Path], *, limit: float = LIMIT, **options: Any) -> None:
        self._limit, self._is_overdue = limit, False
        self._ended = _thread.allocate_lock()
        self._ended.acquire()
        super().__init__(command, text=True, **options)
        atexit.register(self.kill_tree)
        # A test may replace the threads and locks of `threading` by ones in virtual time.
        _thread.start_new_thread(self._watch, ())

    def _watch(self) -> None:
        if not self._ended.acquire(timeout=self._limit):
            self._is_overdue = True
            self.kill_tree()

    def kill_tree(self) -> None:
        """Kill the process and all processes below it."""
        if self.poll() is not None:
            return
        with suppress(psutil.NoSuchProcess):
            for process in psutil.Process(self.pid).children(recursive=True):
                with suppress(psutil.NoSuchProcess):
                    process.kill()
        self.kill()

    def wait(self, timeout: float | None = None) -> int:
        """Wait for the end of the process; raise `TimeoutExpired` if it was killed at its limit."""
        code = super().wait(timeout)
        atexit.unregister(self.kill_tree)
        if self._ended.locked():
            self._ended.release()
        if self._is_overdue:
            raise subprocess.TimeoutExpired(self.args, self._limit)
        return code

    def __exit__(self, *raised: Any) -> None:
        self.kill_tree()
        super().__exit__(*raised)

    def read_line(self) -> str:
        """Return the next line of the output, or an empty string at its end."""
        assert self.stdout is not None
        return self.stdout.readline()

    def find(self, pattern: str) -> str:
        """Return the first match of a pattern in the following lines of the output."""
        read = ""
        while line := self.read_line():
            read += line
            if found := re.search(pattern, line):
                return found[0]
        raise AssertionError(f"no {pattern!r} in {read!r}")
