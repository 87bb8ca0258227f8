# mypy: ignore-errors
"""Parameters: declarations, descriptors, types, callbacks, events and clients.

Many of the calls are wrong on purpose.
"""

import array
import time
from typing import Any

import rclpy
from probing import lines, main, outcome, probe
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterEvent,
    ParameterType,
    ParameterValue,
    SetParametersResult,
)
from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import (
    Parameter,
    get_parameter_value,
    parameter_dict_from_yaml_file,
    parameter_value_to_python,
)
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler


def _text(parameter: Any) -> Any:
    if isinstance(parameter, Parameter):
        return (parameter.name, parameter.type_.name, parameter.value)
    if isinstance(parameter, list):
        return [_text(one) for one in parameter]
    return parameter


def _declared(*args: Any, **kwargs: Any) -> Any:
    return _text(Node("n").declare_parameter(*args, **kwargs))


def _then(value: Any, *changes: Any, descriptor: Any = None) -> list[Any]:
    """Declare a parameter and set it to other values; list the results and the last value."""
    node = Node("n")
    node.declare_parameter("a", value, descriptor)
    results = [
        outcome(lambda one=one: node.set_parameters([Parameter("a", value=one)])[0]) for one in changes
    ]
    return [*results, outcome(lambda: node.get_parameter("a").value)]


_DYNAMIC = ParameterDescriptor(dynamic_typing=True)
_READ_ONLY = ParameterDescriptor(read_only=True)


def _integers(low: int, high: int, step: int = 0) -> ParameterDescriptor:
    return ParameterDescriptor(integer_range=[IntegerRange(from_value=low, to_value=high, step=step)])


def _floats(low: float, high: float, step: float = 0.0) -> ParameterDescriptor:
    return ParameterDescriptor(
        floating_point_range=[FloatingPointRange(from_value=low, to_value=high, step=step)]
    )


lines(
    "declare",
    bool=lambda: _declared("a", True),
    int=lambda: _declared("a", 1),
    float=lambda: _declared("a", 1.0),
    text=lambda: _declared("a", "x"),
    bytes=lambda: _declared("a", b"x"),
    byte_list=lambda: _declared("a", [b"x", b"y"]),
    bools=lambda: _declared("a", [True, False]),
    ints=lambda: _declared("a", [1, 2]),
    floats=lambda: _declared("a", [1.0, 2.0]),
    mixed=lambda: _declared("a", [1, 2.0]),
    mixed_text=lambda: _declared("a", [1, "x"]),
    texts=lambda: _declared("a", ["x"]),
    empty_list=lambda: _declared("a", []),
    a_tuple=lambda: _declared("a", (1, 2)),
    an_array=lambda: _declared("a", array.array("q", [1, 2])),
    float_array=lambda: _declared("a", array.array("d", [1.0])),
    a_dict=lambda: _declared("a", {"x": 1}),
    a_set=lambda: _declared("a", {1}),
    nested=lambda: _declared("a", [[1], [2]]),
    none=lambda: _declared("a", None),
    nothing=lambda: _declared("a"),
    type_only=lambda: _declared("a", Parameter.Type.INTEGER),
    type_only_get=lambda: _get(Parameter.Type.INTEGER),
    type_not_set=lambda: _declared("a", Parameter.Type.NOT_SET),
    python_type=lambda: _declared("a", int),
    parameter=lambda: _declared("a", Parameter("a", value=1)),
    message=lambda: _declared("a", ParameterValue(type=2, integer_value=3)),
    no_name=lambda: _declared("", 1),
    number_as_name=lambda: _declared(3, 1),
    dots=lambda: _declared("a.b.c", 1),
    space=lambda: _declared("a b", 1),
    slash=lambda: _declared("a/b", 1),
    dash=lambda: _declared("a-b", 1),
    digit_first=lambda: _declared("1a", 1),
    twice=lambda: _declared_twice(),
    descriptor=lambda: _declared("a", 1, ParameterDescriptor(description="x")),
    wrong_descriptor=lambda: _declared("a", 1, "x"),
    out_of_range=lambda: _declared("a", 11, _integers(0, 10)),
    dynamic=lambda: _declared("a", None, _DYNAMIC),
    ignore_override=lambda: _text(
        Node("n", parameter_overrides=[Parameter("a", value=5)]).declare_parameter(
            "a", 1, ignore_override=True
        )
    ),
    override=lambda: _text(
        Node("n", parameter_overrides=[Parameter("a", value=5)]).declare_parameter("a", 1)
    ),
    override_of_another_type=lambda: _text(
        Node("n", parameter_overrides=[Parameter("a", value="5")]).declare_parameter("a", 1)
    ),
    override_of_another_type_dynamic=lambda: _text(
        Node("n", parameter_overrides=[Parameter("a", value="5")]).declare_parameter("a", 1, _DYNAMIC)
    ),
    automatically=lambda: _text(
        Node(
            "n",
            parameter_overrides=[Parameter("a", value=5)],
            automatically_declare_parameters_from_overrides=True,
        ).get_parameter("a")
    ),
)


def _declared_twice() -> list[Any]:
    node = Node("n")
    node.declare_parameter("a", 1)
    return [outcome(node.declare_parameter, "a", 2)]


def _get(value: Any) -> list[Any]:
    node = Node("n")
    node.declare_parameter("a", value)
    return [
        outcome(node.get_parameter, "a"),
        outcome(lambda: _text(node.get_parameter_or("a", Parameter("a", value=7)))),
        outcome(lambda: node.get_parameter_type("a").name),
    ]


lines(
    "many",
    plain=lambda: _text(Node("n").declare_parameters("", [("a", 1), ("b", "x")])),
    namespace=lambda: _text(Node("n").declare_parameters("ns", [("a", 1)])),
    with_descriptors=lambda: _text(Node("n").declare_parameters("", [("a", 1, _READ_ONLY)])),
    name_only=lambda: _text(Node("n").declare_parameters("", [("a",)])),
    text_only=lambda: _text(Node("n").declare_parameters("", ["a"])),
    a_dict=lambda: _text(Node("n").declare_parameters("", {"a": 1})),
    too_long=lambda: _text(Node("n").declare_parameters("", [("a", 1, _READ_ONLY, 3)])),
    wrong_descriptor=lambda: _text(Node("n").declare_parameters("", [("a", 1, 3)])),
    twice=lambda: _text(Node("n").declare_parameters("", [("a", 1), ("a", 2)])),
    empty=lambda: _text(Node("n").declare_parameters("", [])),
    no_namespace=lambda: _text(Node("n").declare_parameters([("a", 1)])),
)
lines(
    "set",
    same_type=lambda: _then(1, 2),
    other_type=lambda: _then(1, "x", 2.0, None),
    int_for_float=lambda: _then(1.0, 2),
    dynamic=lambda: _then(1, "x", 2.0, [1], descriptor=_DYNAMIC),
    read_only=lambda: _then(1, 2, descriptor=_READ_ONLY),
    in_range=lambda: _then(1, 5, 10, 11, -1, descriptor=_integers(0, 10)),
    in_steps=lambda: _then(0, 2, 3, 10, 9, descriptor=_integers(0, 10, 2)),
    in_steps_beyond=lambda: _then(1, 5, 10, descriptor=_integers(1, 10, 4)),
    floats_in_range=lambda: _then(1.0, 5.0, 10.0, 10.01, -0.01, descriptor=_floats(0.0, 10.0)),
    floats_in_steps=lambda: _then(0.0, 0.5, 0.6, 1.0, descriptor=_floats(0.0, 1.0, 0.5)),
    range_of_text=lambda: _then("x", "y", descriptor=_integers(0, 1)),
    empty_list=lambda: _then([1], []),
    longer_list=lambda: _then([1], [1, 2, 3]),
    undeclared=lambda: Node("n").set_parameters([Parameter("a", value=1)]),
    undeclared_allowed=lambda: _undeclared(),
    wrong_element=lambda: Node("n").set_parameters([3]),
    not_a_list=lambda: Node("n").set_parameters(Parameter("a", value=1)),
    empty=lambda: Node("n").set_parameters([]),
    atomically=lambda: _atomically(),
    atomically_empty=lambda: Node("n").set_parameters_atomically([]),
    descriptor=lambda: _set_descriptor(),
    descriptor_of_unknown=lambda: Node("n").set_descriptor("a", _READ_ONLY),
)


def _undeclared() -> list[Any]:
    node = Node("n", allow_undeclared_parameters=True)
    found = [_text(node.get_parameter("a")), node.set_parameters([Parameter("a", value=1)])]
    found += [node.has_parameter("a"), _text(node.get_parameter("a"))]
    found += [node.set_parameters([Parameter("a", value="x")]), _text(node.get_parameter("a"))]
    return [*found, outcome(node.undeclare_parameter, "a"), node.has_parameter("a")]


def _atomically() -> list[Any]:
    node = Node("n")
    node.declare_parameters("", [("a", 1), ("b", 2)])
    result = node.set_parameters_atomically([Parameter("a", value=5), Parameter("b", value="x")])
    return [result, node.get_parameter("a").value, node.get_parameter("b").value]


def _set_descriptor() -> list[Any]:
    node = Node("n")
    node.declare_parameter("a", 1)
    found = [outcome(node.set_descriptor, "a", ParameterDescriptor(description="new", read_only=True))]
    found.append(node.describe_parameter("a"))
    found.append(node.set_parameters([Parameter("a", value=2)])[0])
    return found


lines(
    "get",
    unknown=lambda: Node("n").get_parameter("a"),
    unknown_or=lambda: _text(Node("n").get_parameter_or("a", Parameter("a", value=3))),
    unknown_or_nothing=lambda: _text(Node("n").get_parameter_or("a")),
    several=lambda: _text(Node("n").get_parameters(["use_sim_time"])),
    several_unknown=lambda: Node("n").get_parameters(["use_sim_time", "a"]),
    several_text=lambda: Node("n").get_parameters("ab"),
    several_numbers=lambda: Node("n").get_parameters([1]),
    types=lambda: Node("n").get_parameter_types(["use_sim_time"]),
    type_unknown=lambda: Node("n").get_parameter_type("a"),
    has=lambda: [Node("n").has_parameter("a"), Node("n").has_parameter("use_sim_time")],
    prefix=lambda: _prefix(),
    describe=lambda: Node("n").describe_parameter("use_sim_time"),
    describe_unknown=lambda: Node("n").describe_parameter("a"),
    describe_several=lambda: Node("n").describe_parameters(["use_sim_time", "a"]),
    list=lambda: Node("n").list_parameters([], 0),
    list_depth=lambda: _listed(),
    undeclare=lambda: Node("n").undeclare_parameter("a"),
    undeclare_read_only=lambda: _undeclare(_READ_ONLY),
    undeclare_static=lambda: _undeclare(None),
    undeclare_dynamic=lambda: _undeclare(_DYNAMIC),
    sim_time=lambda: _text(Node("n").get_parameter("use_sim_time")),
    parameter_text=lambda: str(Node("n").get_parameter("use_sim_time"))[:24],
)


def _prefix() -> list[Any]:
    node = Node("n")
    node.declare_parameters("", [("a.b", 1), ("a.c.d", 2), ("ab", 3)])
    found = [node.get_parameters_by_prefix(one) for one in ("a", "", "a.c", "x")]
    return [sorted((name, _text(one)) for name, one in each.items()) for each in found]


def _listed() -> list[Any]:
    node = Node("n")
    node.declare_parameters("", [("a.b", 1), ("a.c.d", 2), ("ab", 3)])
    calls = [(["a"], 0), (["a"], 1), (["a"], 2), ([], 1), ([], 2), (["x"], 0), (["a", "ab"], 0), (["a."], 0)]
    found = [node.list_parameters(*call) for call in calls]
    return [(sorted(each.names), sorted(each.prefixes)) for each in found]


def _undeclare(descriptor: Any) -> list[Any]:
    node = Node("n")
    node.declare_parameter("a", 1, descriptor)
    return [outcome(node.undeclare_parameter, "a"), node.has_parameter("a")]


lines(
    "parameter",
    value=lambda: _text(Parameter("a", value=1)),
    typed=lambda: _text(Parameter("a", Parameter.Type.INTEGER, 1)),
    mismatch=lambda: Parameter("a", Parameter.Type.INTEGER, "x"),
    int_as_double=lambda: Parameter("a", Parameter.Type.DOUBLE, 1),
    list_of_mixed=lambda: Parameter("a", Parameter.Type.DOUBLE_ARRAY, [1, 2.0]),
    no_value=lambda: _text(Parameter("a")),
    typed_no_value=lambda: Parameter("a", Parameter.Type.INTEGER),
    wrong_type=lambda: Parameter("a", 2, 1),
    object=lambda: Parameter("a", value=object),
    to_message=lambda: Parameter("a", value=[1.5]).to_parameter_msg(),
    value_message=lambda: Parameter("a", value="x").get_parameter_value(),
    from_message=lambda: _text(
        Parameter.from_parameter_msg(ParameterMsg(name="a", value=ParameterValue(type=2, integer_value=3)))
    ),
    from_unknown_type=lambda: Parameter.from_parameter_msg(ParameterMsg(value=ParameterValue(type=77))),
    to_python=lambda: parameter_value_to_python(ParameterValue(type=3, double_value=1.5)),
    to_python_not_set=lambda: parameter_value_to_python(ParameterValue()),
    to_python_wrong=lambda: parameter_value_to_python(ParameterValue(type=77)),
    types=lambda: [(one.name, one.value) for one in Parameter.Type],
    type_check=lambda: [Parameter.Type.INTEGER.check(1), Parameter.Type.INTEGER.check(1.0)],
    type_check_bool=lambda: Parameter.Type.INTEGER.check(True),
    type_of_bool=lambda: Parameter.Type.from_parameter_value(True),
    type_of_nothing=lambda: Parameter.Type.from_parameter_value(None),
    type_of_numpy=lambda: Parameter.Type.from_parameter_value(__import__("numpy").float64(1)),
    type_of_array=lambda: Parameter.Type.from_parameter_value(__import__("numpy").zeros(2)),
    constants=lambda: [ParameterType.PARAMETER_STRING, ParameterType.PARAMETER_STRING_ARRAY],
    equal=lambda: Parameter("a", value=1) == Parameter("a", value=1),
)
_YAML = (
    *("1", "1.0", "true", "True", "yes", "on", "text", "'1'", "[1, 2]", "[1.0, 2]", "[a, b]", "[]"),
    *("", "null", "~", "1e3", "1.e3", "0x10", "1_000", "-5", ".5", "inf", ".inf", "nan", ".nan", "[1, a]"),
    *("[true, false]", "[", "010", "0b11", "[[1], [2]]", "+1"),
)
lines(
    "yaml_value",
    **{f"v{number}": lambda text=text: get_parameter_value(text) for number, text in enumerate(_YAML)},
)


def _on_set(*callbacks: Any) -> list[Any]:
    node, seen = Node("n"), []
    node.declare_parameter("a", 1)
    for callback in callbacks:
        node.add_on_set_parameters_callback(lambda ps, callback=callback: (seen.append(1), callback(ps))[1])
    result = outcome(lambda: node.set_parameters([Parameter("a", value=2)]))
    return [result, len(seen), node.get_parameter("a").value]


def _accept(parameters: Any) -> SetParametersResult:
    return SetParametersResult(successful=True)


def _reject(parameters: Any) -> SetParametersResult:
    return SetParametersResult(successful=False, reason="no")


lines(
    "callbacks",
    accepts=lambda: _on_set(_accept),
    rejects=lambda: _on_set(_reject),
    last_one_first=lambda: _on_set(_accept, _reject),
    first_rejects=lambda: _on_set(_reject, _accept),
    raises=lambda: _on_set(lambda ps: 1 / 0),
    wrong_arguments=lambda: _on_set(lambda: None),
    remove_unknown=lambda: Node("n").remove_on_set_parameters_callback(print),
    none=lambda: Node("n").add_on_set_parameters_callback(None),
    pre=lambda: _pre(lambda ps: [Parameter("a", value=7)]),
    pre_empty=lambda: _pre(lambda ps: []),
    pre_none=lambda: _pre(lambda ps: None),
    pre_same=lambda: _pre(lambda ps: ps),
    post=lambda: _post(),
    remove_pre_unknown=lambda: Node("n").remove_pre_set_parameters_callback(print),
    remove_post_unknown=lambda: Node("n").remove_post_set_parameters_callback(print),
    called_for_declare=lambda: _for_declare(),
)


def _pre(callback: Any) -> list[Any]:
    node = Node("n")
    node.declare_parameter("a", 1)
    node.add_pre_set_parameters_callback(callback)
    return [outcome(node.set_parameters, [Parameter("a", value=2)]), node.get_parameter("a").value]


def _post() -> list[Any]:
    node, seen = Node("n"), []
    node.declare_parameter("a", 1)
    node.add_post_set_parameters_callback(lambda ps: seen.append(_text(ps)))
    node.set_parameters([Parameter("a", value=2)])
    node.set_parameters([Parameter("a", value="x")])
    return seen


def _for_declare() -> list[Any]:
    node, seen = Node("n"), []
    node.add_on_set_parameters_callback(lambda ps: (seen.append(_text(ps)), _accept(ps))[1])
    node.declare_parameter("a", 1)
    node.declare_parameters("", [("b", 2), ("c", 3)])
    return seen


def _until(ready: Any, *nodes: Node, limit: float = 5.0) -> None:
    executor = SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    end = time.monotonic() + limit
    while not ready() and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)


@probe
def events_of_parameters() -> list[Any]:
    node, other, seen = Node("n"), Node("other"), []
    subscription = other.create_subscription(ParameterEvent, "/parameter_events", seen.append, 10)
    _until(lambda: other.count_publishers("/parameter_events") > 1, node, other)
    _until(
        lambda: (
            subscription.get_publisher_count() > 1 if hasattr(subscription, "get_publisher_count") else False
        ),
        other,
        limit=0.5,
    )
    node.declare_parameter("a", 1, _DYNAMIC)
    node.set_parameters([Parameter("a", value=2)])
    node.undeclare_parameter("a")
    _until(lambda: len(seen) == 3, node, other, limit=2.0)
    return [
        (
            one.node,
            *(
                [(p.name, p.value.type) for p in part]
                for part in (one.new_parameters, one.changed_parameters, one.deleted_parameters)
            ),
        )
        for one in seen
    ]


def _ask(call: Any) -> Any:
    node, user = Node("n"), Node("user")
    node.declare_parameters("", [("a", 1), ("b", "x", _READ_ONLY)])
    client = AsyncParameterClient(user, "n")
    client.wait_for_services(timeout_sec=5.0)
    future = call(client)
    _until(future.done, node, user)
    return future.result()


lines(
    "remote",
    get=lambda: _ask(lambda c: c.get_parameters(["a", "b"])),
    get_unknown=lambda: _ask(lambda c: c.get_parameters(["a", "zz"])),
    set=lambda: _ask(lambda c: c.set_parameters([Parameter("a", value=5)])),
    set_wrong=lambda: _ask(
        lambda c: c.set_parameters([Parameter("a", value="x"), Parameter("b", value="y")])
    ),
    set_unknown=lambda: _ask(lambda c: c.set_parameters([Parameter("zz", value="x")])),
    set_message=lambda: _ask(lambda c: c.set_parameters([Parameter("a", value=5).to_parameter_msg()])),
    set_atomically=lambda: _ask(
        lambda c: c.set_parameters_atomically([Parameter("a", value=5), Parameter("b", value="y")])
    ),
    list=lambda: _ask(lambda c: c.list_parameters(["a"], 1)),
    types=lambda: _ask(lambda c: c.get_parameter_types(["a", "b", "zz"])),
    describe=lambda: _ask(lambda c: c.describe_parameters(["b"])),
    describe_unknown=lambda: _ask(lambda c: c.describe_parameters(["zz"])),
    delete=lambda: _ask(lambda c: c.delete_parameters(["a"])),
    ready=lambda: AsyncParameterClient(Node("n"), "nobody").services_are_ready(),
    wait=lambda: AsyncParameterClient(Node("n"), "nobody").wait_for_services(timeout_sec=0.3),
)
lines(
    "file",
    missing=lambda: parameter_dict_from_yaml_file("/nowhere/x.yaml"),
)


@probe
def handler_of_events() -> list[Any]:
    node, other, seen = Node("n"), Node("other"), []
    node.declare_parameter("a", 1)
    handler = ParameterEventHandler(other)
    handle = handler.add_parameter_callback("a", "n", lambda p: seen.append(p.value.integer_value))
    handler.add_parameter_event_callback(lambda event: seen.append(event.node))
    _until(lambda: other.count_publishers("/parameter_events") > 1, node, other)
    _until(lambda: False, node, other, limit=0.3)
    node.set_parameters([Parameter("a", value=2)])
    _until(lambda: len(seen) == 2, node, other, limit=2.0)
    handler.remove_parameter_callback(handle)
    node.set_parameters([Parameter("a", value=3)])
    _until(lambda: len(seen) == 3, node, other, limit=2.0)
    return [seen, outcome(handler.remove_parameter_callback, handle)]


_SERVICES = (DescribeParameters, GetParameters, ListParameters, SetParameters)


@probe
def services_of_parameters() -> list[str]:
    return sorted(service.srv_name for service in rclpy.create_node("n").services)


@probe
def node_without_parameter_services() -> list[str]:
    return [service.srv_name for service in Node("n", start_parameter_services=False).services]


if __name__ == "__main__":
    main()
