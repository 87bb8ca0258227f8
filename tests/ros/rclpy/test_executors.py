import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest
import rclpy
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.exceptions import NotInitializedException
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Int32

from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.programs.program import run_files
from course_lib.ros.time.time_lock import DeadlockError


def since_start(node: Node) -> float:
    return (node.get_clock().now().nanoseconds - START_NS) * 1e-9


def sleep_once(node: Node, group: CallbackGroup | None = None) -> None:
    """At 1 s, sleep for 3 s."""

    def sleep() -> None:
        timer.cancel()
        time.sleep(3.0)

    timer = node.create_timer(1.0, sleep, callback_group=group)


def test_spin_once_runs_exactly_one_callback(node: Node) -> None:
    calls: list[str] = []
    node.create_timer(1.0, lambda: calls.append("a"))
    node.create_timer(1.0, lambda: calls.append("b"))
    rclpy.spin_once(node)
    assert calls == ["a"]
    rclpy.spin_once(node)
    assert calls == ["a", "b"]
    assert since_start(node) == 1.0


def test_spin_once_returns_at_its_timeout(node: Node) -> None:
    node.create_timer(5.0, lambda: None)
    rclpy.spin_once(node, timeout_sec=2.0)
    assert since_start(node) == 2.0
    rclpy.spin_once(node, timeout_sec=0)
    assert since_start(node) == 2.0


def test_polling_loop_advances_time(node: Node) -> None:
    calls: list[float] = []
    node.create_timer(1.0, lambda: calls.append(since_start(node)))
    while len(calls) < 2:
        rclpy.spin_once(node, timeout_sec=0)
    assert calls == pytest.approx([1.0, 2.0])


def test_callbacks_run_in_event_order_across_all_nodes(started_graph: Graph) -> None:
    calls: list[str] = []
    executor = SingleThreadedExecutor()
    nodes = [Node(name) for name in ("first", "second")]
    for period, node in ((1.0, nodes[1]), (1.0, nodes[0]), (0.5, nodes[1])):
        node.create_timer(period, lambda n=node, p=period: calls.append(f"{n.get_name()} {p}"))  # type: ignore[misc]
        executor.add_node(node)
    executor.spin_once()
    for _ in range(3):
        executor.spin_once()
    assert calls == ["second 0.5", "first 1.0", "second 1.0", "second 0.5"]


def test_ready_callback_waits_until_its_node_is_added(node: Node) -> None:
    values: list[int] = []
    node.create_subscription(Int32, "x", lambda m: values.append(m.data), 10)
    node.create_publisher(Int32, "x", 10).publish(Int32(data=7))
    other = Node("other")
    rclpy.spin_once(other, timeout_sec=1.0)
    assert values == []
    rclpy.spin_once(node)
    assert values == [7]


def test_callback_exception_propagates_from_spin_and_the_node_remains_usable(node: Node) -> None:
    calls: list[float] = []

    def fail() -> None:
        calls.append(since_start(node))
        raise KeyError("joint_1")

    node.create_timer(1.0, fail)
    for _ in range(2):
        with pytest.raises(KeyError, match="joint_1"):
            rclpy.spin(node)
    assert calls == [1.0, 2.0]


def test_shutdown_in_a_callback_ends_spin_silently(node: Node) -> None:
    node.create_timer(1.0, rclpy.shutdown)
    rclpy.spin(node)
    assert not rclpy.ok()


@pytest.mark.parametrize(
    ("make", "ends"), [(SingleThreadedExecutor, "raises"), (MultiThreadedExecutor, "returns")]
)
def test_shutdown_in_another_thread_ends_a_waiting_spin(
    node: Node, make: Callable[[], SingleThreadedExecutor], ends: str
) -> None:
    executor = make()
    executor.add_node(node)

    def shut_down() -> None:
        time.sleep(1.0)
        rclpy.shutdown()

    thread = threading.Thread(target=shut_down)
    thread.start()
    how = "returns"
    try:
        executor.spin()
    except ExternalShutdownException:
        how = "raises"
    thread.join()
    assert how == ends


def test_executor_in_a_with_statement_is_shut_down_and_its_spin_ends(node: Node) -> None:
    with SingleThreadedExecutor() as executor:
        assert executor.add_node(node)
        assert not executor.add_node(node)
        assert executor.get_nodes() == [node]
        assert node.executor is executor
        node.create_timer(1.0, executor.shutdown)
        executor.spin()
    assert executor.get_nodes() == []
    assert since_start(node) == 1.0
    assert rclpy.ok()


def test_node_belongs_to_the_executor_that_added_it_last(node: Node) -> None:
    first, second = SingleThreadedExecutor(), SingleThreadedExecutor()
    first.add_node(node)
    second.add_node(node)
    assert (first.get_nodes(), second.get_nodes()) == ([], [node])


def test_executor_before_init_is_rejected(graph: Graph) -> None:
    with pytest.raises(NotInitializedException):
        SingleThreadedExecutor()


def test_spin_without_any_possible_event_raises_deadlock_error() -> None:
    with use_graph(Graph()):
        rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
        node = Node("listener")
        node.create_subscription(Int32, "x", print, 10)
        with pytest.raises(DeadlockError, match="waits for a callback of /listener"):
            rclpy.spin(node)


def test_sleeping_callback_blocks_others_in_a_single_threaded_executor(node: Node) -> None:
    calls: list[float] = []
    sleep_once(node)
    node.create_timer(1.0, lambda: calls.append(since_start(node)))
    rclpy.spin(node)
    assert calls[:3] == pytest.approx([4.0, 5.0, 6.0])


@pytest.mark.parametrize(
    ("group", "expected"),
    [(ReentrantCallbackGroup, [1.0, 2.0, 3.0]), (MutuallyExclusiveCallbackGroup, [4.0, 5.0, 6.0])],
)
def test_callback_group_determines_concurrency_in_a_multi_threaded_executor(
    node: Node, group: type[CallbackGroup], expected: list[float]
) -> None:
    calls: list[float] = []
    shared = group()
    sleep_once(node, shared)
    node.create_timer(1.0, lambda: calls.append(since_start(node)), callback_group=shared)
    rclpy.spin(node, MultiThreadedExecutor(4))
    assert calls[:3] == pytest.approx(expected)


def test_number_of_concurrent_callbacks_is_limited_by_the_number_of_threads(node: Node) -> None:
    under_way: list[int] = []
    most: list[int] = []

    def work() -> None:
        under_way.append(1)
        most.append(len(under_way))
        time.sleep(0.5)
        under_way.pop()

    for _ in range(5):
        node.create_timer(1.0, work, callback_group=ReentrantCallbackGroup())
    rclpy.spin(node, MultiThreadedExecutor(2))
    assert max(most) == 2


def test_callback_exception_in_a_worker_thread_propagates_from_spin(node: Node) -> None:
    node.create_timer(1.0, lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        rclpy.spin(node, MultiThreadedExecutor(2))


def test_shutdown_of_a_multi_threaded_executor_waits_for_its_callbacks(node: Node) -> None:
    ended: list[float] = []

    def work() -> None:
        time.sleep(3.0)
        ended.append(since_start(node))

    node.create_timer(1.0, work)
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    executor.spin_once()
    assert not executor.shutdown(timeout_sec=1.0)
    assert executor.shutdown()
    assert ended == [4.0]


@pytest.mark.slow
def test_ten_thousand_messages_are_delivered_within_seconds(node: Node) -> None:
    values: list[int] = []
    node.create_subscription(Int32, "x", lambda m: values.append(m.data), QoSProfile(depth=10_000))
    publisher = node.create_publisher(Int32, "x", 10)
    for number in range(10_000):
        publisher.publish(Int32(data=number))
    rclpy.spin(node)
    assert values == list(range(10_000))


TWO_SPINNERS = """
import threading
import time

import rclpy

rclpy.init()
node = rclpy.create_node("n")
calls = []
node.create_timer(0.1, lambda: calls.append(threading.current_thread().name))
for name in ("first", "second"):
    threading.Thread(target=rclpy.spin, args=(node,), name=name, daemon=True).start()
time.sleep(1.05)
print(len(calls))
"""


def test_second_thread_that_spins_the_same_executor_ends_with_an_error_and_a_hint(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "program.py").write_text(TWO_SPINNERS)
    with use_graph(Graph(end_ns=START_NS + 2 * 10**9)):
        assert run_files([tmp_path / "program.py"], seed=1) == 0
    out, err = capfd.readouterr()
    # The failed spin has removed the node from the executor that both share.
    assert out == "0\n"
    assert err.startswith("Exception in thread second:\n")
    assert "ValueError: generator already executing\nhint: another thread spins this executor" in err


ALONE = """
import rclpy
from std_srvs.srv import Trigger

rclpy.init()
node = rclpy.create_node("n")
client = node.create_client(Trigger, "s")
"""
SPUN = f"""
import threading
{ALONE}
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
rate = node.create_rate(2)
while rclpy.ok():
    rate.sleep()
"""


@pytest.mark.parametrize(
    ("lines", "hint"),
    [
        ("rate = node.create_rate(10)\nrate.sleep()", "rate.sleep(): the tick does not come, as no thread"),
        (
            "rate = node.create_rate(10)\n"
            "while rclpy.ok():\n    rclpy.spin_once(node, timeout_sec=0)\n    rate.sleep()",
            "rate.sleep(): the tick does not come, as no thread spins /n.",
        ),
        (
            "rate = node.create_rate(10)\nwhile rate.sleep():\n    pass",
            "while rate.sleep(): the tick does not come, as no thread",
        ),
        (
            "node.create_service(Trigger, 's', print)\nclient.call(Trigger.Request())",
            "client.call(Trigger.Request()): no response can arrive without another thread that spins",
        ),
        (
            "client.wait_for_service()",
            "client.wait_for_service(): it waited for the service /s, which is not",
        ),
        (
            "while not client.wait_for_service():\n    pass",
            "while not client.wait_for_service(): it waited for the service /s, which is not",
        ),
        (
            "import time\nfuture = client.call_async(Trigger.Request())\n"
            "while not future.done():\n    time.sleep(0.1)",
            "time.sleep(0.1): the future is done only after /n has been spun",
        ),
        (
            "future = client.call_async(Trigger.Request())\nwhile not future.done():\n    pass",
            "the future is done only after /n has been spun",
        ),
        (
            "import time\nwhile rclpy.ok() and not client.service_is_ready():\n    time.sleep(0.5)",
            "time.sleep(0.5): it waited for the service /s, which is not there.",
        ),
        (
            "import time\npublisher = node.create_publisher(Trigger.Event, 't', 1)\n"
            "while publisher.get_subscription_count() == 0:\n    time.sleep(0.5)",
            "time.sleep(0.5): no subscription to /t matches.",
        ),
        (
            "import asyncio\nasync def main():\n    await client.call_async(Trigger.Request())\n"
            "asyncio.run(main())",
            "asyncio.run(main()): the future is done only after /n has been spun",
        ),
        (
            "from example_interfaces.action import Fibonacci\nfrom rclpy.action import ActionClient\n"
            "ActionClient(node, Fibonacci, 'count').wait_for_server()",
            "wait_for_server(): it waited for the action count, whose server is not there.",
        ),
        (
            "node.create_service(Trigger, 's', lambda request, response: response)\n"
            "def tick():\n    future = client.call_async(Trigger.Request())\n"
            "    rclpy.spin_until_future_complete(node, future)\n"
            "node.create_timer(1.0, tick)\nrclpy.spin(node)",
            "spin_until_future_complete(node, future): it waited inside of a callback",
        ),
        (
            "import time\nnode.create_service(Trigger, 's', lambda request, response: response)\n"
            "def tick():\n    future = client.call_async(Trigger.Request())\n"
            "    while not future.done():\n        time.sleep(0.1)\n"
            "node.create_timer(1.0, tick)\nrclpy.spin(node)",
            "time.sleep(0.1): the response is received only after this callback has ended",
        ),
        (
            "def tick():\n    rclpy.spin_once(node)\nnode.create_timer(1.0, tick)\nrclpy.spin(node)",
            "rclpy.spin_once(node): a callback that spins waits for another callback",
        ),
        (
            "import time\ndef tick():\n    while rclpy.ok():\n        time.sleep(0.5)\n"
            "node.create_timer(1.0, tick)\nrclpy.spin(node)",
            "time.sleep(0.5): this callback has not returned",
        ),
    ],
)
def test_endless_wait_is_reported_with_its_line(
    lines: str, hint: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "program.py").write_text(ALONE + lines)
    with use_graph(Graph(end_ns=START_NS + 5 * 10**9)):
        assert run_files([tmp_path / "program.py"], seed=1) == 0
    (line,) = capfd.readouterr().out.splitlines()
    assert line.startswith("hint: ")
    assert "program.py, line " in line
    assert hint in line


@pytest.mark.parametrize(
    "program",
    [
        SPUN,
        f"{ALONE}rclpy.spin(node)",
        # The callback sleeps when the run ends, but for a short time.
        f"{ALONE}import time\nnode.create_timer(0.5, lambda: time.sleep(0.3))\nrclpy.spin(node)",
        f"{ALONE}node.create_timer(1.0, lambda: rclpy.spin_once(node, timeout_sec=0.1))\nrclpy.spin(node)",
        f"{ALONE}\nwhile rclpy.ok():\n    client.wait_for_service(timeout_sec=1.0)",
        # Its last call before the sleep is not a poll.
        f"{ALONE}\nimport time\npublisher = node.create_publisher(Trigger.Event, 't', 1)\n"
        "while rclpy.ok():\n    publisher.get_subscription_count()\n    publisher.publish(Trigger.Event())\n"
        "    time.sleep(0.5)",
    ],
)
def test_end_of_a_finite_wait_has_no_hint(
    program: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "program.py").write_text(program)
    with use_graph(Graph(end_ns=START_NS + 5 * 10**9)):
        assert run_files([tmp_path / "program.py"], seed=1) == 0
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("lines", "hint"),
    [
        ("rclpy.spin", "line 8 names rclpy.spin and does not call it. Write: rclpy.spin(node)"),
        (
            "node.destroy_node",
            "line 8 names node.destroy_node and does not call it. Write: node.destroy_node()",
        ),
        (
            "import threading\nthreading.Thread(target=rclpy.spin(node)).start()",
            "line 9 calls rclpy.spin here, and not in the thread. "
            "Write: Thread(target=rclpy.spin, args=(node,))",
        ),
        (
            "while rclpy.ok:\n    rclpy.spin(node)",
            "line 8 names rclpy.ok and does not call it. Write: rclpy.ok()",
        ),
        (
            "assert not (client := node.create_client(Trigger, 't')).service_is_ready()\n"
            "if rclpy.ok() and not client.wait_for_service:\n    pass",
            "line 9 names client.wait_for_service and does not call it. Write: client.wait_for_service()",
        ),
        ("node.done = False\nif node.done:\n    pass", ""),
        ("import threading\nthreading.Thread(target=node.destroy_node).start()", ""),
        ("node.destroy_node()", ""),
    ],
)
def test_statement_without_its_call_has_a_hint(
    lines: str, hint: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "program.py").write_text(ALONE + lines)
    with use_graph(Graph(end_ns=START_NS + 5 * 10**9)):
        assert run_files([tmp_path / "program.py"], seed=1) == 0
    assert capfd.readouterr().err == (f"hint: program.py, {hint}\n" if hint else "")


@pytest.mark.parametrize(
    ("lines", "names"),
    [
        ("node.create_timer(1.0, print)", "/n"),
        (
            "node.create_subscription(Trigger.Event, 't', print, 1)\nnode.destroy_node()\nrclpy.shutdown()",
            "/n",
        ),
        ("other = rclpy.create_node('other')\nother.create_timer(1.0, print)\nrclpy.spin(node)", "/other"),
    ],
)
def test_node_that_is_never_spun_is_reported(
    lines: str, names: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "program.py").write_text(ALONE + lines)
    with use_graph(Graph(end_ns=START_NS + 5 * 10**9)):
        assert run_files([tmp_path / "program.py"], seed=1) == 0
    report, hint = capfd.readouterr().err.splitlines()
    assert report == f"program.py ended without a spin of {names}."
    assert hint.startswith("hint: timers and subscriptions call their functions only while")


@pytest.mark.parametrize(
    "lines",
    [
        "node.create_publisher(Trigger.Event, 't', 1)",
        "timer = node.create_timer(1.0, print)\nnode.destroy_timer(timer)",
        "node.create_timer(1.0, lambda: None)\nrclpy.spin_once(node, timeout_sec=0.1)",
        "node.create_subscription(Trigger.Event, 't', print, 1)\nraise SystemExit(1)",
    ],
)
def test_program_that_spins_or_has_no_callbacks_has_no_report(
    lines: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "program.py").write_text(ALONE + lines)
    with use_graph(Graph(end_ns=START_NS + 5 * 10**9)):
        run_files([tmp_path / "program.py"], seed=1)
    assert capfd.readouterr() == ("", "")
