"""Claims that need a real kernel: ■, and threads between cells."""

import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from jupyter_client.blocking.client import BlockingKernelClient
from jupyter_client.manager import KernelManager

from tests.patience import PATIENCE

A_MINUTE = 60.0  # [s]
SPIN = """
import os
import threading
import rclpy
from rclpy.node import Node

class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.count = 0
        self.create_timer(0.05, self.tick)

    def tick(self):
        self.count += 1

os.environ["COURSE_PACE"] = "real"  # as where a page is watching
rclpy.init()
node = Counter()
thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
thread.start()
"""


@pytest.fixture(scope="module")
def kernel() -> Iterator[tuple[KernelManager, BlockingKernelClient]]:
    with tempfile.TemporaryDirectory(prefix="kernel_") as folder:  # of a short name, as sockets need
        manager = KernelManager(transport="ipc", connection_file=str(Path(folder) / "kernel.json"))
        manager.start_kernel()
        client = manager.blocking_client()
        client.start_channels()
        client.wait_for_ready(timeout=A_MINUTE)
        client.execute_interactive("%load_ext course_lib", timeout=A_MINUTE)
        yield manager, client
        client.stop_channels()
        manager.shutdown_kernel(now=True)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("line", "error"),
    [("await asyncio.sleep(1000)", "CancelledError"), ("while True: pass", "KeyboardInterrupt")],
)
def test_interrupt_button_ends_a_waiting_cell(
    kernel: tuple[KernelManager, BlockingKernelClient], line: str, error: str
) -> None:
    manager, client = kernel
    client.execute(f"import asyncio\nprint('waits', flush=True)\n{line}")
    while (message := client.get_iopub_msg(timeout=A_MINUTE))["msg_type"] != "error":
        if message["msg_type"] == "stream":
            manager.interrupt_kernel()
    assert message["content"]["ename"] == error
    client.execute_interactive("print('alive')", timeout=A_MINUTE)


@pytest.mark.slow
def test_spinning_thread_runs_between_cells_until_shutdown(
    kernel: tuple[KernelManager, BlockingKernelClient],
) -> None:
    _, client = kernel
    client.execute_interactive(SPIN, timeout=A_MINUTE)
    wait_for(client, "node.count > 20")
    client.execute_interactive("rclpy.shutdown()", timeout=A_MINUTE)
    wait_for(client, "not thread.is_alive()")


def wait_for(client: BlockingKernelClient, expression: str) -> None:
    end = time.monotonic() + PATIENCE
    while True:
        reply = client.execute_interactive("", user_expressions={"it": expression}, timeout=A_MINUTE)
        if reply["content"]["user_expressions"]["it"]["data"]["text/plain"] == "True":
            return
        assert time.monotonic() < end, expression
        time.sleep(0.05)
