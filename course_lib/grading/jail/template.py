"""The process of which every submission is a fork: all imports are done, and nothing in it is worth reading.

`launch` starts it, with a clean environment. It runs no student's code itself, and ends with the grader.
"""

import gc
import importlib
import json
import os
import resource
import shutil
import signal
import socket
import sys
from collections.abc import Collection
from contextlib import suppress
from itertools import count
from pathlib import Path
from select import select

from course_lib.course.course_file import Limits
from course_lib.foreign import read_json
from course_lib.grading.jail.layers import enter, working_layers
from course_lib.grading.jail.limits import EVERY, stop_writing
from course_lib.grading.jail.place import Place, settle
from course_lib.grading.jail.system_calls import CHILD_SUBREAPER, DUMPABLE, prctl
from course_lib.grading.run.outcome import Usage, wait_any_child
from course_lib.grading.run.worker import Worker, warm_up
from course_lib.ros.channel import Channel


class Template:
    """Forks submissions, one at a time, and ends each with all that it has started.

    Args:
        control: To the grader.
        place: Where submissions run.
        off: Layers that are not to be used.
    """

    def __init__(self, control: socket.socket, place: Place, off: Collection[str]) -> None:
        self._control, self._place = control, place
        self._shell = warm_up()
        self._submission = 0  # its first process; 0 for none
        self._limits, self._files = Limits(), Usage()
        with suppress(OSError):  # not Linux
            prctl(CHILD_SUBREAPER, 1)
            prctl(DUMPABLE, 0)
        self._layers = working_layers(place, off)
        gc.collect()

    def serve(self) -> None:
        """Start and stop submissions until the grader is gone."""
        self._control.send(json.dumps(self._layers).encode())
        while True:
            self._watch()
            message, descriptors, *_ = socket.recv_fds(self._control, 2**16, 2)
            if not message:
                break
            if message == b"stop":
                self._control.send(self._stop().as_json().encode())
            else:
                wanted = read_json(message)
                for module in wanted["imports"]:  # the first submission pays for all that follow
                    importlib.import_module(module)
                gc.freeze()  # so that collections in forks leave its memory shared
                if wanted["processors"]:
                    with suppress(OSError):  # one of them is not there any more: only slower
                        os.sched_setaffinity(0, wanted["processors"])
                self._limits = Limits(**wanted["limits"])
                self._start(self._limits, descriptors)
        self._stop()

    def _watch(self) -> None:
        """Wait for the grader, and bound meanwhile what a submission writes to the disk."""
        has_own = "namespaces" in self._layers or "limits" not in self._layers or sys.platform != "linux"
        while not select([self._control], [], [], None if has_own or not self._submission else EVERY)[0]:
            self._files += stop_writing(self._place.scratch, self._limits.scratch_megabytes)

    def _start(self, limits: Limits, descriptors: list[int]) -> None:
        self._submission = os.fork()
        if self._submission == 0:
            try:
                self._control.detach()
                channel = _keep_only(*descriptors)
                self._run(channel, limits)
            finally:
                os._exit(0)
        for descriptor in descriptors:
            os.close(descriptor)

    def _run(self, channel: Channel, limits: Limits) -> None:
        problem = ""
        try:
            enter(self._place, self._layers, limits)
        except OSError as error:
            problem = str(error)
        channel.send(["jailed", problem])  # nothing of the student's has run yet: this is true
        if not problem:
            Worker(channel, self._shell).serve()

    def _stop(self) -> Usage:
        """Kill the submission and all that it has started: orphans become children of this process."""
        usage, self._files = self._files, Usage()
        while True:
            for pid in _children() or [self._submission] * bool(self._submission):
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            try:
                usage += wait_any_child()
            except ChildProcessError:
                break
        if "namespaces" not in self._layers:  # with them nothing is left
            clear(self._place.scratch)
        self._submission = 0
        return usage


def _keep_only(channel: int, output: int) -> Channel:
    """Close all descriptors but these two."""
    os.setsid()
    for descriptor in (1, 2):
        os.dup2(output, descriptor)
    os.closerange(3, channel)
    os.closerange(channel + 1, resource.getrlimit(resource.RLIMIT_NOFILE)[0])
    return Channel(socket.socket(fileno=channel))


def clear(folder: str) -> None:
    """Remove what is in a folder, at any depth: what lies in a folder moves up before that is removed."""
    numbers = count()
    waiting = [entry.path for entry in os.scandir(folder)]
    while waiting:
        path = waiting.pop()
        if os.path.islink(path) or not os.path.isdir(path):
            os.unlink(path)
            continue
        os.chmod(path, 0o700)
        for entry in list(os.scandir(path)):
            while os.path.lexists(moved := os.path.join(folder, f"{next(numbers)}")):
                pass
            os.rename(entry.path, moved)
            waiting.append(moved)
        os.rmdir(path)


def _children() -> list[int]:
    me = os.getpid()
    try:
        return [int(pid) for pid in Path(f"/proc/{me}/task/{me}/children").read_text().split()]
    except OSError:  # not Linux
        return []


def main() -> None:
    """Serve the grader at the other end of the socket that the argument names."""
    settings = read_json(sys.argv.pop())
    with suppress(OSError):  # not Linux
        Path("/proc/self/oom_score_adj").write_text("1000")  # where memory runs out, not the grader's
    place = settle(**settings["place"])
    try:
        Template(socket.socket(fileno=settings["control"]), place, settings["off"]).serve()
    finally:
        shutil.rmtree(place.scratch, ignore_errors=True)


if __name__ == "__main__":
    main()
