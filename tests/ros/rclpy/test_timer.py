import threading

import pytest
import rclpy
from rclpy.duration import Duration
from rclpy.exceptions import InvalidHandle
from rclpy.impl.implementation_singleton import RCLError
from rclpy.node import Node

from course_lib.ros.graph.graph import START_NS, Graph


def since_start(node: Node) -> float:
    return (node.get_clock().now().nanoseconds - START_NS) * 1e-9


def test_timer_is_called_first_after_one_full_period(node: Node) -> None:
    calls: list[float] = []
    node.create_timer(2.5, lambda: calls.append(since_start(node)))
    rclpy.spin(node)
    assert calls == pytest.approx([2.5, 5.0, 7.5, 10.0])


def test_missed_periods_are_skipped_and_the_phase_is_kept(node: Node) -> None:
    calls: list[float] = []

    def slow() -> None:
        calls.append(since_start(node))
        if len(calls) == 1:
            node.get_clock().sleep_for(Duration(seconds=2.5))

    node.create_timer(1.0, slow)
    rclpy.spin(node)
    assert calls[:4] == pytest.approx([1.0, 3.5, 4.0, 5.0])


def test_timer_without_spin_does_not_accumulate_calls(node: Node) -> None:
    calls: list[float] = []
    node.create_timer(1.0, lambda: calls.append(since_start(node)))
    node.get_clock().sleep_for(Duration(seconds=3.5))
    for _ in range(3):
        rclpy.spin_once(node, timeout_sec=0.6)
    assert calls == pytest.approx([3.5, 4.0])


def test_canceled_timer_is_inactive_until_it_is_reset(node: Node) -> None:
    calls: list[float] = []
    timer = node.create_timer(1.0, lambda: calls.append(since_start(node)))
    timer.cancel()
    assert timer.is_canceled()
    assert timer.time_until_next_call() is None
    rclpy.spin_once(node, timeout_sec=2.2)
    timer.reset()
    rclpy.spin_once(node)
    assert calls == pytest.approx([3.2])


def test_due_timer_is_not_called_after_it_is_canceled(node: Node) -> None:
    calls: list[float] = []
    timer = node.create_timer(1.0, lambda: calls.append(since_start(node)))
    node.get_clock().sleep_for(Duration(seconds=1.5))
    assert timer.is_ready()
    timer.cancel()
    assert not timer.is_ready()
    rclpy.spin_once(node, timeout_sec=0)
    assert calls == []


def test_timer_reports_its_period_and_times_in_nanoseconds(node: Node) -> None:
    timer = node.create_timer(1.0, print)
    node.get_clock().sleep_for(Duration(seconds=0.25))
    assert timer.timer_period_ns == 10**9
    assert timer.time_since_last_call() == 250_000_000
    assert timer.time_until_next_call() == 750_000_000


def test_timer_without_autostart_waits_for_reset(node: Node) -> None:
    calls: list[float] = []
    timer = node.create_timer(1.0, lambda: calls.append(since_start(node)), autostart=False)
    rclpy.spin_once(node, timeout_sec=3.0)
    assert timer.is_canceled()
    timer.reset()
    rclpy.spin_once(node)
    assert calls == pytest.approx([4.0])


def test_timer_with_period_zero_is_always_ready_and_time_advances(node: Node, started_graph: Graph) -> None:
    calls: list[float] = []
    timer = node.create_timer(0, lambda: calls.append(since_start(node)))
    assert timer.is_ready()
    rclpy.spin(node)
    assert len(calls) == 10_000
    assert started_graph.ended


def test_negative_period_is_rejected_as_in_ros(node: Node) -> None:
    with pytest.raises(RCLError, match=r"^failed to create timer: timer period must be non-negative"):
        node.create_timer(-1.0, print)


def test_destroyed_timer_is_not_called_and_cannot_be_used(node: Node) -> None:
    calls: list[float] = []
    timer = node.create_timer(1.0, lambda: calls.append(0.0))
    assert node.destroy_timer(timer)
    rclpy.spin_once(node, timeout_sec=5.0)
    assert calls == []
    with pytest.raises(InvalidHandle):
        timer.cancel()


def test_rate_keeps_a_loop_at_its_frequency_while_another_thread_spins(node: Node) -> None:
    thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    thread.start()
    rate = node.create_rate(2.0)
    times = []
    for _ in range(3):
        rate.sleep()
        times.append(since_start(node))
    assert times == pytest.approx([0.5, 1.0, 1.5])


def test_destroyed_rate_does_not_sleep(node: Node) -> None:
    rate = node.create_rate(1.0)
    node.destroy_rate(rate)
    with pytest.raises(RuntimeError, match=r"^Rate cannot sleep because it has been destroyed$"):
        rate.sleep()
    with pytest.raises(ValueError, match=r"^frequency must be > 0$"):
        node.create_rate(0)
