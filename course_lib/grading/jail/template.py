"""The process that submissions are forked from: all imports are done, and it contains no secrets.

Importing the kit takes seconds, forking milliseconds. `launch` starts the template with a clean
environment. It never runs student code itself, and ends with the grader.
"""

import gc
import importlib
import json
import os
import platform
import resource
import shutil
import signal
import socket
import sys
import tempfile
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import asdict
from itertools import count
from pathlib import Path
from select import select

from course_lib.course.course_file import Limits
from course_lib.grading.jail import filters
from course_lib.grading.jail.filters import Excess, Usage, wait_any_child
from course_lib.grading.jail.launch import DEVICES, HOMES, JailEnvironment, is_usable, settle
from course_lib.grading.run.worker import Worker, warm_up
from course_lib.ros.graph.remote import Channel
from course_lib.third_party import read_json


def working_layers(place: JailEnvironment, off: Collection[str]) -> list[str]:
    """Return the isolation layers that work here, without the layers in `off`.

    Each is tried in a forked process.
    """
    layers = ["bubblewrap"] if place.root == "bubblewrap" else []
    tries: dict[str, Callable[[], None]] = {
        "namespaces": lambda: _enter_namespaces(place, Limits()),
        "Landlock": lambda: _restrict_files(place, place.scratch),
        "seccomp": filters.filter_calls,
        "limits": lambda: filters.apply_limits(Limits(), 0, counts_from_zero=False),
    }
    # Namespaces alone do not hide the machine's files.
    if place.root == "host":
        del tries["namespaces"]
    layers += [name for name, layer in tries.items() if name not in off and is_usable(layer)]
    is_bounded = "limits" in layers and "process limit" not in off and platform.system() == "Linux"
    # The kernel does not limit the number of root's processes.
    if is_bounded and is_usable(lambda: _require_process_limit(place, layers)):
        layers.append("process limit")
    return layers


def enter_jail(place: JailEnvironment, layers: Collection[str], limits: Limits) -> None:
    """Enter the jail irrevocably. With namespaces, only a fork of this process returns from here.

    Raises:
        OSError: A layer that worked before fails.
    """
    folder = place.scratch
    # The jail has no /proc. This process is a fork of the template, which may have imported large
    # modules for other submissions.
    inherited_bytes = filters.address_space()
    if "namespaces" in layers:
        _enter_namespaces(place, limits)
    else:
        folder = tempfile.mkdtemp(dir=place.scratch)
    os.chdir(folder)
    os.environ.update(dict.fromkeys(HOMES, folder))
    # A module that the template has imported may have called tempfile.gettempdir(), whose result
    # Python caches.
    tempfile.tempdir = None
    if "limits" in layers:
        counts_from_zero = "namespaces" in layers or place.user != "same"
        filters.apply_limits(limits, inherited_bytes, counts_from_zero=counts_from_zero)
    if platform.system() == "Linux":
        # An additional protection if the system supports it.
        with suppress(OSError):
            filters.drop_capabilities()
            # Without namespaces, the template must be able to list the open files.
            filters.prctl(filters.DUMPABLE, int("namespaces" not in layers))
            filters.prctl(filters.NO_NEW_PRIVILEGES, 1)
    if "Landlock" in layers:
        _restrict_files(place, folder)
    if "seccomp" in layers:
        filters.filter_calls()


def _enter_namespaces(place: JailEnvironment, limits: Limits) -> None:
    filters.enter_namespaces()
    first = os.fork()
    if first:
        os._exit(0)
    filters.mount_files(place.scratch, limits.scratch_megabytes)


def _restrict_files(place: JailEnvironment, folder: str) -> None:
    filters.restrict_files([*place.read, *DEVICES], [folder, os.devnull], place.listed)


def _require_process_limit(place: JailEnvironment, layers: Collection[str]) -> None:
    """Raise OSError unless a limit on processes is effective."""
    enter_jail(place, {"namespaces"} & set(layers), Limits())
    resource.setrlimit(resource.RLIMIT_NPROC, (0, 0))
    try:
        child = os.fork()
    except BlockingIOError:
        return
    if child == 0:
        os._exit(0)
    raise OSError("the kernel does not count this user's processes")


class Template:
    """Forks submissions, one at a time, and kills each with all processes that it has started.

    Args:
        control: The socket to the grader.
        place: Where submissions run.
        off: Layers to disable.
    """

    def __init__(self, control: socket.socket, place: JailEnvironment, off: Collection[str]) -> None:
        self._control, self._place = control, place
        self._shell = warm_up()
        self._submission = 0  # process id of the submission's first process, or 0
        self._inherited_bytes = 0  # memory of this process [B] when it forked the submission
        self._limits, self._usage = Limits(), Usage()
        self._excess: Excess | None = None
        # Only Linux has these operations.
        with suppress(OSError):
            filters.prctl(filters.CHILD_SUBREAPER, 1)
            filters.prctl(filters.DUMPABLE, 0)
        self._layers = working_layers(place, off)
        gc.collect()
        self._is_watching = "limits" in self._layers and platform.system() == "Linux"

    def serve(self) -> None:
        """Start and stop submissions until the grader disconnects."""
        self._control.send(json.dumps(self._layers).encode())
        while True:
            # The kernel limits each process. Sums over all of them are checked while waiting.
            interval = filters.EVERY if self._submission and self._is_watching else None
            while not select([self._control], [], [], interval)[0]:
                self._limit_sums()
            message, descriptors, *_ = socket.recv_fds(self._control, 2**16, 2)
            if not message:
                break
            if message == b"stop":
                self._control.send(self._stop().encode())
            else:
                request = read_json(message)
                # Imports in the template are done once for all later submissions.
                for module in request["imports"]:
                    importlib.import_module(module)
                # Frozen objects keep their memory pages shared with the forks.
                gc.freeze()
                if request["processors"]:
                    # A processor may have gone offline, which makes the run only slower.
                    with suppress(OSError):
                        os.sched_setaffinity(0, request["processors"])
                self._limits = Limits(**request["limits"])
                self._start(self._limits, descriptors)
        self._stop()

    def _start(self, limits: Limits, descriptors: list[int]) -> None:
        if self._is_watching:
            self._inherited_bytes = filters.resident_bytes(os.getpid())
        self._submission = os.fork()
        if self._submission == 0:
            try:
                self._control.detach()
                os.setsid()
                connection, output = descriptors
                for descriptor in (1, 2):
                    os.dup2(output, descriptor)
                # Close all other descriptors.
                os.closerange(3, connection)
                os.closerange(connection + 1, resource.getrlimit(resource.RLIMIT_NOFILE)[0])
                channel = Channel(socket.socket(fileno=connection))
                problem = ""
                try:
                    enter_jail(self._place, self._layers, limits)
                except OSError as error:
                    problem = str(error)
                # No student code has run yet, so this message can be trusted.
                channel.send(["jailed", problem])
                if not problem:
                    Worker(channel, self._shell).serve()
            finally:
                os._exit(0)
        for descriptor in descriptors:
            os.close(descriptor)

    def _limit_sums(self) -> None:
        """Prevent writes if the files are too large; kill the submission above its memory limit."""
        excess = filters.check_memory(
            os.getpid(), self._inherited_bytes, self._limits.memory_of_all_processes
        )
        # In namespaces, the scratch folder is in memory and has a size of its own.
        if "namespaces" not in self._layers:
            files, too_many = filters.stop_writing(self._place.scratch, self._limits.scratch_megabytes)
            self._usage += files
            excess = excess or too_many
        if excess:
            self._usage += self._kill()
            self._excess = self._excess or excess

    def _stop(self) -> str:
        """Kill the submission, and return its usage and the limit for which it was killed before, if any."""
        report = {"usage": asdict(self._usage + self._kill()), "excess": self._excess}
        self._usage, self._excess = Usage(), None
        # With namespaces, the kernel has removed the scratch folder.
        if "namespaces" not in self._layers:
            empty_folder(self._place.scratch)
        return json.dumps(report, default=asdict)

    def _kill(self) -> Usage:
        """Kill the submission with all its processes. Orphans become children of this process."""
        usage, me = Usage(), os.getpid()
        while True:
            pids = [self._submission] * bool(self._submission)
            # Only Linux has this file.
            with suppress(OSError):
                children = Path(f"/proc/{me}/task/{me}/children").read_text().split()
                pids = list(map(int, children)) or pids
            for pid in pids:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            try:
                usage += wait_any_child()
            except ChildProcessError:
                self._submission = 0
                return usage


def empty_folder(folder: str) -> None:
    """Empty a folder. Entries of subfolders are moved up first, so that any depth works."""
    numbers = count()
    waiting = [entry.path for entry in os.scandir(folder)]
    while waiting:
        path = waiting.pop()
        if os.path.islink(path) or not os.path.isdir(path):
            os.unlink(path)
            continue
        os.chmod(path, 0o700)
        for entry in list(os.scandir(path)):
            while os.path.lexists(new_path := os.path.join(folder, f"{next(numbers)}")):
                pass
            os.rename(entry.path, new_path)
            waiting.append(new_path)
        os.rmdir(path)


def main() -> None:
    """Serve the grader at the other end of the socket passed as the argument."""
    settings = read_json(sys.argv.pop())
    # If memory runs out, the kernel should kill this process, not the grader. Only Linux has this
    # file.
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")
    place = settle(**settings["place"])
    try:
        Template(socket.socket(fileno=settings["control"]), place, settings["off"]).serve()
    finally:
        shutil.rmtree(place.scratch, ignore_errors=True)


if __name__ == "__main__":
    main()
