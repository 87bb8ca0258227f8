# mypy: ignore-errors
"""Timers: periods, cancelling, resetting, and how often they are called.

Many of the calls are wrong on purpose.
"""

import time
from typing import Any

import rclpy
from probing import lines, main, outcome, probe
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from rclpy.timer import Timer


def _timer(period: Any = 0.1, callback: Any = print, **more: Any) -> Timer:
    node = Node("n")
    timer = node.create_timer(period, callback, **more)
    timer.keep_node = node  # type: ignore[attr-defined]
    return timer


def _spin(node: Node, seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.02)


lines(
    "create",
    zero=lambda: _timer(0).timer_period_ns,
    negative=lambda: _timer(-1),
    text=lambda: _timer("1"),
    none=lambda: _timer(None),
    duration=lambda: _timer(Duration(seconds=1)),
    integer=lambda: _timer(2).timer_period_ns,
    tiny=lambda: _timer(1e-10).timer_period_ns,
    huge=lambda: _timer(1e12),
    infinite=lambda: _timer(float("inf")),
    nan=lambda: _timer(float("nan")),
    no_callback=lambda: _timer(1.0, None).callback,
    wrong_callback=lambda: _timer(1.0, 3).callback,
    wrong_group=lambda: _timer(1.0, print, callback_group=3),
    wrong_clock=lambda: _timer(1.0, print, clock=3),
    without_autostart=lambda: _timer(1.0, print, autostart=False).is_canceled(),
    without_autostart_next=lambda: _timer(1.0, print, autostart=False).time_until_next_call(),
    steady=lambda: _timer(1.0, print, clock=Clock(clock_type=ClockType.STEADY_TIME)).clock.clock_type,
    group=lambda: (
        type(_timer(1.0, print, callback_group=MutuallyExclusiveCallbackGroup()).callback_group).__name__
    ),
)
lines(
    "state",
    canceled=lambda: _timer().is_canceled(),
    ready=lambda: _timer().is_ready(),
    period=lambda: _timer(0.25).timer_period_ns,
    set_period=lambda: setattr(_timer(0.25), "timer_period_ns", 10**9),
    set_period_float=lambda: setattr(_timer(0.25), "timer_period_ns", 1e9),
    set_period_negative=lambda: setattr(_timer(0.25), "timer_period_ns", -1),
    set_period_text=lambda: setattr(_timer(0.25), "timer_period_ns", "1"),
    since_last_call=lambda: _timer().time_since_last_call() < 10**8,
    until_next_call=lambda: 0 < _timer(1.0).time_until_next_call() <= 10**9,
    until_next_call_canceled=lambda: _canceled().time_until_next_call(),
    cancel=lambda: _timer().cancel(),
    reset=lambda: _timer().reset(),
    destroy=lambda: _timer().destroy(),
    canceled_ready=lambda: _canceled().is_ready(),
    text=lambda: type(_timer()).__name__,
    in_with=lambda: _in_with(),
)


def _canceled() -> Timer:
    timer = _timer()
    timer.cancel()
    return timer


def _in_with() -> list[Any]:
    with _timer() as timer:
        inside = timer.is_canceled()
    return [inside, outcome(timer.is_canceled)]


@probe
def destroyed_timer() -> list[str]:
    timer = _timer()
    timer.destroy()
    calls = [timer.is_canceled, timer.is_ready, timer.cancel, timer.reset, timer.time_until_next_call]
    return [outcome(call) for call in calls] + [outcome(lambda: timer.timer_period_ns)]


@probe
def timer_of_a_node_is_destroyed() -> list[Any]:
    node = Node("n")
    timer = node.create_timer(0.1, print)
    return [node.destroy_timer(timer), node.destroy_timer(timer), len(list(node.timers))]


@probe
def timer_of_another_node() -> list[Any]:
    node, other = Node("n"), Node("m")
    timer = node.create_timer(0.1, print)
    return [other.destroy_timer(timer), len(list(node.timers))]


@probe
def calls_in_a_second() -> int:
    node, calls = Node("n"), []
    node.create_timer(0.2, lambda: calls.append(1))
    _spin(node, 1.1)
    return len(calls)


@probe
def one_shot() -> list[Any]:
    node, calls = Node("n"), []
    timer = node.create_timer(0.05, lambda: (calls.append(1), timer.cancel()))
    _spin(node, 0.4)
    first = len(calls)
    timer.reset()
    _spin(node, 0.4)
    return [first, len(calls), timer.is_canceled()]


@probe
def timer_that_destroys_itself() -> list[Any]:
    node, calls = Node("n"), []
    timer = node.create_timer(0.05, lambda: (calls.append(1), node.destroy_timer(timer)))
    _spin(node, 0.4)
    return [len(calls), len(list(node.timers))]


@probe
def timer_that_creates_timers() -> int:
    node, calls = Node("n"), []

    def more() -> None:
        first.cancel()
        node.create_timer(0.1, lambda: calls.append(1))
        node.create_timer(0.1, lambda: calls.append(1))

    first = node.create_timer(0.1, more)
    _spin(node, 0.35)
    return len(calls)


@probe
def slow_callback_skips_periods() -> int:
    node, calls = Node("n"), []
    node.create_timer(0.1, lambda: (calls.append(1), time.sleep(0.25)))
    _spin(node, 1.3)
    return len(calls)


@probe
def zero_period_with_limits() -> bool:
    node, calls = Node("n"), []
    node.create_timer(0.0, lambda: calls.append(1))
    for _ in range(10):
        rclpy.spin_once(node, timeout_sec=0.1)
    return len(calls) == 10


@probe
def callback_with_an_argument() -> list[Any]:
    node, found = Node("n"), []
    node.create_timer(0.05, lambda info: found.append(type(info).__name__))
    error = outcome(_spin, node, 0.2)
    return [error, found[:1]]


@probe
def exception_of_a_callback() -> list[str]:
    node = Node("n")
    node.create_timer(0.05, lambda: 1 / 0)
    return [outcome(_spin, node, 0.2), outcome(_spin, node, 0.2)]


@probe
def coroutine_as_callback() -> list[Any]:
    node, found, future = Node("n"), [], Future()

    async def wait() -> None:
        timer.cancel()
        found.append(await future)

    timer = node.create_timer(0.05, wait)
    node.create_timer(0.2, lambda: future.set_result("done") if not future.done() else None)
    _spin(node, 0.2)
    others_wait = list(found)
    node.default_callback_group  # noqa: B018
    return [others_wait, future.done()]


@probe
def order_of_timers_with_one_period() -> list[str]:
    node, found = Node("n"), []
    for name in "abc":
        node.create_timer(0.1, lambda name=name: found.append(name))
    _spin(node, 0.15)
    return found


@probe
def timers_of_two_nodes() -> list[str]:
    one, two, found = Node("n"), Node("m"), []
    executor = SingleThreadedExecutor()
    executor.add_node(two)
    executor.add_node(one)
    one.create_timer(0.1, lambda: found.append("n"))
    two.create_timer(0.1, lambda: found.append("m"))
    end = time.monotonic() + 0.15
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)
    return sorted(found)


@probe
def exclusive_group_in_many_threads() -> bool:
    node, running, together = Node("n"), [], []

    def work() -> None:
        running.append(1)
        together.append(len(running))
        time.sleep(0.02)
        running.pop()

    node.create_timer(0.01, work)
    node.create_timer(0.01, work)
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    end = time.monotonic() + 0.4
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)
    executor.shutdown()
    return max(together) == 1


if __name__ == "__main__":
    main()
