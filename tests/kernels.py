"""Kernels for nbmake and nbclient that communicate through IPC files instead of ports.

Jupyter chooses a kernel's ports before the kernel listens on them. A test beside it may take one
meanwhile.
"""

import tempfile
from pathlib import Path
from typing import Any

from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient


class KernelOnFiles(AsyncKernelManager):
    """The manager of a kernel whose sockets are files; their paths must be short, and their folder is new."""

    def __init__(self, **settings: Any) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="kernel_", ignore_cleanup_errors=True)
        connection = str(Path(self._folder.name) / "kernel.json")
        super().__init__(transport="ipc", connection_file=connection, **settings)


def listen_on_files() -> None:
    """Start the kernels of all clients of this process so."""
    usual = NotebookClient.create_kernel_manager

    def create(client: NotebookClient) -> Any:
        client.kernel_manager_class = KernelOnFiles
        return usual(client)

    setattr(NotebookClient, "create_kernel_manager", create)  # noqa: B010  mypy knows no patch
