import pytest
import rclpy
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node


def test_repeated_triggers_call_the_callback_once(node: Node) -> None:
    calls: list[int] = []
    guard = node.create_guard_condition(lambda: calls.append(1))
    assert list(node.guards) == [guard]
    guard.trigger()
    guard.trigger()
    for _ in range(3):
        rclpy.spin_once(node, timeout_sec=0.1)
    assert calls == [1]
    guard.trigger()
    rclpy.spin_once(node, timeout_sec=0.1)
    assert calls == [1, 1]


def test_destroyed_guard_condition_does_not_call_its_callback(node: Node) -> None:
    guard = node.create_guard_condition(lambda: pytest.fail("it was destroyed"))
    guard.trigger()
    node.destroy_guard_condition(guard)
    rclpy.spin_once(node, timeout_sec=0.1)
    with pytest.raises(InvalidHandle):
        guard.trigger()
