"""`course WORDS` in a fork of a process that has imported the kit, without 0.4 s of imports for each.

Everything from the command line to the end of the interpreter happens as in a new process. Tests of
the start itself, of signals and of long-running commands start `python -m course_lib` instead.
"""

import array
import gc
import json
import os
import runpy
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from tests.patience import PATIENCE
from tests.processes import LIMIT_OF_A_SESSION, Program

# Of `course run`; a process that is started with another one restarts itself.
HASH_SEED = "0"
# What every program imports. ROS's own names can be imported only after the start of a run.
PRELOADED = ("numpy.random", "course_lib.cli", "course_lib.recording", "course_lib.tools.run")
# Read by the interpreter when it starts: commands with other values need another process to fork.
FIXED = (
    "PYTHONPATH",
    "PYTHONWARNINGS",
    "PYTHONUTF8",
    "PYTHONIOENCODING",
    "PYTHONUNBUFFERED",
    "LANG",
    "LC_ALL",
)


class _Parent:
    """The process that is forked. It is started for the first command and ends with this process."""

    def __init__(self, fixed: Mapping[str, str]) -> None:
        others = {name: value for name, value in os.environ.items() if name not in FIXED}
        self._socket, its_socket = socket.socketpair()
        command = [sys.executable, "-P", str(Path(__file__)), str(its_socket.fileno())]
        Program(
            command,
            limit=LIMIT_OF_A_SESSION,
            cwd=Path(__file__).parents[1],
            env={**others, **fixed, "PYTHONHASHSEED": HASH_SEED},
            pass_fds=[its_socket.fileno()],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
        )
        its_socket.close()

    def run(self, request: dict[str, Any], streams: list[int], timeout: float) -> int:
        """Return the exit code of a command."""
        # The first command waits for the imports of the parent, which are not part of its time.
        self._socket.settimeout(PATIENCE)
        text = json.dumps(request).encode()
        rights = (socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array("i", streams))
        self._socket.sendmsg([len(text).to_bytes(4, "big")], [rights])
        self._socket.sendall(text)
        pid = int.from_bytes(_receive(self._socket, 4), "big")
        self._socket.settimeout(timeout)
        try:
            code = int.from_bytes(_receive(self._socket, 4), "big", signed=True)
        except TimeoutError:
            os.kill(pid, signal.SIGKILL)
            self._socket.settimeout(PATIENCE)
            _receive(self._socket, 4)
            raise subprocess.TimeoutExpired(request["words"], timeout) from None
        return code


# By the ID of a process, and the variables of FIXED.
_parents: dict[tuple[int, tuple[tuple[str, str], ...]], _Parent] = {}


def run_course(
    *words: str | Path,
    cwd: Path | None = None,
    env: dict[str, str] | None = None,
    is_merged: bool = False,
    timeout: float = PATIENCE,
) -> subprocess.CompletedProcess[str]:
    """Run `course WORDS` to its end, as `subprocess.run` does with `capture_output` and `text`.

    Args:
        words: The command line.
        cwd: The working folder.
        env: Variables that differ from those of this process.
        is_merged: Whether errors are part of the output.
        timeout: How long the command may run, [s].
    """
    environment = {**os.environ, **(env or {})}
    command = list(map(str, words))
    if sys.platform != "linux":
        start = [sys.executable, "-m", "course_lib", *command]
        return subprocess.run(
            start,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT if is_merged else subprocess.PIPE,
            text=True,
            cwd=cwd,
            env=environment,
            timeout=timeout,
        )
    # Earlier tests of the worker may have set them.
    fixed = {name: environment[name] for name in FIXED if name in environment}
    key = os.getpid(), tuple(fixed.items())
    parent = _parents.get(key) or _parents.setdefault(key, _Parent(fixed))
    request = {"words": command, "folder": str(cwd or Path.cwd()), "environment": environment}
    with (
        open(os.devnull, "rb") as nothing,
        tempfile.TemporaryFile() as output,
        tempfile.TemporaryFile() as errors,
    ):
        streams = [nothing.fileno(), output.fileno(), (output if is_merged else errors).fileno()]
        code = parent.run(request, streams, timeout)
        texts = []
        for file in (output, errors):
            file.seek(0)
            texts.append(file.read().decode("utf-8", "replace").replace("\r\n", "\n"))
    return subprocess.CompletedProcess(command, code, *texts)


def _receive(connection: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size and (part := connection.recv(size - len(data))):
        data += part
    return data


def _next_command(connection: socket.socket) -> dict[str, Any]:
    """Fork for each request. Returns in the child only, with its request."""
    while True:
        head, rights, _, _ = connection.recvmsg(4, socket.CMSG_SPACE(12))
        if not head:
            # The tests have ended.
            os._exit(0)
        streams = array.array("i", rights[0][2])
        request: dict[str, Any] = json.loads(_receive(connection, int.from_bytes(head, "big")))
        pid = os.fork()
        if pid == 0:
            connection.close()
            for place, file in enumerate(streams):
                os.dup2(file, place)
                os.close(file)
            return request
        for file in streams:
            os.close(file)
        connection.sendall(pid.to_bytes(4, "big"))
        _, status = os.waitpid(pid, 0)
        connection.sendall(os.waitstatus_to_exitcode(status).to_bytes(4, "big", signed=True))


def _become(request: dict[str, Any]) -> None:
    """Give this process the arguments, the folder and the environment of a new one."""
    os.environ.clear()
    os.environ.update(request["environment"])
    os.environ["PYTHONHASHSEED"] = HASH_SEED
    os.chdir(request["folder"])
    sys.argv = ["course", *request["words"]]


if __name__ == "__main__":
    for name in PRELOADED:
        import_module(name)
    for name in ("tests", "tests.patience", "tests.processes"):
        del sys.modules[name]
    gc.freeze()
    _become(_next_command(socket.socket(fileno=int(sys.argv[1]))))
    runpy.run_module("course_lib", run_name="__main__", alter_sys=True)
