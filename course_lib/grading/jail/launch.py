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
from collections.abc import Collection
from contextlib import suppress
from dataclasses import asdict
from typing import Any

from course_lib.course.course_file import Limits
from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.grading.jail.isolation import Isolation
from course_lib.grading.jail.place import HOMES, INSIDE
from course_lib.grading.jail.readable import KIT, Readable, readable
from course_lib.grading.run.outcome import Usage

START_SECONDS = 60.0  # [s] for the template's imports on a busy machine
STOP_SECONDS = 60.0  # [s] for the end of a submission and its processes, which may be thousands
SIGNALLED = 128  # bubblewrap's status for a process that a signal ended, plus the signal's number
PIPE_HOLDS = 2**20  # [B] of a submission's output
BUBBLEWRAP = (
    "--die-with-parent --new-session --unshare-pid --unshare-net --unshare-ipc --unshare-uts "
    "--proc /proc --dev /dev --perms 0755 --tmpfs /submission"
)
BECOME_ANOTHER = "--cap-drop ALL --cap-add CAP_SETUID --cap-add CAP_SETGID"
THREADS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class WorkerError(CourseError):
    """A worker does not even start: the kit's or the machine's fault, never the student's."""


class KilledStartError(WorkerError):
    """A worker was killed while it started, which says nothing of what works here: try again."""


class TemplateProcess:
    """A template, started with the most layers with which it comes up.

    Args:
        off: Layers that are not to be used, for tests of what is left.
        refused: Paths of the course that no submission may read.

    Raises:
        WorkerError: It does not start at all.
        KilledStartError: It was killed meanwhile.
        CourseError: A refused path can't be kept from submissions on this machine.
    """

    def __init__(self, off: Collection[str] = (), refused: tuple[str, ...] = ()) -> None:
        if not hasattr(os, "fork"):
            raise WorkerError("grading needs Linux, macOS or WSL2: this system can't fork a process")
        files = readable(refused)
        said = ""
        for bubblewrap, roots in _attempts(off):
            scratch = INSIDE if bubblewrap else tempfile.mkdtemp(prefix="course_worker_")
            place = {**_place(files, off), "roots": roots, "scratch": scratch}
            self._control, theirs = socket.socketpair()
            with theirs:
                self._process = _start(theirs, place, bubblewrap, files, off)
            self._control.settimeout(START_SECONDS)
            answer = self._control.recv(2**16)
            if answer:
                self.isolation = Isolation(tuple(read_json(answer)))
                break
            said = self._process.communicate()[0].decode("utf-8", "replace")
            self._control.close()
            if not bubblewrap:
                shutil.rmtree(scratch, ignore_errors=True)
            if not 0 <= self._process.returncode < SIGNALLED:
                why = f"a worker was killed while it started: {said.strip()[-500:]}"
                raise KilledStartError(why.rstrip(": "))
        else:
            raise WorkerError(f"a worker can't be started: {said.strip()[-500:]}")
        if files.torn and self.isolation.protects and not self.isolation.hides:
            self.close()
            raise CourseError(
                f"{files.torn} lies in a folder that Python needs in the jail, and what works here is: "
                f"{self.isolation}. Move it to another folder, or grade where there are namespaces"
            )

    def start(self, limits: Limits, imports: Collection[str]) -> tuple[socket.socket, int]:
        """Start a submission, on the processors of the calling thread.

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
            wanted = {"limits": asdict(limits), "imports": list(imports), "processors": processors()}
            socket.send_fds(self._control, [json.dumps(wanted).encode()], [theirs.fileno(), writer])
        os.close(writer)
        return ours, reader

    @property
    def pid(self) -> int:
        """The number of the process below which submissions run."""
        return self._process.pid

    @property
    def is_sound(self) -> bool:
        """True unless somebody killed the template."""
        return self._process.poll() in (None, 0)

    def stop(self) -> Usage:
        """End the submission with all that it has started; returns what it used."""
        try:
            self._control.settimeout(STOP_SECONDS)
            self._control.send(b"stop")
            return Usage(**read_json(self._control.recv(200)))
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
        for files in [files for files, template in _shared.items() if template is self]:
            del _shared[files]


def processors() -> list[int]:
    """Return the numbers of the processors that the calling thread may run on; none if that is unknown."""
    return sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []


_shared: dict[Readable, TemplateProcess] = {}


def shared_template(refused: tuple[str, ...] = ()) -> TemplateProcess:
    """Return the template of this process that hides these paths, started when it is first asked for.

    Courses that lie outside of all that Python needs share one: their submissions may read the same.
    """
    files = readable(refused)
    if files not in _shared:
        _shared[files] = TemplateProcess(refused=refused)
        atexit.register(_shared[files].close)
    return _shared[files]


def _attempts(off: Collection[str]) -> list[tuple[str, list[str]]]:
    """Return ways to start, the most closed first: bubblewrap's path or none, and the roots that will do."""
    bubblewrap = shutil.which("bwrap") or "" if "bubblewrap" not in off else ""
    own = ["own"] if "namespaces" not in off else []
    if not bubblewrap:
        return [("", [*own, "host"])]
    return [*([("", own)] if own else []), (bubblewrap, ["bubblewrap"]), ("", ["host"])]


def _place(files: Readable, off: Collection[str]) -> dict[str, Any]:
    """Return what `settle` needs to know, but for what differs between attempts."""
    changes = os.geteuid() == 0 and "process limit" not in off
    users = ["another", "real", "same"] if changes else ["same"]
    return {"users": users, "read": files.paths, "listed": files.listed, "links": files.links}


def _start(
    control: socket.socket, place: dict[str, Any], bubblewrap: str, files: Readable, off: Collection[str]
) -> "subprocess.Popen[bytes]":
    environment = {
        "PATH": os.defpath,
        "LANG": "C.UTF-8",
        "MPLBACKEND": "Agg",
        "PYTHONHASHSEED": "0",
        "PYTHONPATH": os.path.dirname(KIT),  # this kit, whichever is installed
        "PYTHONUSERBASE": site.getuserbase(),  # the kit may be installed there, and HOME is not the user's
    }
    settings = {"control": control.fileno(), "off": list(off), "place": place}
    command = [sys.executable, "-P", "-m", "course_lib.grading.jail.template", json.dumps(settings)]
    homes = dict.fromkeys(HOMES, place["scratch"])
    return subprocess.Popen(
        [*(_bubblewrap(bubblewrap, files) if bubblewrap else ()), *command],
        env={**environment, **homes, **THREADS},
        cwd="/",
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        pass_fds=[control.fileno()],
        start_new_session=True,
    )


def _bubblewrap(program: str, files: Readable) -> list[str]:
    links = [word for link, target in files.links for word in ("--symlink", target, link)]
    binds = [word for path in files.paths for word in ("--ro-bind", path, path)]
    become = BECOME_ANOTHER.split() if os.geteuid() == 0 else []
    return [program, *BUBBLEWRAP.split(), *links, *binds, "--perms", "0777", "--dir", INSIDE, *become, "--"]
