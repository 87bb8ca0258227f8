"""Names that programs from public repositories import."""

import subprocess
import sys
import warnings
from importlib import import_module

import pytest
import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import (
    ConditionReachedException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
    TimeoutException,
)
from rclpy.node import Node
from rclpy.parameter import Parameter, get_parameter_value, parameter_value_to_python
from rclpy.qos import (
    HistoryPolicy,
    QoSPolicyKind,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_best_available,
    qos_profile_sensor_data,
)
from rclpy.qos_overriding_options import InvalidQosOverridesError, QosCallbackResult, QoSOverridingOptions
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Empty

from course_lib.ros.graph.graph import START_NS, Graph
from course_lib.ros.programs.import_path import THIRD_PARTY_IMPORTS
from tests.patience import PATIENCE
from tests.ros.rclpy.conftest import graph as graph
from tests.ros.rclpy.conftest import node as node
from tests.ros.rclpy.conftest import started_graph as started_graph

IMPORTS = (
    "from launch.actions.declare_launch_argument import DeclareLaunchArgument",
    "from launch.actions.shutdown_action import Shutdown",
    "from launch.conditions.if_condition import IfCondition",
    "from launch.event_handlers.on_process_exit import OnProcessExit",
    "import launch.logging; launch.logging.get_logger('x').debug('hidden')",
    "import os; assert os.environ['ROS_DISTRO'] == 'jazzy'",
    "from launch.launch_context import LaunchContext",
    "from launch.launch_description import LaunchDescription",
    "from launch.launch_description_entity import LaunchDescriptionEntity",
    "from launch.some_substitutions_type import SomeSubstitutionsType",
    "from launch.substitutions.launch_configuration import LaunchConfiguration",
    "from launch.substitutions.path_join_substitution import PathJoinSubstitution",
    "from launch.events.matchers import matches_action",
    "from launch_ros.actions.lifecycle_node import LifecycleNode",
    "from launch_ros.actions.node import Node",
    "from launch_ros.event_handlers.on_state_transition import OnStateTransition",
    "from launch_ros.events.lifecycle.change_state import ChangeState",
    "import launch_ros; launch_ros.event_handlers.OnStateTransition, launch_ros.events.matchers",
    "import launch_ros.events; launch_ros.events.lifecycle.ChangeState",
    "from launch_ros.events.matchers import matches_node_name",
    "import launch_xml; launch_xml.launch_description_sources.XMLLaunchDescriptionSource",
    "import launch_yaml.launch_description_sources as y; y.YAMLLaunchDescriptionSource",
    "import launch; launch.events.process.ProcessExited, launch.logging.get_logger",
    "from launch_ros.substitutions.find_package import FindPackageShare",
    "from rclpy._rclpy_pybind11 import InvalidHandle, RCLError",
    "from rclpy.event_handler import UnsupportedEventTypeError",
    "from rclpy.expand_topic_name import expand_topic_name",
    "from rclpy.guard_condition import GuardCondition",
    "from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy; _rclpy.RCLError",
    "from rclpy.node import NodeNameNonExistentError",
    "from rclpy.qos_event import PublisherEventCallbacks",
    "from rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum",
    "from rclpy.validate_topic_name import validate_topic_name; assert validate_topic_name('x')",
    "import rclpy; rclpy.get_rmw_implementation_identifier()",
    "import rclpy; rclpy.clock_type.ClockType, rclpy.constants.S_TO_NS",
    "from rclpy.lifecycle.managed_entity import SimpleManagedEntity",
    "from rclpy.lifecycle.publisher import LifecyclePublisher",
    "from rclpy.type_description_service import TypeDescriptionService",
    "from ament_index_python.resources import get_resource",
    "from ros2_numpy.point_cloud2 import get_xyz_points",
    "from rosbag2_py._reader import SequentialReader",
    "from rosidl_parser.definition import NamespacedType",
    "from rosidl_runtime_py.convert import message_to_yaml",
    "from rosidl_runtime_py.get_interfaces import get_interfaces",
    "from rosidl_runtime_py.set_message import set_message_fields",
    "from diagnostic_updater._diagnostic_updater import Updater",
    "from diagnostic_updater._update_functions import FrequencyStatus",
    "import std_msgs; from std_msgs.msg import Header; std_msgs.msg.String",
)


def test_names_imported_by_public_programs_exist() -> None:
    first = "from course_lib.ros.programs import import_path; import_path.install()\n"
    code = first + "\n".join(IMPORTS)
    process = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert (process.returncode, process.stderr) == (0, "")


@pytest.mark.parametrize("host", THIRD_PARTY_IMPORTS)
def test_third_party_names_can_be_imported_from_the_same_modules_as_in_ros(host: str) -> None:
    lacking = [name for names in THIRD_PARTY_IMPORTS[host].values() for name in names]
    assert [name for name in lacking if not hasattr(import_module(host), name)] == []
    assert not hasattr(import_module(host), "nonsense")


def test_name_imported_from_another_module_is_the_same_object() -> None:
    code = (
        "from course_lib.ros.programs import import_path; import_path.install()\n"
        "from rclpy.node import ReentrantCallbackGroup, ParameterType\n"
        "import rclpy.callback_groups, rcl_interfaces.msg\n"
        "assert ReentrantCallbackGroup is rclpy.callback_groups.ReentrantCallbackGroup\n"
        "assert ParameterType is rcl_interfaces.msg.ParameterType\n"
        "from rclpy.node import Nonsense"
    )
    process = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert "ImportError: cannot import name 'Nonsense' from 'rclpy.node'" in process.stderr


def test_types_of_a_package_are_available_once_one_of_them_is_loaded() -> None:
    code = (
        "from course_lib.ros.programs import import_path; import_path.install(); import std_msgs, std_srvs\n"
        "from geometry_msgs.msg import PoseStamped; print(std_msgs.msg.Header.__name__)\n"
        "std_srvs.srv"
    )
    process = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert process.stdout == "Header\n"
    assert process.stderr.endswith("AttributeError: module 'std_srvs' has no attribute 'srv'\n")


def test_logger_of_a_launch_file_writes_as_in_launch(capsys: pytest.CaptureFixture[str]) -> None:
    from launch import logging

    logging.get_logger("robot").info("%d wheels", 4)
    logging.get_logger().warning("no map")
    assert capsys.readouterr() == ("[INFO] [robot]: 4 wheels\n[WARNING] [launch]: no map\n", "")


@pytest.mark.parametrize("name", ["launch.actions.nonsense", "rclpy.nonsense", "launch_ros.nonsense"])
def test_unknown_modules_cannot_be_imported(name: str) -> None:
    with pytest.raises(ModuleNotFoundError, match=rf"^No module named '{name}'$"):
        __import__(name)


def test_policy_names_of_rmw_are_available_with_a_warning() -> None:
    with pytest.warns(
        UserWarning, match=r"^ReliabilityPolicy.RMW_QOS_POLICY_RELIABILITY_RELIABLE is deprecated"
    ):
        found = ReliabilityPolicy.RMW_QOS_POLICY_RELIABILITY_RELIABLE  # type: ignore[attr-defined]
    assert found is ReliabilityPolicy.RELIABLE
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert HistoryPolicy.get_from_short_key("keep_all") == HistoryPolicy.KEEP_ALL
    assert QoSPresetProfiles.get_from_short_key("sensor_data") == qos_profile_sensor_data
    assert HistoryPolicy.KEEP_LAST.short_key == "keep_last"


@pytest.mark.parametrize("publisher", [qos_profile_sensor_data, QoSProfile(depth=10)])
def test_best_available_profile_matches_every_earlier_publisher(node: Node, publisher: QoSProfile) -> None:
    messages: list[String] = []
    sender = node.create_publisher(String, "chatter", publisher)
    node.create_subscription(String, "chatter", messages.append, qos_profile_best_available)
    sender.publish(String(data="hi"))
    rclpy.spin_once(node)
    assert [message.data for message in messages] == ["hi"]


@pytest.mark.parametrize(
    "value", [True, 3, 2.5, "text", [True, False], [1, 2], [0.5], ["a", "b"], None, [b"a", b"b"]]
)
def test_parameter_message_is_converted_to_its_value(value: object) -> None:
    assert parameter_value_to_python(Parameter("x", value=value).get_parameter_value()) == value


@pytest.mark.parametrize(
    ("text", "value"),
    [("3", 3), ("2.5", 2.5), ("true", True), ("[1, 2]", [1, 2]), ("hello", "hello"), ("[a, 1]", "[a, 1]")],
)
def test_string_is_converted_to_its_yaml_value(text: str, value: object) -> None:
    assert parameter_value_to_python(get_parameter_value(text)) == value


def test_custom_executor_receives_ready_callbacks(node: Node) -> None:
    class Custom(SingleThreadedExecutor):
        def spin_once(self, timeout_sec: float | None = None) -> None:
            handler, group, owner = self.wait_for_ready_callbacks(timeout_sec=timeout_sec)
            taken.append((type(group).__name__, owner))
            handler()

    taken: list[tuple[str, object]] = []
    node.create_timer(1.0, lambda: None)
    executor = Custom()
    executor.add_node(node)
    executor.spin_once()
    assert taken == [("Timer", node)]
    with pytest.raises(TimeoutException):
        executor.spin_once(timeout_sec=0.5)
    with pytest.raises(ConditionReachedException):
        executor.wait_for_ready_callbacks(condition=lambda: True)


def test_wait_for_message_returns_one_message_without_spinning(node: Node) -> None:
    from rclpy.wait_for_message import wait_for_message

    publisher = node.create_publisher(Twist, "cmd_vel", 10)
    publisher.publish(Twist())  # before anybody waits
    node.handle.graph.call_at(START_NS + 2 * 10**9, lambda: publisher.publish(Twist()), node=0, entity=0)
    assert wait_for_message(Twist, node, "cmd_vel", time_to_wait=1.0) == (False, None)
    assert wait_for_message(Twist, node, "cmd_vel", time_to_wait=5.0) == (True, Twist())
    assert (node.handle.graph.now_ns - START_NS) * 1e-9 == pytest.approx(2.001)


def test_wait_for_message_returns_the_message_while_other_threads_spin_the_node(node: Node) -> None:
    from rclpy.wait_for_message import wait_for_message

    publisher = node.create_publisher(Twist, "cmd_vel", 10)
    received: Future[tuple[bool, Twist]] = Future()

    def wait() -> None:
        waiting.cancel()
        received.set_result(wait_for_message(Twist, node, "cmd_vel", time_to_wait=5.0))

    waiting = node.create_timer(0.1, wait, callback_group=ReentrantCallbackGroup())
    node.create_timer(0.2, lambda: publisher.publish(Twist()), callback_group=ReentrantCallbackGroup())
    executor = MultiThreadedExecutor(3)
    executor.add_node(node)
    executor.spin_until_future_complete(received, 5.0)
    assert received.result() == (True, Twist())


def test_node_lists_endpoints_and_services_of_other_nodes_with_their_types(
    node: Node, started_graph: Graph
) -> None:
    other = Node("other", namespace="/arm", start_parameter_services=False)
    other.create_publisher(String, "chatter", 10)
    other.create_subscription(Twist, "cmd_vel", print, 10)
    other.create_service(Empty, "reset", lambda _, response: response)
    node.create_client(Empty, "/arm/reset")
    assert node.get_fully_qualified_node_names() == ["/talker", "/arm/other"]
    published = dict(node.get_publisher_names_and_types_by_node("other", "/arm"))
    assert published["/arm/chatter"] == ["std_msgs/msg/String"]
    assert node.get_subscriber_names_and_types_by_node("other", "/arm") == [
        ("/arm/cmd_vel", ["geometry_msgs/msg/Twist"])
    ]
    reset = ("/arm/reset", ["std_srvs/srv/Empty"])
    assert reset in node.get_service_names_and_types_by_node("other", "/arm")
    assert node.get_client_names_and_types_by_node("talker", "/") == [reset]
    assert (node.count_services("/arm/reset"), node.count_clients("/arm/reset")) == (1, 1)
    assert node.wait_for_node("arm/other", 1.0)
    assert not node.wait_for_node("/nobody", 0.5)
    with pytest.raises(rclpy.node.NodeNameNonExistentError, match="nonexistent node: "):
        node.get_client_names_and_types_by_node("nobody", "/")


def test_parameters_override_the_qos(started_graph: Graph) -> None:
    cli = ["--ros-args", "-p", "qos_overrides./chatter.publisher.reliability:=best_effort"]
    talker = Node("talker", cli_args=[*cli, "-p", "qos_overrides./chatter.publisher.depth:=3"])
    options = QoSOverridingOptions.with_default_policies()
    publisher = talker.create_publisher(String, "chatter", 10, qos_overriding_options=options)
    assert (publisher.qos_profile.depth, publisher.qos_profile.reliability.name) == (3, "BEST_EFFORT")
    assert talker.get_parameter("qos_overrides./chatter.publisher.history").value == "keep_last"
    named = QoSOverridingOptions([QoSPolicyKind.DEADLINE, QoSPolicyKind.LIFESPAN], entity_id="ear")
    ear = talker.create_subscription(String, "chatter", print, 7, qos_overriding_options=named)
    assert ear.qos_profile == QoSProfile(depth=7)
    assert talker.get_parameter("qos_overrides./chatter.subscription_ear.deadline").value == 0
    assert not talker.has_parameter("qos_overrides./chatter.subscription_ear.lifespan")


def test_invalid_qos_overrides_are_rejected(started_graph: Graph) -> None:
    name = "qos_overrides./chatter.publisher.reliability"
    talker = Node("talker", cli_args=["--ros-args", "-p", f"{name}:=sometimes"])
    options = QoSOverridingOptions.with_default_policies()
    with pytest.raises(
        RuntimeError, match=r"^Unexpected QoS override for policy `reliability`: `sometimes`$"
    ):
        talker.create_publisher(String, "chatter", 10, qos_overriding_options=options)
    strict = QoSOverridingOptions([], callback=lambda profile: QosCallbackResult(reason="too deep"))
    with pytest.raises(InvalidQosOverridesError, match=r"are not valid: too deep$"):
        talker.create_publisher(String, "other", 10, qos_overriding_options=strict)
