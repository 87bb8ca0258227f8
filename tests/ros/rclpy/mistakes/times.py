"""Times and durations."""

# (program, last line of the error, hint below it)
TIMES = [
    (
        "Time(0)",
        "TypeError: Time.__init__() takes 1 positional argument but 2 were given",
        "pass the argument by name: `Time(seconds=1.0)`. In a lookup `Time()` alone requests the "
        "newest transform.",
    ),
    (
        "PoseStamped().header.stamp.nanosec = node.get_clock().now().nanoseconds",
        "AssertionError: The 'nanosec' field must be an unsigned integer in [0, 4294967295]",
        "sec has the whole seconds, nanosec the rest: `self.get_clock().now().to_msg()` fills both.",
    ),
    (
        "node.get_clock().now() - Time()",
        "TypeError: Can't subtract times with different clock types",
        "take both times from one clock, `self.get_clock().now()`. A Time that you create is of "
        "this clock with "
        "`Time(clock_type=ClockType.ROS_TIME)`.",
    ),
    (
        "node.get_clock().now() > 5.0",
        "TypeError: '>' not supported between instances of 'Time' and 'float'",
        "compare with a Time or a Duration: `Duration(seconds=5.0)`.",
    ),
    (
        "stamp = node.get_clock().now().to_msg()\nstamp - stamp",
        "TypeError: unsupported operand type(s) for -: 'Time' and 'Time'",
        "messages cannot be subtracted. Convert both: `Time.from_msg(stamp)`.",
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
    (
        "Time.now()",
        "AttributeError: type object 'Time' has no attribute 'now'",
        "now() is a method of a clock: `self.get_clock().now()`.",
    ),
    (
        "node.get_clock().now().to_sec()",
        "AttributeError: 'Time' object has no attribute 'to_sec'",
        "rclpy's Time stores nanoseconds: `self.get_clock().now().nanoseconds / 1e9` is the time in seconds.",
    ),
    (
        "Duration(seconds=1.0).sec",
        "AttributeError: 'Duration' object has no attribute 'sec'",
        "rclpy's Duration stores nanoseconds: `Duration(seconds=1.0).nanoseconds / 1e9` "
        "is its length in seconds.",
    ),
    (
        "node.get_clock().now().to_msg().secs",
        "AttributeError: 'Time' object has no attribute 'secs'",
        "did you mean `sec`? `%ros2 interface show builtin_interfaces/msg/Time` lists its fields.",
    ),
    (
        "import time\ntime.sleep()",
        "TypeError: time.sleep() takes exactly one argument (0 given)",
        "",
    ),
    (
        "float(Duration(seconds=1.0))",
        "TypeError: float() argument must be a string or a real number, not 'Duration'",
        "its length in seconds is `Duration(seconds=1.0).nanoseconds / 1e9`, and a Time has "
        "nanoseconds, "
        "too.",
    ),
    (
        "Time.from_msg(node.get_clock().now())",
        "TypeError: Must pass a builtin_interfaces.msg.Time object",
        "Time.from_msg converts a stamp of a message. The time of a clock is a Time already: "
        "`self.get_clock().now()`.",
    ),
    (
        "import time\ntime.sleep(Duration(seconds=1.0))",
        "TypeError: 'Duration' object cannot be interpreted as an integer",
        "time.sleep takes a number of seconds, like 0.5, and not a Duration.",
    ),
    (
        "node.create_timer(Duration(seconds=1.0), print)",
        "TypeError: float() argument must be a string or a real number, not 'Duration'",
        "the period is a number of seconds and not a Duration: `self.create_timer(1.0, self.tick)`.",
    ),
    (
        "from builtin_interfaces.msg import Time\nTime() < Time()",
        "TypeError: '<' not supported between instances of 'Time' and 'Time'",
        "stamps of messages cannot be compared. Convert both: `Time.from_msg(stamp)`.",
    ),
    (
        "from rclpy.time import Time as time\ntime.sleep(1.0)",
        "AttributeError: type object 'Time' has no attribute 'sleep'",
        "time is the class Time and hides the module time: choose another name for it, and import "
        "the module again.",
    ),
]
