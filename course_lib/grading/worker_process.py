"""The grader's end of a worker: starts it, limits it, reads what it prints."""

import os
import secrets
import shutil
import signal
import site
import socket
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import IO

from course_lib.errors import CourseError
from course_lib.ros.channel import Channel

TOKEN_BYTES = 16
OUTPUT_WAIT = 2.0  # [s] for the last of the output, once a step is over
THREADS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def start_worker(channel: socket.socket, scratch: Path) -> "subprocess.Popen[bytes]":
    """Start the process that runs a student's code: the one place where a jail goes around it.

    Args:
        channel: Its end of the socket pair.
        scratch: Its working folder and home, of its own.
    """
    places = dict.fromkeys(("HOME", "TMPDIR", "IPYTHONDIR", "MPLCONFIGDIR"), str(scratch))
    environment = {
        "PATH": os.defpath,
        "LANG": "C.UTF-8",
        "MPLBACKEND": "Agg",
        "PYTHONHASHSEED": "0",
        "PYTHONUSERBASE": site.getuserbase(),  # the kit may be installed there, and HOME is not the user's
    }
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "course_lib.grading.worker", str(channel.fileno())],
        env={**environment, **places, **THREADS},
        cwd=scratch,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        pass_fds=[channel.fileno()],
        start_new_session=True,
    )


class WorkerProcess:
    """A worker as the grader has it; a context manager that leaves no process behind.

    Args:
        output_limit: How much of the output of a step is kept, [B].

    Raises:
        CourseError: This system has no fork (native Windows).
    """

    def __init__(self, output_limit: int) -> None:
        if not hasattr(os, "fork"):
            raise CourseError("grading needs Linux, macOS or WSL2: this system can't fork a process")
        self.timed_out = False
        self.broken = False  # what it says can't be followed any more
        self._scratch = Path(tempfile.mkdtemp(prefix="course_worker_"))
        ours, theirs = socket.socketpair()
        with theirs:
            self._process = start_worker(theirs, self._scratch)
        self.channel = Channel(ours)
        assert self._process.stdout is not None  # it was asked for as a pipe
        self._output = Output(self._process.stdout, output_limit)

    def new_token(self) -> bytes:
        """What the worker is to print when the next step is over."""
        return self._output.new_token()

    def take_output(self) -> str:
        """What was printed since the last call."""
        return self._output.take()

    @contextmanager
    def limited(self, seconds: float) -> Iterator[None]:
        """Kill the worker if the block lasts longer than `seconds` of the wall clock."""
        timer = threading.Timer(max(seconds, 0.0), self._time_is_over)
        timer.start()
        try:
            yield
        finally:
            timer.cancel()

    def close(self) -> None:
        """Kill the worker with all that it has started, and remove its scratch folder."""
        self._kill()
        self._process.wait()
        self.channel.close()
        self._output.close()
        shutil.rmtree(self._scratch, ignore_errors=True)

    def _time_is_over(self) -> None:
        self.timed_out = True
        self._kill()

    def _kill(self) -> None:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)

    def __enter__(self) -> "WorkerProcess":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        self.close()


class Output:
    """Reads a pipe to its end, so that a flood can't block, and keeps the beginning of each step."""

    def __init__(self, pipe: IO[bytes], limit: int) -> None:
        self._pipe, self._limit = pipe, limit
        self._kept, self._tail, self._cut, self._ended = bytearray(), b"", False, False
        self._token = b""
        self._changed = threading.Condition()
        threading.Thread(target=self._read, daemon=True).start()

    def new_token(self) -> bytes:
        """Make the mark of the end of the next step: the student's code can't guess it."""
        self._token = secrets.token_bytes(TOKEN_BYTES)
        return self._token

    def take(self) -> str:
        """The output of the step that has just ended."""
        with self._changed:
            self._changed.wait_for(lambda: self._ended or self._tail == self._token, OUTPUT_WAIT)
            text = bytes(self._kept).removesuffix(self._token).decode("utf-8", "replace")
            text += f"\n… cut after {self._limit} bytes" if self._cut else ""
            self._kept, self._cut = bytearray(), False
        return text

    def close(self) -> None:
        """Stop reading; the process is dead."""
        with self._changed:
            self._changed.wait_for(lambda: self._ended, OUTPUT_WAIT)
        self._pipe.close()

    def _read(self) -> None:
        with suppress(OSError, ValueError):
            while chunk := os.read(self._pipe.fileno(), 2**16):
                with self._changed:
                    room = self._limit - len(self._kept)
                    self._kept += chunk[: max(room, 0)]
                    self._tail = (self._tail + chunk)[-TOKEN_BYTES:]
                    self._cut = self._cut or len(chunk) - TOKEN_BYTES > room
                    self._changed.notify_all()
        with self._changed:
            self._ended = True
            self._changed.notify_all()
