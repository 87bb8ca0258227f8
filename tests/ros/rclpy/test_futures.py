from __future__ import annotations

from pathlib import Path

import pytest
import rclpy
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String

from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.programs.program import run_files

LOOPS_OVER_DONE = """
import threading
import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger

def on_reset(request, response):
    response.message = "reset by the server"
    return response

rclpy.init()
node = Node("asks")
node.create_service(Trigger, "reset", on_reset)
client = node.create_client(Trigger, "reset")
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
future = client.call_async(Trigger.Request())
while not future.done():
    pass
print(future.result().message)
"""


def test_future_returns_its_result_or_raises_its_exception() -> None:
    future: Future[int] = Future()
    assert not future.done()
    assert future.result() is None
    future.set_result(3)
    assert (future.done(), future.result(), future.exception()) == (True, 3, None)
    failed: Future[int] = Future()
    failed.set_exception(KeyError("x"))
    assert isinstance(failed.exception(), KeyError)
    with pytest.raises(KeyError):
        failed.result()


def test_done_callbacks_are_called_once_and_immediately_if_the_future_is_done() -> None:
    future: Future[int] = Future()
    calls: list[object] = []
    future.add_done_callback(lambda f: calls.append(f.result()))
    future.set_result(1)
    future.add_done_callback(lambda f: calls.append("late"))
    assert calls == [1, "late"]


def test_failing_done_callback_does_not_prevent_other_callbacks() -> None:
    future: Future[int] = Future()
    calls: list[object] = []
    future.add_done_callback(lambda f: 1 / 0)
    future.add_done_callback(calls.append)
    with pytest.warns(UserWarning, match="Unhandled exception in done callback: division by zero"):
        future.set_result(1)
    assert calls == [future]


def test_canceled_future_is_not_done() -> None:
    future: Future[int] = Future()
    future.cancel()
    assert (future.cancelled(), future.done()) == (True, False)


def test_executor_runs_tasks_and_their_done_callbacks(started_graph: Graph) -> None:
    executor = SingleThreadedExecutor()
    calls: list[object] = []
    task = executor.create_task(lambda a, b: a + b, 1, b=2)
    task.add_done_callback(lambda f: calls.append(f.result()))
    executor.spin_until_future_complete(task)
    assert (task.result(), calls) == (3, [])
    executor.spin_once(timeout_sec=0)
    assert calls == [3]


def test_coroutine_callback_awaits_a_future_while_other_callbacks_run(node: Node) -> None:
    answer: Future[str] = Future()
    calls: list[object] = []

    async def ask() -> None:
        timer.cancel()
        calls.append(await answer)

    group = rclpy.callback_groups.MutuallyExclusiveCallbackGroup()
    timer = node.create_timer(1.0, ask, callback_group=group)
    node.create_timer(2.5, lambda: None if answer.done() else answer.set_result("yes"))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.spin_until_future_complete(answer)
    executor.spin_once(timeout_sec=0)
    assert calls == ["yes"]
    assert node.get_clock().now().nanoseconds == START_NS + 2_500_000_000


def test_mutually_exclusive_group_is_blocked_while_its_coroutine_awaits(node: Node) -> None:
    forever: Future[None] = Future()
    calls: list[str] = []

    async def wait_for_ever(message: String) -> None:
        calls.append(message.data)
        await forever

    node.create_subscription(String, "x", wait_for_ever, 10)
    node.create_timer(1.0, lambda: calls.append("timer"))
    publisher = node.create_publisher(String, "x", 10)
    publisher.publish(String(data="one"))
    publisher.publish(String(data="two"))
    rclpy.spin(node)
    assert calls == ["one"]


def test_spin_until_future_complete_returns_at_its_timeout(node: Node) -> None:
    never: Future[None] = Future()
    node.create_timer(0.3, lambda: None)
    rclpy.spin_until_future_complete(node, never, timeout_sec=2.0)
    assert node.get_clock().now().nanoseconds == START_NS + 2 * 10**9
    assert not never.done()
    node.get_clock().sleep_for(Duration(seconds=1))


def test_coroutine_exception_propagates_from_spin(node: Node) -> None:
    async def fail() -> None:
        raise ValueError("out of range")

    node.create_timer(1.0, fail)
    with pytest.raises(ValueError, match="out of range"):
        rclpy.spin(node)


def test_polling_loop_over_done_lets_another_thread_spin(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "asks.py").write_text(LOOPS_OVER_DONE)
    with use_graph(Graph(end_ns=START_NS + 10**10)):
        assert run_files([tmp_path / "asks.py"], seed=0) == 0
    assert capsys.readouterr().out == "reset by the server\n"
