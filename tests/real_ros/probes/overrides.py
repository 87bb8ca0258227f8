# mypy: ignore-errors
"""Parameters on the command line and in files, rules for names, and GIDs of service events.

Numbers in messages that check their fields are here too, one value at a time, because the kit
converts sequences as Jazzy does without checks.
"""

import os
import tempfile
from array import array
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import PoseWithCovariance
from probing import lines, main, outcome, spun
from rclpy.node import Node
from rclpy.parameter import get_parameter_value, parameter_dict_from_yaml_file
from rclpy.qos import qos_profile_system_default
from rclpy.service_introspection import ServiceIntrospectionState
from sensor_msgs.msg import Image, JointState, LaserScan
from std_msgs.msg import String
from std_srvs.srv import SetBool

DATES = "2024-01-01|2001-12-14t21:59:43.10-05:00|2001-12-14 21:59:43.10 -5|[2024-01-01, 2024-01-02]"
SCALARS = (
    "12:30:45|1:30|~|null|Null|NULL|yes|Yes|on|off|no|y|n|True|TRUE|tRue|0x1F|0o17|017|0b101"
    "|1_000|1e3|1.e3|.5|5.|+5|+.5|-.inf|.nan|.NaN|nan|inf|1e400|9223372036854775807|'5'|\"5\""
    "|!!str 5|!!int '5'|!!float 5| |# c|a # c|a: b|'|\"|- 1|[1,2|| 5 |@a|%a|`a|!a|a b|1.5.2"
    "|1e|0x|--|-|.|=|<<|1 000|\uff11|&x 5|*x|>\n text"
)
LARGE = "9223372036854775808|-9223372036854775809"
LISTS = "[1, 2]|[1, 2.0]|[1, a]|[]|[true, false]|['a', b]|[1, null]|[1, '2']|[1.0, 2]|[true, 1]|[0x10, 1]"
MAPS = "{a: 1}|{}|!!binary aGVsbG8="
VALUES = "|".join((DATES, SCALARS, LARGE, LISTS, MAPS)).split("|")


def _found(*args: Any, namespace: Any = None) -> Any:
    """Return the parameters of a node that declares all overrides."""
    rclpy.shutdown()
    rclpy.init(args=["--ros-args", *args])
    node = Node("n", namespace=namespace, automatically_declare_parameters_from_overrides=True)
    found = {name: one for name, one in node._parameters.items() if "start_type" not in name}
    return sorted((name, one.type_.name, one.value) for name, one in found.items())


def _found_of_file(path: Any) -> Any:
    return _found("--params-file", path)


def _in_file(text: Any, read: Any) -> Any:
    """Read a file with one parameter."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "p.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"/**:\n  ros__parameters:\n    a: {text}\n")
        return read(path)


for _text in VALUES:
    lines("argument", **{_text: lambda text=_text: _found("-p", f"a:={text}")})
    lines("file", **{_text: lambda text=_text: _in_file(text, _found_of_file)})
    lines("yaml", **{_text: lambda text=_text: get_parameter_value(text)})
    lines("dictionary", **{_text: lambda text=_text: _in_file(text, parameter_dict_from_yaml_file)})

PARAMETERS = (
    "a:=1|n:a:=1|/n:a:=1|/ns/n:a:=1|ns/n:a:=1|m:a:=1|a=1|:=1|a:=|a|a.b:=1|a.b.c:=[1]|a-b:=1"
    "|1a:=1|/**:a:=1|*:a:=1|**/n:a:=1|n*:a:=1|a:b:=1|n:a:b:=1| a:=1|a :=1|a:= 1|~:a:=1|~/a:=1"
    "|/a:=1|use_sim_time:=1"
)
for _namespace in ("/", "/ns", "/ns/n"):
    _probes = {
        text: lambda text=text, at=_namespace: _found("-p", text, namespace=at)
        for text in PARAMETERS.split("|")
    }
    lines(f"name{_namespace}", **_probes)

REMAPS = (
    "__ns:=/a|__node:=b|__name:=b|n:__ns:=/a|n:__node:=b|m:__node:=b|__ns:=a|__ns:=|__ns:=/"
    "|__ns:=/a/|__ns:=~|__ns:=/a//b|__ns:=/1a|__ns:=/__x|__node:=a/b|__node:=1|__node:="
    "|__node:=~|__node:=__x|__node__:=b|__nodea:=b|__log_level:=debug|__params:=x|t:=u|/t:=u"
    "|t:=/u|~/t:=u|n:t:=u|n:~/t:=u|/n:t:=u|m:t:=u|rostopic://t:=u|rosservice://t:=u"
    "|rostopic:t:=u|n:rostopic://t:=u|n:rosservice://t:=u|rostopic://~/t:=a"
    "|rostopic://__node:=a|t:=rostopic://u|*:=u|/*/t:=u|**/t:=u|t:=~/u|t:={node}/u|{node}:=u"
    "|t:=u/|t:=1u|t:=|:=u|t|t:=u v|t:=u:=v|/ns/t:=/u|t:=ns//u|~:=u|t:=~|~a:=b|~~:=b|~/:=b"
    "|t:=~/|t:=~a|t:=/|/:=t|__a:=b|t:=__a|_a:=b|t:=_a|a/__b:=c|/__a:=b|~/__a:=b|__a/b:=c"
    "|n:__a:=b|n:~:=a"
)


def _remapped(*args: Any, namespace: Any) -> Any:
    rclpy.shutdown()
    rclpy.init(args=["--ros-args", *args])
    node = Node("n", namespace=namespace)
    topics = [node.resolve_topic_name(name) for name in ("t", "/t", "~/t", "ns/t")]
    services = [node.resolve_service_name(name) for name in ("t", "~/t")]
    topics.append(node.create_publisher(String, "t", 1).topic_name)
    return node.get_fully_qualified_name(), topics, services


for _namespace in ("/", "/ns"):
    _probes = {
        text: lambda text=text, at=_namespace: _remapped("-r", text, namespace=at)
        for text in REMAPS.split("|")
    }
    lines(f"remap{_namespace}", **_probes)


def _local(args: Any, cli_args: Any) -> Any:
    rclpy.shutdown()
    rclpy.init(args=args)
    node = Node("n", cli_args=cli_args, automatically_declare_parameters_from_overrides=True)
    own = node.get_parameter("a").value if node.has_parameter("a") else None
    return node.get_fully_qualified_name(), node.resolve_topic_name("t"), own


_ROS = "--ros-args"
lines(
    "local",
    both=lambda: _local([_ROS, "-r", "t:=g", "-p", "a:=1"], [_ROS, "-r", "t:=l", "-p", "a:=2"]),
    only_remap=lambda: _local([_ROS, "-p", "a:=1"], [_ROS, "-r", "t:=l"]),
    without_flag=lambda: _local([], ["-r", "t:=l"]),
    between_own=lambda: _local([], ["x", _ROS, "-r", "t:=l", "--", "y"]),
    tuple=lambda: _local([], (_ROS, "-r", "t:=l")),
    text=lambda: _local([], _ROS),
    invalid=lambda: _local([], [_ROS, "-r", "t"]),
    unknown=lambda: _local([], [_ROS, "--what"]),
    namespace=lambda: _local([], [_ROS, "-r", "__ns:=/q"]),
    level=lambda: _local([], [_ROS, "--log-level", "debug"]),
    invalid_level=lambda: _local([], [_ROS, "--log-level", "x"]),
    number=lambda: _local([], [1]),
    empty=lambda: _local([], []),
    twice=lambda: _local([_ROS, "-r", "t:=g", _ROS, "-r", "t:=h"], None),
    first_parameter=lambda: _local([_ROS, "-p", "a:=1", "-p", "a:=2"], None),
    long=lambda: _local([_ROS, "--remap", "t:=u", "--param", "a:=1"], None),
    remap_without_rule=lambda: _local([_ROS, "-r"], None),
    parameter_without_rule=lambda: _local([_ROS, "-p"], None),
)


def _gids_of_events() -> Any:
    """Return which events of two clients of a service have the same GID."""
    node, heard = Node("n"), []
    service = node.create_service(SetBool, "s", lambda request, response: response)
    clients = [node.create_client(SetBool, "s") for _ in range(2)]
    for end in (service, *clients):
        end.configure_introspection(
            node.get_clock(), qos_profile_system_default, ServiceIntrospectionState.METADATA
        )
    node.create_subscription(SetBool.Event, "s/_service_event", heard.append, 10)
    for client in clients:
        client.wait_for_service(2.0)
        spun(node, client.call_async(SetBool.Request()).done)
    spun(node, lambda: len(heard) == 8)
    sent, taken, answered, received = (
        {tuple(one.info.client_gid) for one in heard if one.info.event_type == kind} for kind in range(4)
    )
    everywhere = sent | taken
    lengths = [len(gids) for gids in (sent, taken, answered, received)]
    participants = {gid[:12] for gid in everywhere}
    return lengths, sent == received, taken == answered, sent & taken, len(participants), len(everywhere)


lines("introspection", gids=_gids_of_events)


def _checked(kind: Any, field: Any, value: Any) -> Any:
    message = kind(check_fields=True)
    setattr(message, field, value)
    stored = getattr(message, field)
    return type(stored).__name__, getattr(stored, "typecode", None) or str(stored.dtype), len(stored)


_DOUBLES, _FLOATS, _BYTES = (JointState, "position"), (LaserScan, "ranges"), (Image, "data")
_COVARIANCE = (PoseWithCovariance, "covariance")
CHECKED = {
    "floats_for_doubles": (*_DOUBLES, [0.5, 1.5]),
    "tuple_for_doubles": (*_DOUBLES, (0.5, 1.5)),
    "array_for_doubles": (*_DOUBLES, array("d", [0.5])),
    "empty_for_doubles": (*_DOUBLES, []),
    "text_for_doubles": (*_DOUBLES, "ab"),
    "texts_for_doubles": (*_DOUBLES, ["a"]),
    "number_for_doubles": (*_DOUBLES, 1.0),
    "nothing_for_doubles": (*_DOUBLES, None),
    "list_for_bytes": (*_BYTES, [1, 2]),
    "bytes_for_bytes": (*_BYTES, b"ab"),
    "large_for_bytes": (*_BYTES, [300]),
    "text_for_bytes": (*_BYTES, "ab"),
    "floats_for_bytes": (*_BYTES, [1.0]),
    "floats_for_covariance": (*_COVARIANCE, [0.5] * 36),
    "numpy_for_covariance": (*_COVARIANCE, np.zeros(36)),
    "text_for_covariance": (*_COVARIANCE, "a" * 36),
    # Without checks, and in the kit, these are converted.
    "ints_for_doubles": (*_DOUBLES, [1, 2]),
    "bytes_for_doubles": (*_DOUBLES, b"ab"),
    "numpy_ints_for_doubles": (*_DOUBLES, np.array([1, 2])),
    "array_of_floats_for_doubles": (*_DOUBLES, array("f", [0.5])),
    "array_of_doubles_for_floats": (*_FLOATS, array("d", [0.5])),
    "numpy_for_bytes": (*_BYTES, np.array([1, 2], np.uint8)),
    "array_of_ints_for_bytes": (*_BYTES, array("i", [1])),
    "numpy_matrix_for_covariance": (*_COVARIANCE, np.zeros((6, 6))),
    "numpy_ints_for_covariance": (*_COVARIANCE, np.zeros(36, int)),
}
lines("checked", **{name: lambda case=case: outcome(_checked, *case) for name, case in CHECKED.items()})

if __name__ == "__main__":
    main()
