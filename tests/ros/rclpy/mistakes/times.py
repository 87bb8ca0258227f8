"""Times and durations."""

# (program, last line of the error, hint below it)
TIMES = [
    (
        "node.get_clock().now() - Time()",
        "TypeError: Can't subtract times with different clock types",
        "write `Time(clock_type=ClockType.ROS_TIME)`.",
    ),
    (
        "node.get_clock().now() > 5.0",
        "TypeError: '>' not supported between instances of 'Time' and 'float'",
        "compare with a Time or a Duration: `Duration(seconds=5.0)`.",
    ),
    (
        "stamp = node.get_clock().now().to_msg()\nstamp - stamp",
        "TypeError: unsupported operand type(s) for -: 'Time' and 'Time'",
        "messages cannot be subtracted: `Time.from_msg(stamp)` can.",
    ),
    (
        "node.get_clock().now() - 1.0",
        "TypeError: unsupported operand type(s) for -: 'Time' and 'float'",
        "add or subtract a Duration: `Duration(seconds=1.0)`.",
    ),
    (
        "Duration(1.0)",
        "TypeError: Duration.__init__() takes 1 positional argument but 2 were given",
        "pass the argument by name: `Duration(seconds=1.0)`.",
    ),
    (
        "Time(seconds=-1)",
        "ValueError: Seconds value must not be negative",
        "",
    ),
]
