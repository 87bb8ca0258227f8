"""An action client that runs in an event loop of asyncio, in the form of ROS's example client_asyncio.py."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.patience import PATIENCE

PROGRAM = """
import asyncio
import threading
import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer


def execute(goal_handle):
    feedback = Fibonacci.Feedback(sequence=[0, 1])
    for _ in range(goal_handle.request.order):
        feedback.sequence.append(feedback.sequence[-1] + feedback.sequence[-2])
        goal_handle.publish_feedback(feedback)
        time.sleep(0.2)
    goal_handle.succeed()
    return Fibonacci.Result(sequence=feedback.sequence)


async def spin(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.01)
        await asyncio.sleep(0.001)


async def send(client, order):
    received = []
    client.wait_for_server()
    goal = Fibonacci.Goal(order=order)
    handle = await client.send_goal_async(goal, lambda message: received.append(message.feedback))
    response = await handle.get_result_async()
    print(order, response.status, list(response.result.sequence), len(received))


async def run():
    node, server_node = rclpy.create_node("client"), rclpy.create_node("server")
    server = ActionServer(server_node, Fibonacci, "fibonacci", execute)
    threading.Thread(target=rclpy.spin, args=(server_node,), daemon=True).start()
    client = ActionClient(node, Fibonacci, "fibonacci")
    spinning = asyncio.get_running_loop().create_task(spin(node))
    await send(client, 3)
    await asyncio.gather(send(client, 1), send(client, 2))
    spinning.cancel()
    try:
        await spinning
    except asyncio.CancelledError:
        print("cancelled")


rclpy.init()
asyncio.new_event_loop().run_until_complete(run())
rclpy.shutdown()
"""


@pytest.mark.slow
def test_goals_and_results_can_be_awaited_in_asyncio(tmp_path: Path) -> None:
    file = tmp_path / "client_asyncio.py"
    file.write_text(PROGRAM, encoding="utf-8")
    command = [sys.executable, "-m", "course_lib", "run", "--seconds", "5", str(file)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert (run.returncode, run.stderr) == (0, "")
    assert run.stdout.splitlines() == [
        "3 4 [0, 1, 1, 2, 3] 3",
        "1 4 [0, 1, 1] 1",
        "2 4 [0, 1, 1, 2] 2",
        "cancelled",
    ]
