import threading
import time
from collections.abc import Callable

import pytest
import rclpy
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.exceptions import NotInitializedException
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import Int32

from course_lib.ros.baton import DeadlockError
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph, use_graph


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


def test_spin_once_gives_up_at_its_time_limit(node: Node) -> None:
    node.create_timer(5.0, lambda: None)
    rclpy.spin_once(node, timeout_sec=2.0)
    assert since_start(node) == 2.0
    rclpy.spin_once(node, timeout_sec=0)
    assert since_start(node) == 2.0


def test_a_loop_that_polls_lets_time_pass(node: Node) -> None:
    calls: list[float] = []
    node.create_timer(1.0, lambda: calls.append(since_start(node)))
    while len(calls) < 2:
        rclpy.spin_once(node, timeout_sec=0)
    assert calls == pytest.approx([1.0, 2.0])


def test_callbacks_come_in_the_order_of_events_over_all_nodes(begun: Graph) -> None:
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


def test_what_is_ready_in_a_node_waits_until_it_is_added(node: Node) -> None:
    got: list[int] = []
    node.create_subscription(Int32, "x", lambda m: got.append(m.data), 10)
    node.create_publisher(Int32, "x", 10).publish(Int32(data=7))
    other = Node("other")
    rclpy.spin_once(other, timeout_sec=1.0)
    assert got == []
    rclpy.spin_once(node)
    assert got == [7]


def test_what_a_callback_raises_comes_out_of_spin_and_the_node_goes_on(node: Node) -> None:
    calls: list[float] = []

    def fail() -> None:
        calls.append(since_start(node))
        raise KeyError("joint_1")

    node.create_timer(1.0, fail)
    for _ in range(2):
        with pytest.raises(KeyError, match="joint_1"):
            rclpy.spin(node)
    assert calls == [1.0, 2.0]


def test_a_shutdown_in_a_callback_ends_spin_quietly(node: Node) -> None:
    node.create_timer(1.0, rclpy.shutdown)
    rclpy.spin(node)
    assert not rclpy.ok()


@pytest.mark.parametrize(
    ("make", "ends"), [(SingleThreadedExecutor, "raises"), (MultiThreadedExecutor, "returns")]
)
def test_a_shutdown_elsewhere_ends_a_waiting_spin(
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


def test_an_executor_in_a_with_statement_is_shut_down_and_its_spin_ends(node: Node) -> None:
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


def test_a_node_belongs_to_the_executor_it_was_added_to_last(node: Node) -> None:
    first, second = SingleThreadedExecutor(), SingleThreadedExecutor()
    first.add_node(node)
    second.add_node(node)
    assert (first.get_nodes(), second.get_nodes()) == ([], [node])


def test_an_executor_before_init_is_refused(graph: Graph) -> None:
    with pytest.raises(NotInitializedException):
        SingleThreadedExecutor()


def test_a_spin_that_nothing_can_ever_wake_is_named() -> None:
    with use_graph(Graph()):
        rclpy.init(args=[], signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
        node = Node("listener")
        node.create_subscription(Int32, "x", print, 10)
        with pytest.raises(DeadlockError, match="waits for a callback of /listener"):
            rclpy.spin(node)


def test_in_a_single_thread_a_callback_that_sleeps_holds_up_the_others(node: Node) -> None:
    calls: list[float] = []
    sleep_once(node)
    node.create_timer(1.0, lambda: calls.append(since_start(node)))
    rclpy.spin(node)
    assert calls[:3] == pytest.approx([4.0, 5.0, 6.0])


@pytest.mark.parametrize(
    ("group", "expected"),
    [(ReentrantCallbackGroup, [1.0, 2.0, 3.0]), (MutuallyExclusiveCallbackGroup, [4.0, 5.0, 6.0])],
)
def test_in_several_threads_the_callback_group_decides(
    node: Node, group: type[CallbackGroup], expected: list[float]
) -> None:
    calls: list[float] = []
    shared = group()
    sleep_once(node, shared)
    node.create_timer(1.0, lambda: calls.append(since_start(node)), callback_group=shared)
    rclpy.spin(node, MultiThreadedExecutor(4))
    assert calls[:3] == pytest.approx(expected)


def test_no_more_callbacks_are_under_way_than_there_are_threads(node: Node) -> None:
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


def test_what_a_callback_raises_in_a_thread_comes_out_of_spin(node: Node) -> None:
    node.create_timer(1.0, lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        rclpy.spin(node, MultiThreadedExecutor(2))


def test_shutting_down_several_threads_waits_for_their_callbacks(node: Node) -> None:
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


def test_ten_thousand_messages_take_seconds_at_most(node: Node) -> None:
    got: list[int] = []
    node.create_subscription(Int32, "x", lambda m: got.append(m.data), QoSProfile(depth=10_000))
    publisher = node.create_publisher(Int32, "x", 10)
    for number in range(10_000):
        publisher.publish(Int32(data=number))
    rclpy.spin(node)
    assert got == list(range(10_000))
