"""The tutorial's action server, and its clients."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, TypeAlias

from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

SECOND = 10**9  # [ns]


def count(goal: ServerGoalHandle) -> Fibonacci.Result:
    """Execute the tutorial's goal: one number per second, until it is cancelled."""
    numbers = [0, 1]
    while len(numbers) <= goal.request.order:
        if goal.is_cancel_requested:
            goal.canceled()
            return Fibonacci.Result(sequence=numbers)
        numbers.append(numbers[-1] + numbers[-2])
        goal.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        time.sleep(1)
    goal.succeed()
    return Fibonacci.Result(sequence=numbers)


Drive: TypeAlias = "Callable[[Future[Any]], Any]"


def send(client: ActionClient, until_done: Drive, order: int = 3, **more: Any) -> ClientGoalHandle:
    handle = until_done(client.send_goal_async(Fibonacci.Goal(order=order), **more))
    assert isinstance(handle, ClientGoalHandle)
    return handle


def later(node: Node) -> Future[None]:
    """Return a future that is done in two seconds."""
    done: Future[None] = Future()
    node.create_timer(2.0, lambda: done.set_result(None))
    return done
