# mypy: ignore-errors
"""Times, durations, clocks and jumps.

Many of the calls are wrong on purpose.
"""

from typing import Any

from builtin_interfaces.msg import Duration as DurationMsg
from builtin_interfaces.msg import Time as TimeMsg
from probing import lines, main, probe
from rclpy.clock import Clock, ClockChange, ClockType, JumpThreshold, ROSClock
from rclpy.duration import Duration, Infinite
from rclpy.node import Node
from rclpy.time import Time
from rclpy.timer import Rate

S = 10**9


lines(
    "duration",
    seconds=lambda: Duration(seconds=1.5),
    negative=lambda: Duration(seconds=-1.5),
    both=lambda: Duration(seconds=1, nanoseconds=-1),
    float_nanoseconds=lambda: Duration(nanoseconds=1.7).nanoseconds,
    text=lambda: str(Duration(seconds=2)),
    too_big=lambda: Duration(seconds=2**40),
    text_seconds=lambda: Duration(seconds="1"),
    none=lambda: Duration(seconds=None),
    positional=lambda: Duration(1),
    infinite=lambda: Infinite,
    equal=lambda: Duration(seconds=1) == Duration(nanoseconds=S),
    equal_int=lambda: Duration(nanoseconds=1) == 1,
    not_equal_int=lambda: Duration(nanoseconds=1) != 1,
    less=lambda: Duration(seconds=1) < Duration(seconds=2),
    less_int=lambda: Duration(seconds=1) < 2,
    at_least=lambda: Duration(seconds=1) >= Duration(seconds=1),
    plus=lambda: Duration(seconds=1) + Duration(seconds=2),
    minus=lambda: Duration(seconds=1) - Duration(seconds=2),
    times=lambda: Duration(seconds=1) * 2,
    half=lambda: Duration(seconds=1) / 2,
    negated=lambda: -Duration(seconds=1),
    hashed=lambda: hash(Duration(seconds=1)),
    bool_of_zero=lambda: bool(Duration()),
    to_msg=lambda: Duration(seconds=1.25).to_msg(),
    negative_to_msg=lambda: Duration(seconds=-0.25).to_msg(),
    from_msg=lambda: Duration.from_msg(DurationMsg(sec=1, nanosec=5)),
    from_time_msg=lambda: Duration.from_msg(TimeMsg(sec=1, nanosec=5)),
    from_int=lambda: Duration.from_msg(1),
    assigned=lambda: setattr(Duration(), "nanoseconds", 3),
)
lines(
    "time",
    plain=lambda: Time(seconds=1.5),
    text=lambda: str(Time(seconds=2, clock_type=ClockType.ROS_TIME)),
    negative=lambda: Time(seconds=-1),
    negative_nanoseconds=lambda: Time(nanoseconds=-1),
    mixed=lambda: Time(seconds=2, nanoseconds=-1),
    too_big=lambda: Time(seconds=2**40),
    wrong_clock=lambda: Time(clock_type=1),
    text_clock=lambda: Time(clock_type="ROS_TIME"),
    seconds_nanoseconds=lambda: Time(nanoseconds=S + 5).seconds_nanoseconds(),
    minus=lambda: Time(seconds=3) - Time(seconds=1),
    minus_duration=lambda: Time(seconds=3) - Duration(seconds=1),
    plus_duration=lambda: Time(seconds=3) + Duration(seconds=1),
    duration_plus=lambda: Duration(seconds=1) + Time(seconds=3),
    plus_time=lambda: Time(seconds=3) + Time(seconds=1),
    plus_float=lambda: Time(seconds=3) + 1.0,
    below_zero=lambda: Time(seconds=1) - Duration(seconds=2),
    beyond=lambda: Time(nanoseconds=2**63 - 1) + Duration(nanoseconds=1),
    other_clock=lambda: Time(seconds=1) - Time(seconds=1, clock_type=ClockType.ROS_TIME),
    equal_other_clock=lambda: Time() == Time(clock_type=ClockType.ROS_TIME),
    less_other_clock=lambda: Time() < Time(clock_type=ClockType.ROS_TIME),
    equal_int=lambda: Time(nanoseconds=1) == 1,
    less_int=lambda: Time(nanoseconds=1) < 1,
    less=lambda: Time(seconds=1) < Time(seconds=2),
    to_msg=lambda: Time(seconds=1.25).to_msg(),
    from_msg=lambda: Time.from_msg(TimeMsg(sec=1, nanosec=5)),
    from_msg_clock=lambda: Time.from_msg(TimeMsg(sec=1), clock_type=ClockType.STEADY_TIME).clock_type,
    from_duration_msg=lambda: Time.from_msg(DurationMsg(sec=1)),
    hashed=lambda: hash(Time(seconds=1)),
    assigned=lambda: setattr(Time(), "nanoseconds", 3),
    msg_minus=lambda: TimeMsg(sec=2) - TimeMsg(sec=1),
    msg_less=lambda: TimeMsg(sec=1) < TimeMsg(sec=2),
    msg_negative_nanosec=lambda: Time.from_msg(TimeMsg(sec=-1)),
)
lines(
    "clock",
    default=lambda: Clock(),
    steady=lambda: Clock(clock_type=ClockType.STEADY_TIME),
    ros=lambda: Clock(clock_type=ClockType.ROS_TIME),
    ros_class=lambda: ROSClock(),
    wrong_type=lambda: Clock(clock_type="x"),
    type_of_now=lambda: Clock().now().clock_type,
    steady_now_type=lambda: Clock(clock_type=ClockType.STEADY_TIME).now().clock_type,
    is_active=lambda: ROSClock().ros_time_is_active,
    is_active_of_system=lambda: Clock().ros_time_is_active,
    set_override_without=lambda: ROSClock().set_ros_time_override(Time(seconds=1)),
    types=lambda: [(one.name, one.value) for one in ClockType],
    type_repr=lambda: ClockType.ROS_TIME,
    changes=lambda: list(ClockChange.__members__) if hasattr(ClockChange, "__members__") else None,
    threshold=lambda: (
        JumpThreshold(
            min_forward=Duration(seconds=1), min_backward=Duration(seconds=-1), on_clock_change=True
        ).on_clock_change
    ),
    threshold_zero=lambda: JumpThreshold(min_forward=Duration(), min_backward=None),
    threshold_backward=lambda: JumpThreshold(min_forward=None, min_backward=Duration(seconds=1)),
    threshold_backward_zero=lambda: JumpThreshold(min_forward=None, min_backward=Duration()),
    threshold_nothing=lambda: JumpThreshold(min_forward=None, min_backward=None, on_clock_change=False),
    threshold_int=lambda: JumpThreshold(min_forward=1, min_backward=None),
    jump_without=lambda: Clock().create_jump_callback(
        JumpThreshold(min_forward=Duration(seconds=1), min_backward=None)
    ),
    sleep_for=lambda: Clock().sleep_for(Duration(seconds=0.05)),
    sleep_for_negative=lambda: Clock().sleep_for(Duration(seconds=-1)),
    sleep_for_float=lambda: Clock().sleep_for(0.1),
    sleep_until_past=lambda: Clock().sleep_until(Time(seconds=1, clock_type=ClockType.SYSTEM_TIME)),
    sleep_until_other=lambda: Clock().sleep_until(Time(clock_type=ClockType.STEADY_TIME)),
    sleep_until_none=lambda: Clock().sleep_until(None),
)


def _overridden() -> ROSClock:
    clock: Any = ROSClock()
    clock._set_ros_time_is_active(True)
    clock.set_ros_time_override(Time(seconds=5, clock_type=ClockType.ROS_TIME))
    return clock


@probe
def simulated_clock() -> list[Any]:
    clock = _overridden()
    before = clock.now()
    clock.set_ros_time_override(Time(seconds=7, clock_type=ClockType.ROS_TIME))
    return [before, clock.now(), clock.ros_time_is_active]


@probe
def jumps_of_a_simulated_clock() -> list[Any]:
    clock, seen = _overridden(), []
    threshold = JumpThreshold(min_forward=Duration(seconds=1), min_backward=Duration(seconds=-1))
    handle = clock.create_jump_callback(
        threshold,
        pre_callback=lambda: seen.append("before"),
        post_callback=lambda jump: seen.append((str(jump.clock_change), jump.delta.nanoseconds)),
    )
    for seconds in (5.5, 8.0, 7.5, 2.0):
        clock.set_ros_time_override(Time(seconds=seconds, clock_type=ClockType.ROS_TIME))
        seen.append(seconds)
    handle.unregister()
    clock.set_ros_time_override(Time(seconds=99, clock_type=ClockType.ROS_TIME))
    return seen


@probe
def a_wrong_override() -> None:
    _overridden().set_ros_time_override(5)


@probe
def parameter_use_sim_time() -> list[Any]:
    node = Node("n")
    found: list[Any] = [node.get_parameter("use_sim_time").value, node.get_clock().ros_time_is_active]
    from rclpy.parameter import Parameter

    found.append(node.set_parameters([Parameter("use_sim_time", value=True)])[0])
    found += [node.get_clock().ros_time_is_active, node.get_clock().now()]
    found.append(node.set_parameters([Parameter("use_sim_time", value=1)])[0])
    return found


lines(
    "rate",
    zero=lambda: Node("n").create_rate(0),
    negative=lambda: Node("n").create_rate(-1),
    text=lambda: Node("n").create_rate("1"),
    none=lambda: Node("n").create_rate(None),
    kind=lambda: isinstance(Node("n").create_rate(1.0), Rate),
    wrong_clock=lambda: Node("n").create_rate(1.0, clock=3),
)


if __name__ == "__main__":
    main()
