"""■ in a real kernel."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from jupyter_client.blocking.client import BlockingKernelClient
from jupyter_client.manager import KernelManager

A_MINUTE = 60.0  # [s]


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


@pytest.mark.parametrize(
    ("line", "error"),
    [("await asyncio.sleep(1000)", "CancelledError"), ("while True: pass", "KeyboardInterrupt")],
)
def test_the_interrupt_button_ends_a_cell_that_waits(
    kernel: tuple[KernelManager, BlockingKernelClient], line: str, error: str
) -> None:
    manager, client = kernel
    client.execute(f"import asyncio\nprint('waits', flush=True)\n{line}")
    while (message := client.get_iopub_msg(timeout=A_MINUTE))["msg_type"] != "error":
        if message["msg_type"] == "stream":
            manager.interrupt_kernel()
    assert message["content"]["ename"] == error
    client.execute_interactive("print('alive')", timeout=A_MINUTE)
