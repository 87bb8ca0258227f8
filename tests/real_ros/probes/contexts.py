# mypy: ignore-errors
"""Log levels of command lines and contexts, nodes that could not be created, and events of services.

Many of the calls are wrong on purpose.
"""

import tempfile
from pathlib import Path
from typing import Any

import rclpy
import rclpy.utilities
from probing import lines, main, outcome, said
from rclpy.context import Context
from rclpy.logging import get_logger_effective_level, get_logger_level
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, qos_profile_system_default
from rclpy.service_introspection import ServiceIntrospectionState
from rclpy.topic_endpoint_info import TopicEndpointInfo
from std_msgs.msg import String
from std_srvs.srv import SetBool


def levels() -> Any:
    return [int(get_logger_effective_level("n")), *(int(get_logger_level(name)) for name in ("", "a", "b"))]


def levels_of(*words: Any) -> Any:
    """Return the levels that an initialization with a command line sets.

    The process keeps levels between probes, so that each one begins by setting those it returns.
    """
    rclpy.try_shutdown()
    start = ("info", "a:=warn", "b:=error")
    rclpy.init(args=["--ros-args", *(word for level in start for word in ("--log-level", level))])
    rclpy.shutdown()
    rclpy.init(args=["--ros-args", *words])
    return levels()


LEVELS = {
    "none": (),
    "default": ("--log-level", "fatal"),
    "two_defaults": ("--log-level", "debug", "--log-level", "error"),
    "unset": ("--log-level", "unset"),
    "unset_after_another": ("--log-level", "fatal", "--log-level", "unset"),
    "unset_of_a_logger": ("--log-level", "a:=unset"),
    "two_of_a_logger": ("--log-level", "a:=debug", "--log-level", "a:=error"),
    "capitals": ("--log-level", "A:=Fatal"),
    "names": ("--log-level", "a/b.c:=fatal", "--log-level", "a b:=fatal", "--log-level", "*:=fatal"),
    "name_with_colon": ("--log-level", "a:b:=fatal"),
    "number": ("--log-level", "10"),
    "unknown": ("--log-level", "warning"),
    "equals": ("--log-level", "n=debug"),
    "nothing": ("--log-level", ""),
    "empty_name": ("--log-level", ":=debug"),
    "empty_name_and_level": ("--log-level", ":="),
    "empty_level": ("--log-level", "a:="),
    "two_in_one": ("--log-level", "a:=debug,b:=info"),
    "two_separators": ("--log-level", "a:=b:=info"),
    "first_separator": ("--log-level", ":=:=info"),
    "spaces": ("--log-level", "a:= info"),
    "no_value": ("--log-level",),
    "no_value_of_remap": ("-r",),
    "no_value_of_parameter": ("--param",),
    "no_value_of_file": ("--params-file",),
}
lines("level", **{name: lambda words=words: levels_of(*words) for name, words in LEVELS.items()})


VALUES = ("true", "2", "0.5", "x", "[true]", "[2]", "[0.5]", "[x]", "[]")
FILE = "{}:\n  ros__parameters:\n    p: {}\n"


def value_of(*words: Any) -> Any:
    """Return the value of a parameter that a command line sets several times."""
    rclpy.shutdown()
    rclpy.init(args=["--ros-args", *words])
    node = Node("n", automatically_declare_parameters_from_overrides=True)
    return {name: one.value for name, one in node.get_parameters_by_prefix("").items() if name in NAMES}


NAMES = ("p", "_p", "p__", "/p", "/a/p", "__p", "a.__p", "a/__p")


def values_of(first: Any, second: Any) -> Any:
    """Return the values of a parameter, with any two of four values: for all nodes and for one."""
    pairs = (("2", "0.5"), ("0.5", "2"), ("x", "2"), ("2", "3"))
    with tempfile.TemporaryDirectory() as folder:
        found = []
        for values in pairs:
            words = []
            for place, value in zip((first, second), values, strict=True):
                if place.startswith("-p "):
                    words += ["-p", f"{place[3:]}p:={value}"]
                else:
                    file = Path(folder, f"{len(words)}.yaml")
                    file.write_text(FILE.format(place, value))
                    words += ["--params-file", str(file)]
            found.append(outcome(value_of, *words))
    return found


lines(
    "two_values",
    **{
        f"{first}_{second}": lambda first=first, second=second: value_of(
            "-p", f"p:={first}", "-p", f"p:={second}"
        )
        for first in VALUES
        for second in VALUES
        if (first, second) != ("[]", "[]")
    },
    three=lambda: value_of("-p", "p:=2", "-p", "n:p:=0.5", "-p", "p:=3"),
    three_types=lambda: value_of("-p", "p:=x", "-p", "p:=2", "-p", "p:=0.5"),
)
PLACES = ("/**", "n", "-p ", "-p n:")
lines(
    "two_places",
    **{
        f"{first}_then_{second}": lambda first=first, second=second: values_of(first, second)
        for first in PLACES
        for second in PLACES
    },
)
RULES = (
    "__p:=1",
    "_p:=1",
    "p__:=1",
    "a.__p:=1",
    "a/__p:=1",
    "~p:=1",
    "~/p:=1",
    "/p:=1",
    "/a/p:=1",
    "n:__p:=1",
)
lines(
    "parameter_rule",
    **{
        rule: lambda rule=rule: value_of("-p", rule)
        for rule in (*RULES, "rostopic://p:=1", "n:rosservice://p:=1")
    },
)


def services_of_old_rule(rule: Any) -> Any:
    """Return the names that a remapping in the form of ROS 1 changes, and what rcl logs."""
    rclpy.shutdown()
    logged = said(lambda: rclpy.init(args=["program", rule]) and None)
    node = Node("n")
    return logged, node.resolve_topic_name("a"), node.resolve_service_name("a")


lines(
    "old_rule",
    topic=lambda: services_of_old_rule("rostopic://a:=b"),
    service=lambda: services_of_old_rule("rosservice://a:=b"),
    both=lambda: services_of_old_rule("a:=b"),
    removed=lambda: said(lambda: rclpy.utilities.remove_ros_args(["program", "a:=b", "x", "--ros-args"])),
    removed_with_error=lambda: said(
        lambda: rclpy.utilities.remove_ros_args(["program", "a:=b", "--ros-args", "-p", "c"])
    ),
)


def initialized(level: Any, **options: Any) -> Any:
    context = Context()
    context.init(args=["--ros-args", "--log-level", level], **options)
    return context


def several_contexts() -> Any:
    """Return the level after each of several contexts: logging belongs to the process."""
    found = [levels_of("--log-level", "error")[0]]
    second = initialized("debug")
    found.append(levels()[0])
    rclpy.shutdown()
    third = initialized("fatal")
    found.append(levels()[0])
    second.shutdown()
    third.try_shutdown()
    third.try_shutdown()
    fourth = initialized("warn", initialize_logging=False)
    found.append(levels()[0])
    fifth = initialized("debug")
    found.append(levels()[0])
    for context in (fourth, fifth):
        context.shutdown()
    rclpy.init(args=["--ros-args", "--log-level", "info"])
    return [*found, levels()[0]]


def twice_shut_down() -> Any:
    """A second shutdown that raises does not end the logging of another context."""
    levels_of("--log-level", "info")
    second = initialized("debug")
    second.shutdown()
    raised = outcome(second.shutdown)
    third = initialized("fatal")
    found = levels()[0]
    third.shutdown()
    return raised, found


lines("context", several=several_contexts, twice_shut_down=twice_shut_down)


def after_failure(**options: Any) -> Any:
    """Return what is left of a node whose constructor raises: a node of its name logs no warning."""
    error = outcome(Node, "n", **options)
    found = Node("observer")
    return error, sorted(found.get_node_names()), said(lambda: Node("n").get_name())


lines(
    "failed",
    start_service=lambda: after_failure(
        parameter_overrides=[Parameter("start_type_description_service", value="no")]
    ),
    sim_time=lambda: after_failure(parameter_overrides=[Parameter("use_sim_time", value=[1])]),
    wrong_override=lambda: after_failure(parameter_overrides=[3]),
    wrong_overrides=lambda: after_failure(parameter_overrides=3),
    sim_time_argument=lambda: after_failure(cli_args=["--ros-args", "-p", "use_sim_time:=x"]),
)


def configured(change: Any, *, destroy: bool = False, shut_down: bool = False) -> Any:
    """Return what configuring the events of a service and of a client returns or raises."""
    node = Node("n")
    service, client = node.create_service(SetBool, "s", print), node.create_client(SetBool, "s")
    if destroy:
        node.destroy_service(service)
        node.destroy_client(client)
    if shut_down:
        rclpy.shutdown()
    return [outcome(change, end, node) for end in (service, client)]


OFF, METADATA = ServiceIntrospectionState.OFF, ServiceIntrospectionState.METADATA
QOS = qos_profile_system_default
lines(
    "events",
    fine=lambda: configured(lambda end, n: end.configure_introspection(n.get_clock(), QOS, METADATA)),
    node_as_clock=lambda: configured(lambda end, n: end.configure_introspection(n, QOS, METADATA)),
    no_clock=lambda: configured(lambda end, n: end.configure_introspection(None, QOS, METADATA)),
    no_qos=lambda: configured(lambda end, n: end.configure_introspection(n.get_clock(), None, OFF)),
    depth=lambda: configured(lambda end, n: end.configure_introspection(n.get_clock(), 10, OFF)),
    number=lambda: configured(lambda end, n: end.configure_introspection(n.get_clock(), QOS, 1)),
    nothing=lambda: configured(lambda end, n: end.configure_introspection(n.get_clock(), QOS, None)),
    destroyed=lambda: configured(
        lambda end, n: end.configure_introspection(n.get_clock(), QOS, METADATA), destroy=True
    ),
    shut_down=lambda: configured(
        lambda end, n: end.configure_introspection(n.get_clock(), QOS, METADATA), shut_down=True
    ),
    shut_down_off=lambda: configured(
        lambda end, n: end.configure_introspection(n.get_clock(), QOS, OFF), shut_down=True
    ),
    text=lambda: [(str(state), repr(state), f"{state}") for state in (OFF, METADATA)],
)


def info(**changes: Any) -> Any:
    """Return an endpoint's description, or the error, after its attributes have been assigned."""
    node = Node("n")
    node.create_publisher(String, "t", 10)
    described = node.get_publishers_info_by_topic("t")[0]
    for name, value in changes.items():
        setattr(described, name, value)
    return {name: str(getattr(described, name)) for name in changes}


lines(
    "info",
    node_name=lambda: info(node_name="other"),
    wrong_node_name=lambda: info(node_name=3),
    wrong_namespace=lambda: info(node_namespace=None),
    wrong_type=lambda: info(topic_type=String),
    wrong_hash=lambda: info(topic_type_hash="RIHS01"),
    kind_as_number=lambda: info(endpoint_type=2),
    wrong_kind=lambda: info(endpoint_type="PUBLISHER"),
    unknown_kind=lambda: info(endpoint_type=7),
    qos=lambda: info(qos_profile=QoSProfile(depth=3)),
    wrong_qos=lambda: info(qos_profile=10),
    constructed=lambda: TopicEndpointInfo(node_name="a", endpoint_type=1).endpoint_type.name,
    constructed_wrongly=lambda: TopicEndpointInfo(node_name=None),
    unknown=lambda: TopicEndpointInfo(name="a"),
)

if __name__ == "__main__":
    main()
