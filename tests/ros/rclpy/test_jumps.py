"""Callbacks at clock jumps, with rclpy's rules and texts."""

from collections.abc import Callable

import pytest
from rclpy.clock import Clock, ClockChange, ClockType, JumpThreshold, ROSClock, TimeJump
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from rclpy.time_source import TimeSource

from tests.ros.rclpy.simulator import ROBOT, SIM, say_time, seconds

BACK = JumpThreshold(min_forward=None, min_backward=Duration(seconds=-1), on_clock_change=False)


def test_jump_callbacks_are_called_for_jumps_beyond_their_threshold(follower: Node) -> None:
    calls: list[tuple[str, float, object]] = []
    clock = follower.get_clock()

    def note(name: str) -> Callable[[TimeJump], None]:
        return lambda jump: calls.append((name, seconds(clock), jump.delta.nanoseconds * 1e-9))

    forward = JumpThreshold(min_forward=Duration(seconds=2), min_backward=None, on_clock_change=False)
    handle = clock.create_jump_callback(
        forward,
        pre_callback=lambda: calls.append(("before", seconds(clock), None)),
        post_callback=note("forward"),
    )
    clock.create_jump_callback(BACK, post_callback=note("back"))
    for now in (10.0, 11.9, 11.0, 9.9):
        say_time(follower, now)
    assert calls == [("before", 0.0, None), ("forward", 10.0, 10.0), ("back", 9.9, -1.1)]
    handle.unregister()
    handle.unregister()
    say_time(follower, 50.0)
    assert len(calls) == 3


def test_jump_callbacks_are_called_when_the_time_source_changes(node: Node) -> None:
    changes: list[tuple[ClockChange, Duration]] = []
    on_change = JumpThreshold(min_forward=None, min_backward=None)
    with node.get_clock().create_jump_callback(
        on_change, post_callback=lambda jump: changes.append((jump.clock_change, jump.delta))
    ):
        for value in (SIM, SIM, ROBOT):
            node.set_parameters([value])
    node.set_parameters([SIM])
    assert changes == [
        (ClockChange.ROS_TIME_ACTIVATED, Duration()),
        (ClockChange.ROS_TIME_DEACTIVATED, Duration()),
    ]


def test_exception_in_a_jump_callback_skips_later_callbacks_but_not_the_jump() -> None:
    calls: list[str] = []
    clock = ROSClock()
    clock._set_ros_time_is_active(True)
    any_jump = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=None)

    def wrong() -> None:
        raise LookupError

    clock.create_jump_callback(any_jump, post_callback=lambda jump: calls.append("after"))
    clock.create_jump_callback(any_jump, pre_callback=wrong)
    with pytest.raises(LookupError):
        clock.set_ros_time_override(Time(seconds=3, clock_type=ClockType.ROS_TIME))
    assert (calls, clock.now().nanoseconds) == ([], 3 * 10**9)


@pytest.mark.parametrize(
    ("error", "text", "make"),
    [
        (
            ValueError,
            "min_forward must be a positive non-zero duration",
            lambda: JumpThreshold(min_forward=Duration(), min_backward=None),
        ),
        (
            ValueError,
            "min_backward must be a negative non-zero duration",
            lambda: JumpThreshold(min_forward=None, min_backward=Duration(seconds=1)),
        ),
        (
            ValueError,
            "At least one jump threshold must be enabled",
            lambda: JumpThreshold(min_forward=None, min_backward=None, on_clock_change=False),
        ),
        (
            ValueError,
            "One of pre_callback or post_callback must be callable",
            lambda: Clock().create_jump_callback(BACK),
        ),
        (
            ValueError,
            "pre_callback must be callable if given",
            lambda: Clock().create_jump_callback(BACK, pre_callback=1),  # type: ignore[arg-type]
        ),
        (
            TypeError,
            "clock_change must be an instance of rclpy.clock.ClockChange",
            lambda: TimeJump(2, Duration()),  # type: ignore[arg-type]
        ),
        (
            TypeError,
            "Time must be specified as rclpy.time.Time. Received type: <class 'float'>",
            lambda: ROSClock().set_ros_time_override(1.0),  # type: ignore[arg-type]
        ),
        (
            ValueError,
            "Only clocks with type ROS_TIME can be attached.",
            lambda: TimeSource().attach_clock(Clock()),
        ),
        (
            TypeError,
            "Node must be of type rclpy.node.Node",
            lambda: TimeSource(node=3),  # type: ignore[arg-type]  # the mistake
        ),
    ],
)
def test_invalid_arguments_are_rejected_with_the_error_text_of_rclpy(
    error: type[Exception], text: str, make: Callable[[], object]
) -> None:
    with pytest.raises(error) as raised:
        make()
    assert str(raised.value) == text
