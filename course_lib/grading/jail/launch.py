"""The grader's end of the template: starts it with as many layers around it as work here."""

import atexit
import json
import os
import shutil
import site
import socket
import subprocess
import sys
import tempfile
from collections.abc import Collection, Iterator
from contextlib import suppress
from dataclasses import asdict
from functools import cache
from pathlib import Path

import course_lib
from course_lib.course.course_file import Limits
from course_lib.errors import CourseError
from course_lib.grading.jail.isolation import Isolation
from course_lib.grading.usage import Usage

START_SECONDS = 60.0  # [s] for the template's imports on a busy machine
STOP_SECONDS = 60.0  # [s] for the end of a submission and its processes, which may be thousands
PIPE_HOLDS = 2**20  # [B] of a submission's output
NOBODY = 65534  # the user without files
SYSTEM = ("/usr", "/lib", "/lib64", "/bin", "/etc/ld.so.cache", "/etc/localtime", "/etc/fonts")
INSIDE = "/tmp/submission"  # the scratch folder in bubblewrap's files
BUBBLEWRAP = (
    "--die-with-parent --new-session --unshare-pid --unshare-net --unshare-ipc --unshare-uts "
    "--proc /proc --dev /dev --perms 1777 --tmpfs /tmp"
)
BECOME_ANOTHER = "--cap-drop ALL --cap-add CAP_SETUID --cap-add CAP_SETGID"
THREADS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class WorkerError(CourseError):
    """A worker does not even start: the kit's or the machine's fault, never the student's."""


class TemplateProcess:
    """A template, started with the most layers with which it comes up.

    Args:
        off: Layers that are not to be used, for tests of what is left.

    Raises:
        WorkerError: It does not start at all.
    """

    def __init__(self, off: Collection[str] = ()) -> None:
        if not hasattr(os, "fork"):
            raise WorkerError("grading needs Linux, macOS or WSL2: this system can't fork a process")
        said = ""
        for bubblewrap, user in _attempts(off):
            scratch = INSIDE if bubblewrap else tempfile.mkdtemp(prefix="course_worker_")
            self._control, theirs = socket.socketpair()
            with theirs:
                self._process = _start(theirs, scratch, bubblewrap, user, off)
            self._control.settimeout(START_SECONDS)
            answer = self._control.recv(2**16)
            if answer:
                self.isolation = Isolation((*["bubblewrap"] * bool(bubblewrap), *json.loads(answer)))
                return
            said = self._process.communicate()[0].decode("utf-8", "replace")
            self._control.close()
            if not bubblewrap:
                shutil.rmtree(scratch, ignore_errors=True)
        raise WorkerError(f"a worker can't be started: {said.strip()[-500:]}")

    def start(self, limits: Limits, imports: Collection[str]) -> tuple[socket.socket, int]:
        """Start a submission.

        Args:
            limits: What it may use.
            imports: Modules of ours that it will import, so that it finds them imported.

        Returns:
            This side's ends of its channel and of the pipe for its output.
        """
        ours, theirs = socket.socketpair()
        reader, writer = os.pipe()
        if sys.platform == "linux":
            import fcntl

            with suppress(OSError):  # only slower without
                fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, PIPE_HOLDS)
        with theirs:
            wanted = {"limits": asdict(limits), "imports": list(imports)}
            socket.send_fds(self._control, [json.dumps(wanted).encode()], [theirs.fileno(), writer])
        os.close(writer)
        return ours, reader

    @property
    def is_sound(self) -> bool:
        """Whether nobody has killed it."""
        return self._process.poll() in (None, 0)

    def stop(self) -> Usage:
        """End the submission with all that it has started; returns what it used."""
        try:
            self._control.settimeout(STOP_SECONDS)
            self._control.send(b"stop")
            return Usage(**json.loads(self._control.recv(200)))
        except (OSError, ValueError):  # nothing, or half an answer: it was killed
            self.close()
            return Usage()

    def close(self) -> None:
        """End the template."""
        self._control.close()
        try:
            self._process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()
        shared_template.cache_clear()


@cache
def shared_template() -> TemplateProcess:
    """The template of this process, started when it is first asked for."""
    template = TemplateProcess()
    atexit.register(template.close)
    return template


def _attempts(off: Collection[str]) -> Iterator[tuple[str | None, int | None]]:
    """Ways to start, from the most closed one: bubblewrap's path or none, and the user to become."""
    bubblewrap = shutil.which("bwrap") if "bubblewrap" not in off else None
    users = [NOBODY, None] if os.geteuid() == 0 and "process limit" not in off else [None]
    for program in dict.fromkeys((bubblewrap, None)):
        for user in users:
            yield program, user


def _start(
    control: socket.socket, scratch: str, bubblewrap: str | None, user: int | None, off: Collection[str]
) -> "subprocess.Popen[bytes]":
    environment = {
        "PATH": os.defpath,
        "LANG": "C.UTF-8",
        "MPLBACKEND": "Agg",
        "PYTHONHASHSEED": "0",
        "PYTHONPATH": str(Path(course_lib.__file__).parents[1]),  # this kit, whichever is installed
        "PYTHONUSERBASE": site.getuserbase(),  # the kit may be installed there, and HOME is not the user's
    }
    read = [path for path in _readable() if os.path.exists(path)]
    settings = {"control": control.fileno(), "scratch": scratch, "read": read, "off": list(off), "user": user}
    command = [sys.executable, "-P", "-m", "course_lib.grading.jail.template", json.dumps(settings)]
    if user is not None and not bubblewrap:
        os.chown(scratch, user, -1)
    return subprocess.Popen(
        [*(_bubblewrap(bubblewrap, read, user) if bubblewrap else ()), *command],
        env={**environment, **dict.fromkeys(("HOME", "IPYTHONDIR", "MPLCONFIGDIR"), scratch), **THREADS},
        cwd="/",
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        pass_fds=[control.fileno()],
        start_new_session=True,
    )


def _readable() -> list[str]:
    """What a submission may read: the system's programs, Python, its packages and the kit; no more."""
    kit = str(Path(course_lib.__file__).parent)
    return [*SYSTEM, sys.prefix, sys.base_prefix, site.getusersitepackages(), kit]


def _bubblewrap(program: str, read: Collection[str], user: int | None) -> list[str]:
    folders = dict.fromkeys(str(up) for path in read for up in reversed(Path(path).parents[:-1]))  # 0755 each
    files = [*(("--dir", folder) for folder in folders), *(("--ro-bind", path, path) for path in read)]
    become = BECOME_ANOTHER.split() if user is not None else []
    return [
        program, *BUBBLEWRAP.split(), *(word for words in files for word in words),
        "--perms", "0777", "--dir", INSIDE, *become, "--",
    ]  # fmt: skip
