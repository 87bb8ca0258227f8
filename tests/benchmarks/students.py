"""Kernels of a class: each runs the cells of a notebook, and a page displays its view.

The page is a client that reads the stream as `js/link.js` does, and answers in a subshell as
JupyterLab does; it draws nothing.
"""

import json
import os
import subprocess
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import psutil
import zmq
from jupyter_client.blocking.client import BlockingKernelClient
from jupyter_client.manager import KernelManager

PATIENCE = 600.0  # [s], for the slowest of fifty kernels that start on two cores
_DELIMITER = b"<IDS|MSG>"


@dataclass
class Student:
    """A kernel, and the page that shows its view."""

    manager: KernelManager
    client: BlockingKernelClient
    subshell: str  # handles messages of the page, outside of cells
    views: dict[str, int] = field(default_factory=dict)  # by widget: the number of the page's last batch
    frames: int = 0  # that its page has seen
    received: int = 0  # [bytes] of these
    idle: set[str] = field(default_factory=set)  # cells that are done
    errors: list[str] = field(default_factory=list)

    def processes(self) -> list[psutil.Process]:
        """Return the kernel's process and its child processes."""
        kernel = psutil.Process(self.manager.provisioner.pid)  # type: ignore[union-attr]  # a local one
        return [kernel, *kernel.children(recursive=True)]

    def say(self, comm: str, content: Mapping[str, Any]) -> None:
        """Send a message of the page to its widget."""
        content = {"page": "page", "number": self.views[comm], **content}
        data = {"comm_id": comm, "data": {"method": "custom", "content": content}}
        message = self.client.session.msg("comm_msg", data)
        message["header"]["subshell_id"] = self.subshell
        self.client.shell_channel.send(message)

    def hear(self) -> None:
        """Read all messages from the kernel."""
        socket = self.client.iopub_channel.socket
        while socket.poll(0):
            parts = socket.recv_multipart()
            start = parts.index(_DELIMITER)
            header, parent, _, content = (json.loads(part) for part in parts[start + 2 : start + 6])
            self._take(header["msg_type"], parent.get("msg_id", ""), content, parts[start + 6 :])

    def _take(self, kind: str, cell: str, content: Any, buffers: list[bytes]) -> None:
        if kind == "status" and content["execution_state"] == "idle":
            self.idle.add(cell)
        elif kind == "error":
            self.errors.append("\n".join(content["traceback"]))
        elif kind == "comm_open" and "snapshot" in str(content["data"].get("buffer_paths")):
            self.views[content["comm_id"]] = content["data"]["state"].get("number", 0)
            self.say(content["comm_id"], {"type": "ready"})
            self.say(content["comm_id"], {"type": "views", "count": 1})
        elif kind == "comm_msg" and content["comm_id"] in self.views:
            self._follow(content["comm_id"], content["data"].get("content") or {}, buffers)

    def _follow(self, comm: str, message: Mapping[str, Any], buffers: list[bytes]) -> None:
        if message.get("type") in ("batch", "reset"):
            self.views[comm] = max(self.views[comm], message["number"])
            self.frames += message["type"] == "batch"
            self.received += sum(map(len, buffers))
        if message.get("ask"):
            self.say(comm, {"type": "ack"})


@contextmanager
def students(count: int, folder: Path, kit: Path | None = None) -> Iterator[list[Student]]:
    """Start kernels as JupyterLab does, with a folder as their working directory.

    Args:
        count: How many.
        folder: Where they run.
        kit: A checkout whose course_lib they import; None takes what is installed.
    """
    env = {**os.environ, "JPY_SESSION_NAME": str(folder / "week07_dashboard.ipynb")}
    if kit:
        env["PYTHONPATH"] = str(kit)
    started: list[Student] = []
    with ExitStack() as ends:
        for _ in range(count):
            manager = KernelManager()
            manager.start_kernel(env=env, cwd=str(folder), stderr=subprocess.DEVNULL)
            ends.callback(manager.shutdown_kernel, now=True)
            client = manager.blocking_client()
            client.start_channels()
            ends.callback(client.stop_channels)
            client.wait_for_ready(timeout=PATIENCE)
            started.append(Student(manager, client, _subshell(client)))
        yield started


def _subshell(client: BlockingKernelClient) -> str:
    client.control_channel.send(client.session.msg("create_subshell_request"))
    return str(client.get_control_msg(timeout=PATIENCE)["content"]["subshell_id"])


def run_cells(students: list[Student], texts: Iterable[str]) -> None:
    """Run cells in all kernels at the same time.

    Raises:
        RuntimeError: With the traceback of a cell that fails.
    """
    wanted = [{student.client.execute(text) for text in texts} for student in students]
    end = time.monotonic() + PATIENCE
    while not all(cells <= student.idle for cells, student in zip(wanted, students, strict=True)):
        follow(students, 0.1)
        errors = [error for student in students for error in student.errors]
        if errors or time.monotonic() > end:
            raise RuntimeError("\n".join(errors[:1]) or f"Cells took more than {PATIENCE:g} s.")


def hide(students: list[Student]) -> None:
    """Put all pages behind other tabs."""
    for student in students:
        for comm in student.views:
            student.say(comm, {"type": "hide"})


def follow(students: list[Student], seconds: float) -> None:
    """Be the pages of all students for some time, [s]."""
    poller, by_socket = zmq.Poller(), {s.client.iopub_channel.socket: s for s in students}
    for socket in by_socket:
        poller.register(socket, zmq.POLLIN)
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        for socket, _ in poller.poll(round(1000 * left)):
            by_socket[socket].hear()
