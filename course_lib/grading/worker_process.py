"""The grader's end of a worker: starts it, talks to it, reads what it prints."""

import os
import shutil
import signal
import site
import socket
import subprocess
import sys
import tempfile
import threading
from contextlib import suppress
from pathlib import Path
from select import select
from typing import IO

from course_lib.errors import CourseError
from course_lib.ros import wall
from course_lib.ros.channel import Channel

PIPE_HOLDS = 2**20  # [B] at least as much as a pipe does
LAST_WORDS = 2.0  # [s]
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
    """A worker as the grader has it, until it is closed.

    Args:
        output_limit: How much of the output of a step is kept, [B].

    Raises:
        CourseError: This system has no fork (native Windows).
    """

    def __init__(self, output_limit: int) -> None:
        if not hasattr(os, "fork"):
            raise CourseError("grading needs Linux, macOS or WSL2: this system can't fork a process")
        self._scratch = Path(tempfile.mkdtemp(prefix="course_worker_"))
        ours, theirs = socket.socketpair()
        with theirs:
            self._process = start_worker(theirs, self._scratch)
        self.channel = Channel(ours)
        assert self._process.stdout is not None  # it was asked for as a pipe
        self._output = Output(self._process.stdout, output_limit)

    def allow(self, seconds: float) -> None:
        """What it says must come within so many [s] of the wall clock, or the channel's timeout is raised."""
        self.channel.deadline = wall.monotonic() + seconds

    def take_output(self) -> str:
        """What was printed since the last call."""
        return self._output.take()

    def last_words(self) -> str:
        """What it printed before it ended by itself."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(LAST_WORDS)
        return self.take_output()

    def close(self) -> None:
        """Kill the worker with all that it has started, and remove its scratch folder."""
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self.channel.close()
        self._output.close()
        shutil.rmtree(self._scratch, ignore_errors=True)


class Output:
    """Reads a pipe all the time, so that a flood can't block, and keeps the beginning of each step."""

    def __init__(self, pipe: IO[bytes], limit: int) -> None:
        self._pipe, self._limit = pipe, limit
        self._kept, self._cut, self._over = bytearray(), False, False
        self._lock = threading.Lock()
        os.set_blocking(pipe.fileno(), False)
        self._reader = threading.Thread(target=self._read_on, daemon=True)
        self._reader.start()

    def take(self) -> str:
        """The output of the step that has just ended: what it printed is in the pipe, if not yet here."""
        with self._lock:
            self._read()
            text = bytes(self._kept).decode("utf-8", "replace")
            text += f"\n… cut after {self._limit} bytes" if self._cut else ""
            self._kept, self._cut = bytearray(), False
        return text

    def close(self) -> None:
        """Stop reading; the process is dead."""
        self._over = True
        self._reader.join()
        self._pipe.close()

    def _read_on(self) -> None:
        while not self._over:
            if select([self._pipe], [], [], 0.1)[0]:
                with self._lock:
                    self._over = self._read() == 0 or self._over

    def _read(self) -> int | None:
        """How many bytes there were; 0 at the end of the pipe, None if there is nothing now."""
        try:
            chunk = os.read(self._pipe.fileno(), PIPE_HOLDS)
        except BlockingIOError:
            return None
        room = max(self._limit - len(self._kept), 0)
        self._kept += chunk[:room]
        self._cut = self._cut or len(chunk) > room
        return len(chunk)
