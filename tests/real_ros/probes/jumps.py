# mypy: ignore-errors
"""Jumps of simulated time, and comparisons of times of each pair of clock types."""

import operator
from typing import Any

from probing import lines, main, outcome, probe
from rclpy.clock import Clock, ClockChange, ClockType, JumpHandle, JumpThreshold, ROSClock, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time

CLOCKS = (ClockType.SYSTEM_TIME, ClockType.STEADY_TIME, ClockType.ROS_TIME)
OPERATORS = ("eq", "ne", "lt", "le", "gt", "ge", "sub", "add")


def _compare(name: str, left: Any, right: Any) -> Any:
    return lambda: getattr(operator, name)(left, right)


lines(
    "clocks",
    **{
        f"{name}_{left.name}_{right.name}": _compare(
            name, Time(seconds=1, clock_type=left), Time(seconds=2, clock_type=right)
        )
        for name in OPERATORS
        for left in CLOCKS
        for right in CLOCKS
    },
)
VALUES = {
    "time": Time(seconds=2),
    "duration": Duration(seconds=1),
    "number": 1,
    "fraction": 0.5,
    "text": "1",
    "nothing": None,
    "message": Time(seconds=2).to_msg(),
}
lines(
    "mixed",
    **{
        f"{name}_{left}_{right}": _compare(name, VALUES[left], VALUES[right])
        for name in OPERATORS
        for left, right in (
            ("time", "duration"),
            ("duration", "time"),
            ("time", "number"),
            ("duration", "fraction"),
            ("number", "duration"),
            ("time", "text"),
            ("duration", "nothing"),
            ("time", "message"),
        )
    },
)


def _simulated(seconds: float = 10.0) -> ROSClock:
    clock: Any = ROSClock()
    clock._set_ros_time_is_active(True)
    clock.set_ros_time_override(_at(seconds))
    return clock


def _at(seconds: float) -> Time:
    return Time(seconds=seconds, clock_type=ClockType.ROS_TIME)


def _jumps(
    *seconds: float, forward: float | None = None, backward: float | None = None, change: bool = False
) -> list[Any]:
    """Return the jumps that a threshold reports while a simulated clock, which begins at 10 s, is set."""
    clock, jumps = _simulated(), []
    threshold = JumpThreshold(
        min_forward=None if forward is None else Duration(seconds=forward),
        min_backward=None if backward is None else Duration(seconds=backward),
        on_clock_change=change,
    )
    # The real rclpy crashes at a jump if nothing keeps the handle.
    handle = clock.create_jump_callback(
        threshold, post_callback=lambda jump: jumps.append((jump.clock_change.name, jump.delta.nanoseconds))
    )
    for second in seconds:
        clock.set_ros_time_override(_at(second))
    handle.unregister()
    return jumps


lines(
    "jump",
    forward_below=lambda: _jumps(10.9, forward=1.0),
    forward_equal=lambda: _jumps(11.0, forward=1.0),
    forward_above=lambda: _jumps(12.0, forward=1.0),
    forward_in_steps=lambda: _jumps(10.6, 11.2, 11.8, forward=1.0),
    forward_of_backward=lambda: _jumps(5.0, forward=1.0),
    backward_below=lambda: _jumps(9.1, backward=-1.0),
    backward_equal=lambda: _jumps(9.0, backward=-1.0),
    backward_above=lambda: _jumps(8.0, backward=-1.0),
    backward_of_forward=lambda: _jumps(50.0, backward=-1.0),
    both=lambda: _jumps(20.0, 5.0, forward=1.0, backward=-1.0),
    smallest=lambda: _jumps(10.0, 10.000000001, forward=1e-9),
    same_time=lambda: _jumps(10.0, forward=1e-9, backward=-1e-9),
    only_change=lambda: _jumps(50.0, 0.0, change=True),
    to_zero=lambda: _jumps(0.0, backward=-1.0),
)


@probe
def order_of_jump_callbacks() -> list[Any]:
    clock, calls = _simulated(), []
    threshold = JumpThreshold(min_forward=Duration(seconds=1), min_backward=None)
    handles = [
        clock.create_jump_callback(
            threshold,
            pre_callback=lambda name=name: calls.append((name, clock.now().nanoseconds)),
            post_callback=lambda jump, name=name: calls.append((name, clock.now().nanoseconds, "after")),
        )
        for name in "ab"
    ]
    clock.set_ros_time_override(_at(20.0))
    for handle in handles:
        handle.unregister()
    return calls


@probe
def change_of_the_time_source() -> list[Any]:
    clock, jumps = ROSClock(), []
    threshold = JumpThreshold(min_forward=None, min_backward=None, on_clock_change=True)
    handle = clock.create_jump_callback(
        threshold, post_callback=lambda jump: jumps.append(jump.clock_change.name)
    )
    for is_active in (True, True, False, False, True):
        clock._set_ros_time_is_active(is_active)
    handle.unregister()
    return jumps


@probe
def jumps_in_a_with_statement() -> list[Any]:
    clock, jumps = _simulated(), []
    threshold = JumpThreshold(min_forward=Duration(seconds=1), min_backward=None)
    with clock.create_jump_callback(threshold, post_callback=lambda jump: jumps.append(1)) as handle:
        clock.set_ros_time_override(_at(20.0))
        kind = type(handle).__name__
    clock.set_ros_time_override(_at(40.0))
    return [kind, jumps]


@probe
def jump_callback_that_raises() -> list[Any]:
    clock, jumps = _simulated(), []
    threshold = JumpThreshold(min_forward=Duration(seconds=1), min_backward=None)
    handles = [
        clock.create_jump_callback(threshold, post_callback=callback)
        for callback in (lambda jump: 1 / 0, lambda jump: jumps.append(1))
    ]
    raised = outcome(lambda: clock.set_ros_time_override(_at(20.0)))
    for handle in handles:
        handle.unregister()
    return [raised, jumps, clock.now()]


@probe
def handle_unregistered_twice() -> list[Any]:
    clock = _simulated()
    threshold = JumpThreshold(min_forward=Duration(seconds=1), min_backward=None)
    handle = clock.create_jump_callback(threshold, post_callback=lambda jump: None)
    return [handle.unregister(), outcome(handle.unregister)]


@probe
def jumps_by_the_parameter_of_a_node() -> list[Any]:
    node, jumps = Node("n"), []
    threshold = JumpThreshold(min_forward=None, min_backward=None, on_clock_change=True)
    handle = node.get_clock().create_jump_callback(
        threshold, post_callback=lambda jump: jumps.append(jump.clock_change.name)
    )
    for value in (True, True, False):
        node.set_parameters([Parameter("use_sim_time", value=value)])
    handle.unregister()
    return jumps


_FORWARD = JumpThreshold(min_forward=Duration(seconds=1), min_backward=None)
lines(
    "handle",
    pre_text=lambda: Clock().create_jump_callback(_FORWARD, pre_callback="x"),
    post_text=lambda: Clock().create_jump_callback(_FORWARD, post_callback="x"),
    pre_only=lambda: type(Clock().create_jump_callback(_FORWARD, pre_callback=print)).__name__,
    without_threshold=lambda: Clock().create_jump_callback(post_callback=print),
    threshold_none=lambda: Clock().create_jump_callback(None, post_callback=print),
    threshold_duration=lambda: Clock().create_jump_callback(Duration(seconds=1), post_callback=print),
    system_clock=lambda: type(Clock().create_jump_callback(_FORWARD, post_callback=print)) is JumpHandle,
    threshold_positional=lambda: JumpThreshold(Duration(seconds=1), None),
    threshold_defaults=lambda: JumpThreshold(),
    threshold_fields=lambda: (lambda one: (one.min_forward, one.min_backward, one.on_clock_change))(_FORWARD),
    threshold_text=lambda: JumpThreshold(min_forward="1", min_backward=None),
    jump_fields=lambda: (lambda one: (one.clock_change, one.delta))(
        TimeJump(ClockChange.ROS_TIME_NO_CHANGE, Duration(seconds=1))
    ),
    jump_of_a_number=lambda: TimeJump(1, Duration(seconds=1)),
    jump_is_readonly=lambda: setattr(TimeJump(ClockChange.ROS_TIME_ACTIVATED, None), "delta", 1),
    changes=lambda: [(one.name, one.value) for one in ClockChange],
    override_of_a_system_time=lambda: _simulated().set_ros_time_override(Time(seconds=1)),
    override_of_a_steady_time=lambda: _simulated().set_ros_time_override(
        Time(seconds=1, clock_type=ClockType.STEADY_TIME)
    ),
    override_of_a_message=lambda: _simulated().set_ros_time_override(Time(seconds=1).to_msg()),
    override_of_nothing=lambda: _simulated().set_ros_time_override(None),
    override_while_inactive=lambda: (
        lambda clock: [clock.set_ros_time_override(_at(3.0)), clock.now().nanoseconds > 10**18]
    )(ROSClock()),
    active_of_a_number=lambda: ROSClock()._set_ros_time_is_active(1),
    now_of_simulated=lambda: _simulated().now(),
    now_of_simulated_as_seconds=lambda: _simulated(3.25).now().seconds_nanoseconds(),
    now_of_simulated_as_message=lambda: _simulated(3.25).now().to_msg(),
    text_of_a_ros_clock=lambda: repr(ROSClock()),
    text_of_a_simulated_clock=lambda: str(_simulated()),
    class_of_a_ros_clock=lambda: type(Clock(clock_type=ClockType.ROS_TIME)).__name__,
    class_of_a_nodes_clock=lambda: type(Node("n").get_clock()).__name__,
    type_of_a_nodes_clock=lambda: Node("n").get_clock().clock_type,
    same_clock=lambda: (lambda node: node.get_clock() is node.get_clock())(Node("n")),
)


if __name__ == "__main__":
    main()
