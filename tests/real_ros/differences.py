"""Where the kit differs from the real rclpy by design: each outcome belongs to a row of docs/simulated.md."""

from dataclasses import dataclass
from typing import Any

_NOT_INITIALIZED = "NotInitializedException: rclpy.init() has not been called. msg:cannot create executor"


@dataclass(frozen=True)
class Difference:
    """An outcome of a probe that differs from that of the real rclpy.

    Args:
        row: The subject of the row of docs/simulated.md that lists it.
        kits: Part of the outcome in the kit.
    """

    row: str
    kits: str


_AFTER_THE_END = "Executors after `rclpy.shutdown()`, or before `rclpy.init()`"
_COUNTS = "Counts after `rclpy.shutdown()`"
_BYTES = "Bytes that are not a message"
_BYTES_AS_NAMES = "Names as bytes, `create_publisher(String, b'chatter', 10)`"
_DDS_NAMES = "`get_topic_names_and_types(no_demangle=True)`"
_ASSERTIONS = "Texts of assertions and of wrong types"
_ENUMERATIONS = (
    "Enumerations of rclpy's C++ code: TransitionCallbackReturn, QoSCompatibility, SignalHandlerOptions …"
)
_FOREVER, _FIELD = "Waiting forever", "A field of the wrong type"
_NUMBERS = "Arrays of numbers"
_DATES = "`get_parameter_value` for dates, maps and binary data"
_THREADS = "An exception in a callback of a MultiThreadedExecutor"
_WAITING = "`spin_once` while a coroutine waits"
_TYPES = "`GetParameterTypes` for an unknown parameter of a node with `allow_undeclared_parameters`"
# By file and probe.
PROBES: dict[str, dict[str, Difference]] = {
    "asking": {
        "client.types_unknown_allowed": Difference(_TYPES, "types=[0, 2]"),
        "client.get_text": Difference(_FIELD, "The 'names' field must be a set or sequence"),
    },
    "checked": {
        f"unchecked.{name}": Difference(_FIELD, "The 'x' field must be of type 'float'")
        for name in ("nested_is_not_checked", "nested_is_checked")
    },
    "failing": {
        "in_threads_without_another_callback": Difference(_THREADS, "OwnError: own text"),
    },
    "destroyed": {
        "shut_down.spin_once": Difference(_AFTER_THE_END, _NOT_INITIALIZED),
        "shut_down.add_to_executor": Difference(_AFTER_THE_END, _NOT_INITIALIZED),
        "executors_after_shutdown": Difference(_AFTER_THE_END, _NOT_INITIALIZED),
    },
    "chance": {
        "tasks.62": Difference(
            "A coroutine that awaits an earlier task", "('step 7', 'step 4'), \"KeyError: 'step 7'\", '[]'"
        ),
    },
    "spinning": {
        "calls_of_spin_once_while_a_coroutine_waits": Difference(_WAITING, "11"),
        "changing_time_limits_while_a_coroutine_waits": Difference(
            "A timeout of `spin_once` that changes while a coroutine waits", "True"
        ),
    },
    "calls": {
        "goal.returns_nothing": Difference(_FIELD, "The 'result' field must be a sub message"),
        "goal.returns_text": Difference(_FIELD, "The 'result' field must be a sub message"),
    },
    "details": {
        "init.returns": Difference("`with rclpy.init():`", "<rclpy.InitContextManager object"),
        "counts_after_shutdown": Difference(_COUNTS, "publisher's context is invalid\", '0'"),
        "fresh_context.executor": Difference(_AFTER_THE_END, _NOT_INITIALIZED),
        "fresh_context.many_threads": Difference(_AFTER_THE_END, _NOT_INITIALIZED),
        "fresh_context.spin_once": Difference(_AFTER_THE_END, _NOT_INITIALIZED),
    },
    "objects": {
        "qos.depth_none": Difference(_ASSERTIONS, "The 'depth' of a QoSProfile must be int: None"),
        "qos.text_as_history": Difference(_ASSERTIONS, "The 'history' of a QoSProfile must be"),
        "time.message_of_far_future": Difference(_FIELD, "The 'sec' field must be an integer in"),
        "time.as_stamp": Difference(_FIELD, "The 'stamp' field must be a sub message of type 'Time'"),
        "descriptor.two_ranges": Difference(_FIELD, "a set or sequence with length <= 1"),
        "descriptor.set_descriptor": Difference(_FIELD, "The 'value' field must be a sub message"),
        "descriptor.huge_int": Difference(_FIELD, "The 'integer_value' field must be an integer in"),
        "message.unknown_field": Difference(_FIELD, "Invalid arguments passed to constructor: w"),
        "message.of_numpy_2d": Difference(_NUMBERS, "The 'data' field must be a set or sequence"),
        "message.of_a_generator": Difference(_NUMBERS, "The 'position' field must be a set or sequence"),
        "message.of_a_dict": Difference(_NUMBERS, "The 'position' field must be a set or sequence"),
    },
    "unusual": {
        "duration.message_of_big": Difference(_FIELD, "The 'sec' field must be an integer in"),
        "time.message_beyond": Difference(_FIELD, "The 'sec' field must be an integer in"),
        "qos.numpy_depth": Difference(_ASSERTIONS, "must be int: np.int64(3)"),
    },
    "running": {
        "parameter_client.get_text": Difference(_FIELD, "The 'names' field must be a set or sequence"),
    },
    "corners": {
        "corner.zero_in_a_string": Difference("A null character in a string", "x00b"),
        "corner.matrix_as_covariance": Difference(_NUMBERS, "must have a size of 36"),
        "corner.bad_bytes": Difference(_BYTES, "These 1 bytes are not a valid std_msgs/msg/String"),
        "corner.no_bytes": Difference(_BYTES, "These 0 bytes are not a valid std_msgs/msg/String"),
        "corner.deserialize_nothing": Difference(_BYTES, "These 0 bytes are not a valid std_msgs/msg/String"),
        "corner.deserialize_short": Difference(_BYTES, "These 9 bytes are not a valid std_msgs/msg/String"),
    },
    "kinds": {
        **{
            f"set_by_client.{kind}": Difference(_FIELD, "The 'parameters' field must be a set or sequence")
            for kind in ("text", "a_list", "a_tuple")
        },
        "name.as_bytes": Difference(_BYTES_AS_NAMES, "TypeError: rclpy_resolve_name(): incompatible"),
        "name.of_dds": Difference(_DDS_NAMES, "False"),
    },
    "overrides": {
        **{
            f"yaml.{text}": Difference(_DATES, f"string_value='{text}'")
            for text in (
                "2024-01-01",
                "2001-12-14t21:59:43.10-05:00",
                "2001-12-14 21:59:43.10 -5",
                "a: b",
                "{a: 1}",
                "{}",
                "!!binary aGVsbG8=",
            )
        },
        **{
            f"yaml.{number}": Difference(_FIELD, "The 'integer_value' field must be an integer in")
            for number in (2**63, -(2**63) - 1)
        },
        **{
            f"checked.{name}": Difference(_NUMBERS, stored)
            for name, stored in {
                "ints_for_doubles": "'array', 'd', 2",
                "bytes_for_doubles": "ValueError: bytes length not a multiple of item size",
                "numpy_ints_for_doubles": "'array', 'd', 2",
                "array_of_floats_for_doubles": "'array', 'd', 1",
                "array_of_doubles_for_floats": "'array', 'f', 1",
                "numpy_for_bytes": "'array', 'B', 2",
                "array_of_ints_for_bytes": "'array', 'B', 1",
                "numpy_matrix_for_covariance": "must have a size of 36",
                "numpy_ints_for_covariance": "'ndarray', 'float64', 36",
            }.items()
        },
    },
    "everyday": {
        "managed.returns": Difference(_ENUMERATIONS, "[<TransitionCallbackReturnType.SUCCESS: 97>"),
        "enumeration.list": Difference(_ENUMERATIONS, "3"),
        "enumeration.item": Difference(_ENUMERATIONS, "KeyError: 'x'"),
    },
    "remaining": {
        "deprecated_module": Difference("The module `rclpy.qos_event`", "(0, ["),
    },
    "graphs": {
        "heard.info": Difference("Numbers in `MessageInfo`", "'source_timestamp'], None)"),
        "profile.depth_float": Difference(
            _ASSERTIONS, "AssertionError: The 'depth' of a QoSProfile must be int: 1.0"
        ),
        "profile.depth_text": Difference(
            _ASSERTIONS, "AssertionError: The 'depth' of a QoSProfile must be int: '1'"
        ),
        "profile.reliability_text": Difference(
            _ASSERTIONS, "AssertionError: The 'reliability' of a QoSProfile must be"
        ),
        "profile.deadline_float": Difference(
            _ASSERTIONS, "AssertionError: The 'deadline' of a QoSProfile must be Duration"
        ),
        "profile.assigned_text": Difference(
            _ASSERTIONS, "AssertionError: The 'depth' of a QoSProfile must be int: 'x'"
        ),
    },
}

# Rows stating that both agree, with the file and name of the probe that shows it.
AGREEMENTS = {
    "Polling, `spin_once(timeout_sec=0)`": ("refusals", "polling_takes_every_second_call"),
    "Losses": ("graphs", "burst.one"),
    "Two types on one topic or service": ("refusals", "two_types_on_one_topic"),
    "Extra bytes at the end of a message": ("refusals", "bytes_with_a_tail"),
    "Depth in `get_publishers_info_by_topic`": ("graphs", "endpoint.text"),
}

# Public callables with other parameters, with their row.
_CONSTRUCTORS = "Constructors of publishers, clients, timers …"
SIGNATURES = dict.fromkeys(
    (
        "rclpy.client.Client",
        "rclpy.event_handler.EventHandler",
        "rclpy.publisher.Publisher",
        "rclpy.service.Service",
        "rclpy.subscription.Subscription",
        "rclpy.timer.Timer",
    ),
    _CONSTRUCTORS,
)

# Parameters of launch and tf2_ros that only one side has. They have a row, too.
PARAMETERS_OF_LAUNCH = "Parameters of `launch` and `tf2_ros`"
LAUNCH_SIGNATURES = {
    "launch.Action": ["do=None"],
    "launch.Substitution": ["make=None"],
    **{
        f"launch.launch_description_sources.{name}": ["keyword parser=..."]
        for name in (
            "FrontendLaunchDescriptionSource",
            "get_launch_description_from_any_launch_file",
            "get_launch_description_from_frontend_launch_file",
        )
    },
    "launch_ros.parameter_descriptions.ParameterValue.evaluate": ["name=''"],
    "tf2_ros.TransformListener": [
        "keyword static_only=False",
        "keyword tf_static_topic='/tf_static'",
        "keyword tf_topic='/tf'",
    ],
}

# Programs whose exit code differs, because the run ends on request and not by Ctrl+C.
END_OF_A_RUN = "The end of a run"
ENDS_AS_ASKED = ("plain_spin", "while_ok")

# Programs of the documents whose values differ, with their row.
OTHER_VALUES = {"PerceptionVisualizer": "Random numbers"}

# Nodes of the course whose outcome differs, with their row: three publish values of the clock, and
# two measure a rate with it.
_CLOCK = "The clock"
NODES = {
    "week06_tooling: Home()": _FOREVER,
    "week06_tooling: FirstMonitor()": _CLOCK,
    "week06_tooling: ScanRate()": _CLOCK,
    "week07_dashboard: TfPublisher()": _CLOCK,
    "week07_dashboard: PathPublisher()": _CLOCK,
    "week07_exercise: TfPublisher()": _CLOCK,
}


def without_values(outcome: dict[str, Any]) -> dict[str, Any]:
    """Return the outcome of a node with the types of its messages only."""
    topics = {name: [text.split()[0] for text in texts] for name, texts in outcome["topics"].items()}
    return outcome | {"topics": topics}


# Students' mistakes whose error differs, by the text of the program, with their row.
MISTAKES = {
    "rate = node.create_rate(1)\nnode.create_timer(0.1, rate.sleep)\nrclpy.spin(node)": _FOREVER,
    "node.create_service(AddTwoInts, 'add', lambda request, response: response)\n"
    "client = node.create_client(AddTwoInts, 'add')\n"
    "node.create_timer(0.1, lambda: client.call(AddTwoInts.Request()))\n"
    "rclpy.spin(node)": _FOREVER,
    "node.create_timer(0.1, lambda: rclpy.spin(node))\nrclpy.spin(node)": "`rclpy.spin` in a callback",
    "ActionServer(node, AddTwoInts, 'count', print)": "A service as the type of an action",
    "ActionServer(node, Fibonacci, 'count', lambda goal: goal.succeed())\n"
    "ActionClient(node, Fibonacci, 'count').send_goal_async(Fibonacci.Goal())\n"
    "rclpy.spin(node)": _FIELD,
    "def execute(goal):\n    goal.succeed()\n    return Fibonacci.Result\n"
    "ActionServer(node, Fibonacci, 'count', execute)\n"
    "ActionClient(node, Fibonacci, 'count').send_goal_async(Fibonacci.Goal())\nrclpy.spin(node)": _FIELD,
    "node.get_logger().info(5)": _ASSERTIONS,
    "best = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)\n"
    "node.create_publisher(String, 'chatter', best)\n"
    "node.create_subscription(String, 'chatter', print, 10)": "Discovery",
    "node.create_publisher(String, 'latched', 1)\n"
    "latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n"
    "node.create_subscription(String, 'latched', print, latched)": "Discovery",
    "marker = Marker()\nmarker.points.append((1.0, 2.0, 3.0))\n"
    "node.create_publisher(Marker, 'marker', 10).publish(marker)": _FIELD,
    "marker = Marker()\nmarker.points.append([Point(), Point()])\n"
    "node.create_publisher(Marker, '/marker', 10).publish(marker)": _FIELD,
    **dict.fromkeys(
        (
            "from std_msgs.msg import Bool\nBool().data = 1",
            "from std_msgs.msg import Bool\nBool().data = 'True'",
            "String().data = b'text'",
            "String().data = ['a', 'b']",
            "from sensor_msgs.msg import Image\nimport numpy as np\nImage().encoding = np.uint8",
            "from builtin_interfaces.msg import Time\nTime().sec = 1.5",
            "from geometry_msgs.msg import PoseWithCovariance\nPoseWithCovariance().covariance = [0.0] * 6",
            "from geometry_msgs.msg import PoseWithCovariance\nimport numpy as np\n"
            "PoseWithCovariance().covariance = np.eye(6)",
            "from visualization_msgs.msg import MarkerArray\nMarkerArray().markers = [Marker]",
            "Float64MultiArray().layout.dim = [('rows', 2, 2)]",
            "from std_msgs.msg import Byte\nByte().data = 1",
            "Marker().action = 'DELETE'",
            "Marker(type='sphere')",
            "import numpy as np\nmarker = Marker()\nmarker.points = np.zeros((3, 3))",
            "from nav_msgs.msg import Path\nfrom geometry_msgs.msg import Pose\npath = Path(poses=[Pose()])",
            "marker = Marker()\nmarker.header.frame_id = PoseStamped().header",
            "status = DiagnosticStatus()\nstatus.level = DiagnosticStatus.OK, 'normal'",
            "status = DiagnosticStatus()\nstatus.level, status.message = 'OK', 'normal'",
            "status = DiagnosticStatus()\nstatus.message, status.level = DiagnosticStatus.OK, 'normal'",
            "from sensor_msgs.msg import Image\nImage(width=-1)",
            "Twist().linear.x = 1",
            "Twist(linear=(1.0, 0.0, 0.0))",
            "Int32(data=1.5)",
            "UInt8(data=300)",
            "String(data=5)",
            "String(data={'text': 'a'})",
            "ColorRGBA(r=255)",
            "DiagnosticStatus(level=0)",
            "String(dta='hello')",
            "Marker(type='CUBE')",
            "Marker().id = (1.0, 0.0, 0.0)",
            "PoseStamped().pose.position = (1.0, 2.0, 3.0)",
            "PoseStamped().pose.orientation = 1.57",
            "PoseStamped().pose.orientation = [0.0, 0.0, 0.3826834, 0.9238795]",
            "Marker().color = (1.0, 0.0, 0.0)",
            "Marker().scale = 0.2",
            "Marker().pose.position = [0.0, 0, 1.0]",
            "Marker().header = 'map'",
            "TransformBroadcaster(node).sendTransform(PoseStamped())",
            "Twist().linear = 0.5",
            "PoseStamped().header.stamp.nanosec = node.get_clock().now().nanoseconds",
            "from nav_msgs.msg import OccupancyGrid\nOccupancyGrid().data = [0, 255]",
            "from nav_msgs.msg import OccupancyGrid\nOccupancyGrid().data = [0.0, 1.0]",
            "Marker().lifetime = Duration(seconds=1.0)",
            "PoseStamped().header.stamp = node.get_clock().now()",
            "PoseStamped().header.frame_id = None",
            "PoseStamped().header = str(PoseStamped().header)",
            "node.declare_parameter('frame', 'map')\n"
            "PoseStamped().header.frame_id = node.get_parameter('frame')",
            "node.declare_parameter('frame', 'map')\n"
            "value = node.get_parameter('frame').get_parameter_value()\n"
            "PoseStamped().header.frame_id = value",
            "from geometry_msgs.msg import Transform\nMarker().pose = Transform()",
            "Marker().points = Point()",
            "Marker().color.a = 0,8",
            "from visualization_msgs.msg import MarkerArray\nMarkerArray().markers = [None]",
            "from visualization_msgs.msg import MarkerArray\ndef red():\n    return Marker()\n"
            "MarkerArray().markers = [red]",
            "Marker().scale.x = '1.0'",
            "import numpy as np\nMarker().scale.x = np.float32(0.5)",
            "import numpy as np\nMarker().scale.x = np.array([1.0])",
            "Marker().scale.x = 1j",
            "Marker().scale.x = round(0.8)",
            "Marker().pose.position.z = 1 // 2",
            "Marker().pose.position = PoseStamped().pose",
            "Marker().pose.position = Marker().scale",
            "Marker().header.stamp = Node('a').get_clock().now().to_msg",
            *(
                f"from sensor_msgs.msg import JointState\nimport numpy as np\nJointState().name = {value}"
                for value in ("1", "'arm'", "{'arm': 1.0}", "[['a']]", "np.eye(2)")
            ),
        ),
        _FIELD,
    ),
}
