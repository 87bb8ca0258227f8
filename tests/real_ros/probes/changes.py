# mypy: ignore-errors
"""Changes of parameters: callbacks before, at and after them, events, handlers and descriptions.

Many of the calls are wrong on purpose.
"""

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
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_event_handler import ParameterEventHandler

ACCEPTED, REJECTED = SetParametersResult(successful=True), SetParametersResult(reason="never")


def _node(**values: Any) -> Node:
    node = Node("n", namespace="/ns")
    for name, value in (values or {"speed": 1.0}).items():
        node.declare_parameter(name, value)
    return node


def _set(node: Node, **values: Any) -> list[Any]:
    return [
        outcome(lambda name=name, value=value: node.set_parameters([Parameter(name, value=value)]))
        for name, value in values.items()
    ]


def _values(node: Node) -> list[Any]:
    return sorted((one.name, one.value) for one in node._parameters.values() if one.name != "use_sim_time")


def _with_callback(kind: str, callback: Any, **values: Any) -> list[Any]:
    """Set parameters of a node that has a callback, and return the results and the values."""
    node = _node(speed=1.0, name="a")
    added = outcome(lambda: getattr(node, f"add_{kind}_parameters_callback")(callback))
    results = _set(node, **(values or {"speed": 2.0}))
    return [added.split("(")[0][:40], results, _values(node)]


def _pairs(parameters: Any) -> list[Any]:
    return [(one.name, one.value) for one in parameters]


def _clamped(parameters: Any) -> list[Any]:
    return [Parameter(one.name, value=min(one.value, 1.5)) for one in parameters]


CALLBACKS = {
    "identity": lambda parameters: parameters,
    "nothing": lambda parameters: None,
    "empty": lambda parameters: [],
    "tuple": tuple,
    "text": lambda parameters: "x",
    "fails": lambda parameters: 1 / 0,
    "accepts": lambda parameters: ACCEPTED,
    "rejects": lambda parameters: REJECTED,
    "true": lambda parameters: True,
    "class": lambda parameters: SetParametersResult,
    "no_arguments": lambda: None,
    "two_arguments": lambda parameters, more: None,
    "list_of_results": lambda parameters: [ACCEPTED],
}
for kind in ("pre_set", "on_set", "post_set"):
    lines(
        kind,
        **{
            name: (lambda kind=kind, callback=callback: _with_callback(kind, callback))
            for name, callback in CALLBACKS.items()
        },
    )
lines(
    "pre_set",
    clamps=lambda: _with_callback("pre_set", _clamped, speed=9.0),
    adds=lambda: _with_callback("pre_set", lambda given: [*given, Parameter("name", value="b")], speed=2.0),
    adds_undeclared=lambda: _with_callback("pre_set", lambda given: [*given, Parameter("x", value=1)]),
    changes_type=lambda: _with_callback("pre_set", lambda given: [Parameter("speed", value="fast")]),
    renames=lambda: _with_callback("pre_set", lambda given: [Parameter("name", value="b")]),
)


@probe
def order_of_callbacks() -> list[Any]:
    node, calls = _node(speed=1.0), []
    for name in "ab":
        node.add_pre_set_parameters_callback(lambda given, name=name: calls.append(f"pre {name}") or given)
        node.add_on_set_parameters_callback(lambda given, name=name: calls.append(f"on {name}") or ACCEPTED)
        node.add_post_set_parameters_callback(lambda given, name=name: calls.append(f"post {name}"))
    _set(node, speed=2.0)
    return calls


@probe
def callbacks_of_a_rejected_change() -> list[Any]:
    node, calls = _node(speed=1.0), []
    node.add_on_set_parameters_callback(lambda given: calls.append("first") or REJECTED)
    node.add_on_set_parameters_callback(lambda given: calls.append("second") or ACCEPTED)
    node.add_post_set_parameters_callback(lambda given: calls.append("after"))
    return [_set(node, speed=2.0), calls, _values(node)]


@probe
def callbacks_of_a_declaration() -> list[Any]:
    node, calls = Node("n"), []
    node.add_pre_set_parameters_callback(lambda given: calls.append(("pre", _pairs(given))) or given)
    node.add_on_set_parameters_callback(lambda given: calls.append(("on", _pairs(given))) or ACCEPTED)
    node.add_post_set_parameters_callback(lambda given: calls.append(("post", _pairs(given))))
    node.declare_parameter("a", 1)
    node.undeclare_parameter("a")
    return calls


@probe
def declaration_that_a_callback_rejects() -> list[Any]:
    node = Node("n")
    node.add_on_set_parameters_callback(lambda given: REJECTED)
    return [outcome(lambda: node.declare_parameter("a", 1)), node.has_parameter("a")]


@probe
def value_seen_by_callbacks() -> list[Any]:
    node, values = _node(speed=1.0), []

    def note(given: Any) -> Any:
        values.append((node.get_parameter("speed").value, given[0].value))
        return ACCEPTED

    node.add_on_set_parameters_callback(note)
    node.add_post_set_parameters_callback(lambda given: note(given) and None)
    _set(node, speed=2.0)
    return values


@probe
def callback_that_sets_the_same_parameter() -> list[Any]:
    node, calls = _node(speed=1.0), []

    def on_set(given: Any) -> Any:
        calls.append(given[0].value)
        if given[0].value < 3.0:
            node.set_parameters([Parameter("speed", value=given[0].value + 1.0)])
        return ACCEPTED

    node.add_on_set_parameters_callback(on_set)
    return [_set(node, speed=2.0), calls, _values(node)]


@probe
def callbacks_that_are_removed() -> list[Any]:
    node, calls = _node(speed=1.0), []

    def pre(given: Any) -> Any:
        calls.append("pre")
        return given

    def on_set(given: Any) -> Any:
        calls.append("on")
        return ACCEPTED

    def post(given: Any) -> None:
        calls.append("post")

    for kind, callback in (("pre_set", pre), ("on_set", on_set), ("post_set", post)):
        getattr(node, f"add_{kind}_parameters_callback")(callback)
    results = []
    for kind, callback in (("pre_set", pre), ("on_set", on_set), ("post_set", post)):
        remove = getattr(node, f"remove_{kind}_parameters_callback")
        results += [outcome(remove, callback), outcome(remove, callback)]
        _set(node, speed=2.0)
    return [results, calls]


lines(
    "set",
    several=lambda: _node(a=1, b=2).set_parameters(
        [Parameter("a", value=5), Parameter("x", value=1), Parameter("b", value=6)]
    ),
    atomically=lambda: (
        lambda node: [
            node.set_parameters_atomically([Parameter("a", value=5), Parameter("b", value=6)]),
            _values(node),
        ]
    )(_node(a=1, b=2)),
    atomically_one_wrong_type=lambda: (
        lambda node: [
            outcome(
                lambda: node.set_parameters_atomically([Parameter("a", value=5), Parameter("b", value="x")])
            ),
            _values(node),
        ]
    )(_node(a=1, b=2)),
    atomically_undeclared=lambda: (
        lambda node: [
            outcome(
                lambda: node.set_parameters_atomically([Parameter("a", value=5), Parameter("x", value=1)])
            ),
            _values(node),
        ]
    )(_node(a=1, b=2)),
    atomically_rejected=lambda: _atomically_rejected(),
    empty=lambda: _node().set_parameters([]),
    atomically_empty=lambda: _node().set_parameters_atomically([]),
    single=lambda: _node().set_parameters(Parameter("speed", value=2.0)),
    dictionary=lambda: _node().set_parameters({"speed": 2.0}),
    tuple_of_pair=lambda: _node().set_parameters([("speed", 2.0)]),
    same_value=lambda: _set(_node(), speed=1.0),
    integer_for_float=lambda: _set(_node(), speed=2),
    bool_for_integer=lambda: _set(_node(a=1), a=True),
    float_for_integer=lambda: _set(_node(a=1), a=2.0),
    text_for_float=lambda: _set(_node(), speed="2.0"),
    nothing_for_float=lambda: (lambda node: [_set(node, speed=None), _values(node)])(_node()),
    list_for_float=lambda: _set(_node(), speed=[1.0]),
    empty_list_for_list=lambda: (lambda node: [_set(node, a=[]), _values(node)])(_node(a=[1])),
    tuple_for_list=lambda: (lambda node: [_set(node, a=(1, 2)), _values(node)])(_node(a=[1])),
    mixed_list=lambda: _set(_node(a=[1]), a=[1, 2.0]),
    list_of_lists=lambda: _set(_node(a=[1]), a=[[1]]),
    undeclared_allowed=lambda: (
        lambda node: [node.set_parameters([Parameter("x", value=1)]), node.get_parameter("x").value]
    )(Node("n", allow_undeclared_parameters=True)),
    by_prefix=lambda: {
        name: one.value
        for name, one in _node(**{"arm.a": 1, "arm.b.c": 2, "leg": 3}).get_parameters_by_prefix("arm").items()
    },
    by_prefix_with_dot=lambda: list(_node(**{"arm.a": 1}).get_parameters_by_prefix("arm.")),
    by_empty_prefix=lambda: sorted(_node(**{"arm.a": 1}).get_parameters_by_prefix("")),
    by_unknown_prefix=lambda: _node(**{"arm.a": 1}).get_parameters_by_prefix("leg"),
    or_other=lambda: _node().get_parameter_or("x", Parameter("x", value=4)).value,
    or_nothing=lambda: _node().get_parameter_or("x").value,
    or_known=lambda: _node().get_parameter_or("speed", Parameter("speed", value=4.0)).value,
    type_of_unknown=lambda: _node().get_parameter_type("x"),
    type_of_float=lambda: _node().get_parameter_type("speed"),
    get_unknown=lambda: _node().get_parameter("x"),
    get_several=lambda: _pairs(_node(a=1, b=2).get_parameters(["a", "b"])),
    get_several_unknown=lambda: _node(a=1).get_parameters(["a", "x"]),
    get_text=lambda: _node(a=1).get_parameters("a"),
    undeclare_unknown=lambda: _node().undeclare_parameter("x"),
    undeclare_read_only=lambda: _described(read_only=True).undeclare_parameter("a"),
    undeclare_static=lambda: _node().undeclare_parameter("speed"),
    has=lambda: [_node().has_parameter("speed"), _node().has_parameter("x")],
    declare_twice=lambda: _node().declare_parameter("speed", 2.0),
    declare_several=lambda: _pairs(Node("n").declare_parameters("ns", [("a", 1), ("b", 2.0)])),
    declare_several_without_namespace=lambda: _pairs(Node("n").declare_parameters("", [("a", 1)])),
    declare_several_dotted=lambda: _pairs(Node("n").declare_parameters("ns.", [("a", 1)])),
    declare_several_name_only=lambda: Node("n").declare_parameters("", [("a",)]),
    declare_several_text=lambda: Node("n").declare_parameters("", ["a"]),
    declare_several_twice=lambda: Node("n").declare_parameters("", [("a", 1), ("a", 2)]),
    declare_several_empty=lambda: Node("n").declare_parameters("", []),
    declare_type=lambda: Node("n").declare_parameter("a", Parameter.Type.INTEGER).value,
    declare_type_unset=lambda: (
        lambda node: [
            node.declare_parameter("a", Parameter.Type.DOUBLE).type_,
            outcome(lambda: node.get_parameter("a").value),
        ]
    )(Node("n")),
    declare_override=lambda: (
        Node("n", parameter_overrides=[Parameter("a", value=7)]).declare_parameter("a", 1).value
    ),
    declare_ignoring_override=lambda: (
        Node("n", parameter_overrides=[Parameter("a", value=7)])
        .declare_parameter("a", 1, ignore_override=True)
        .value
    ),
    declare_override_of_another_type=lambda: Node(
        "n", parameter_overrides=[Parameter("a", value="x")]
    ).declare_parameter("a", 1),
    automatically_declared=lambda: _values(
        Node(
            "n",
            parameter_overrides=[Parameter("a", value=7)],
            automatically_declare_parameters_from_overrides=True,
        )
    ),
)


def _atomically_rejected() -> list[Any]:
    node = _node(a=1, b=2)
    node.add_on_set_parameters_callback(lambda given: REJECTED)
    result = node.set_parameters_atomically([Parameter("a", value=5), Parameter("b", value=6)])
    return [result, _values(node)]


def _described(**options: Any) -> Node:
    node = Node("n")
    node.declare_parameter("a", 5, ParameterDescriptor(**options))
    return node


_STEPS = IntegerRange(from_value=0, to_value=10, step=5)
_HALVES = FloatingPointRange(from_value=0.0, to_value=1.0, step=0.5)
lines(
    "describe",
    plain=lambda: _node().describe_parameter("speed"),
    several=lambda: [one.name for one in _node(a=1, b=2).describe_parameters(["a", "b"])],
    unknown=lambda: _node().describe_parameter("x"),
    several_unknown=lambda: _node(a=1).describe_parameters(["a", "x"]),
    unknown_allowed=lambda: Node("n", allow_undeclared_parameters=True).describe_parameter("x"),
    with_description=lambda: _described(description="one", additional_constraints="two").describe_parameter(
        "a"
    ),
    name_in_descriptor=lambda: _described(name="other").describe_parameter("a").name,
    type_in_descriptor=lambda: _described(type=ParameterType.PARAMETER_STRING).describe_parameter("a").type,
    range_in_descriptor=lambda: _described(integer_range=[_STEPS]).describe_parameter("a").integer_range,
    outside=lambda: _set(_described(integer_range=[_STEPS]), a=11),
    between_steps=lambda: _set(_described(integer_range=[_STEPS]), a=3),
    last_value=lambda: _set(_described(integer_range=[_STEPS]), a=10),
    below=lambda: _set(_described(integer_range=[_STEPS]), a=-1),
    float_range_for_integer=lambda: _set(_described(floating_point_range=[_HALVES]), a=7),
    read_only=lambda: _set(_described(read_only=True), a=7),
    dynamic=lambda: (lambda node: [_set(node, a="x"), _values(node)])(_described(dynamic_typing=True)),
    set_descriptor=lambda: (
        lambda node: [
            node.set_descriptor("a", ParameterDescriptor(description="new")),
            node.describe_parameter("a").description,
        ]
    )(_described()),
    set_descriptor_with_value=lambda: (
        lambda node: [
            node.set_descriptor(
                "a",
                ParameterDescriptor(read_only=True),
                Parameter("a", value=6).get_parameter_value(),
            ).integer_value,
            _values(node),
            _set(node, a=7),
        ]
    )(_described()),
    set_descriptor_of_unknown=lambda: _node().set_descriptor("x", ParameterDescriptor()),
    set_descriptor_of_read_only=lambda: _described(read_only=True).set_descriptor("a", ParameterDescriptor()),
    descriptor_is_text=lambda: Node("n").declare_parameter("a", 1, "a description"),
    descriptor_is_a_class=lambda: Node("n").declare_parameter("a", 1, ParameterDescriptor),
)


def _events(*changes: Any, **options: Any) -> list[Any]:
    """Return the events of changes of a node, as another node receives them."""
    node, other, events = Node("n", **options), Node("other"), []

    def on_event(event: Any) -> None:
        if event.node == "/n":
            events.append(
                [[one.name for one in group] for group in (event.new_parameters, event.changed_parameters)]
                + [[one.name for one in event.deleted_parameters]]
            )

    other.create_subscription(ParameterEvent, "/parameter_events", on_event, 10)
    _settle(other)
    events.clear()
    for change in changes:
        outcome(lambda change=change: change(node))
    _settle(other)
    return events


def _settle(node: Node, seconds: float = 0.3) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.02)


lines(
    "event",
    declared=lambda: _events(lambda node: node.declare_parameter("a", 1)),
    declared_without_a_value=lambda: _events(
        lambda node: node.declare_parameter("a", Parameter.Type.INTEGER)
    ),
    changed=lambda: _events(
        lambda node: node.declare_parameter("a", 1),
        lambda node: node.set_parameters([Parameter("a", value=2)]),
    ),
    unchanged=lambda: _events(
        lambda node: node.declare_parameter("a", 1),
        lambda node: node.set_parameters([Parameter("a", value=1)]),
    ),
    rejected=lambda: _events(
        lambda node: node.declare_parameter("a", 1),
        lambda node: node.set_parameters([Parameter("a", value="x")]),
    ),
    undeclared=lambda: _events(
        lambda node: node.declare_parameter("a", 1, ParameterDescriptor(dynamic_typing=True)),
        lambda node: node.undeclare_parameter("a"),
    ),
    several=lambda: _events(lambda node: node.declare_parameters("", [("a", 1), ("b", 2)])),
    atomically=lambda: _events(
        lambda node: node.declare_parameters("", [("a", 1), ("b", 2)]),
        lambda node: node.set_parameters_atomically([Parameter("a", value=3), Parameter("b", value=4)]),
    ),
    one_by_one=lambda: _events(
        lambda node: node.declare_parameters("", [("a", 1), ("b", 2)]),
        lambda node: node.set_parameters([Parameter("a", value=3), Parameter("b", value=4)]),
    ),
    of_sim_time=lambda: _events(lambda node: node.set_parameters([Parameter("use_sim_time", value=True)])),
    without_services=lambda: _events(
        lambda node: node.declare_parameter("a", 1), start_parameter_services=False
    ),
)


def _handled(callback_of: Any, *changes: Any) -> list[Any]:
    node, watcher, calls = Node("n"), Node("watcher"), []
    node.declare_parameter("a", 1)
    node.declare_parameter("b", 1)
    handler = ParameterEventHandler(watcher)
    results = [outcome(lambda: callback_of(handler, calls))]
    results = [type(results[0]).__name__]
    _settle(watcher)
    calls.clear()
    for name, value in changes:
        node.set_parameters([Parameter(name, value=value)])
    _settle(watcher)
    return [*results, calls]


def _note(calls: list[Any]) -> Any:
    return lambda parameter: calls.append((parameter.name, parameter.value.integer_value))


lines(
    "handler",
    one=lambda: _handled(
        lambda handler, calls: handler.add_parameter_callback("a", "n", _note(calls)), ("a", 2), ("b", 3)
    ),
    absolute_name=lambda: _handled(
        lambda handler, calls: handler.add_parameter_callback("a", "/n", _note(calls)), ("a", 2)
    ),
    other_node=lambda: _handled(
        lambda handler, calls: handler.add_parameter_callback("a", "other", _note(calls)), ("a", 2)
    ),
    unknown_parameter=lambda: _handled(
        lambda handler, calls: handler.add_parameter_callback("x", "n", _note(calls)), ("a", 2)
    ),
    all_events=lambda: _handled(
        lambda handler, calls: handler.add_parameter_event_callback(lambda event: calls.append(event.node)),
        ("a", 2),
        ("b", 3),
    ),
    latest_first=lambda: _handled(
        lambda handler, calls: [
            handler.add_parameter_callback("a", "n", lambda one, name=name: calls.append(name))
            for name in ("first", "second")
        ],
        ("a", 2),
    ),
    removed=lambda: _handled(
        lambda handler, calls: handler.remove_parameter_callback(
            handler.add_parameter_callback("a", "n", _note(calls))
        ),
        ("a", 2),
    ),
    destroyed=lambda: _handled(
        lambda handler, calls: [handler.add_parameter_callback("a", "n", _note(calls)), handler.destroy()],
        ("a", 2),
    ),
    removed_twice=lambda: (
        lambda handler: (
            lambda one: [
                handler.remove_parameter_callback(one),
                outcome(lambda: handler.remove_parameter_callback(one)),
            ]
        )(handler.add_parameter_callback("a", "n", print))
    )(ParameterEventHandler(Node("n"))),
    callback_is_text=lambda: (
        type(ParameterEventHandler(Node("n")).add_parameter_callback("a", "n", "x")).__name__
    ),
    node_is_text=lambda: ParameterEventHandler("n"),
    from_event=lambda: ParameterEventHandler.get_parameter_from_event(
        ParameterEvent(node="/n", new_parameters=[Parameter("a", value=1).to_parameter_msg()]), "a", "/n"
    ),
    from_event_of_another=lambda: ParameterEventHandler.get_parameter_from_event(
        ParameterEvent(node="/n"), "a", "/m"
    ),
    from_event_unknown=lambda: ParameterEventHandler.get_parameter_from_event(
        ParameterEvent(node="/n"), "a", "/n"
    ),
    all_from_event=lambda: [
        one.name
        for one in ParameterEventHandler.get_parameters_from_event(
            ParameterEvent(
                node="/n",
                new_parameters=[Parameter("a", value=1).to_parameter_msg()],
                changed_parameters=[Parameter("b", value=1).to_parameter_msg()],
            )
        )
    ],
)


if __name__ == "__main__":
    main()
