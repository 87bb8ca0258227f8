# mypy: ignore-errors
"""Parameters: ranges and types, callbacks with odd results, prefixes, and overrides of QoS."""

from typing import Any

from probing import lines, main, outcome
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSPolicyKind, QoSProfile
from rclpy.qos_overriding_options import QosCallbackResult, QoSOverridingOptions
from std_msgs.msg import String

NAN, INFINITY = float("nan"), float("inf")
OF_INT, OF_FLOAT = "integer_range", "floating_point_range"


def _range(kind: Any, first: Any, last: Any, step: Any = 0) -> Any:
    message = {OF_INT: IntegerRange, OF_FLOAT: FloatingPointRange}[kind]
    step = type(first)(step)
    return ParameterDescriptor(**{kind: [message(from_value=first, to_value=last, step=step)]})


def _descriptor(**fields: Any) -> Any:
    return ParameterDescriptor(**fields)


# The declared value, the descriptor, and values that are set afterwards.
DECLARED = {
    "int_with_step": (4, _range(OF_INT, 0, 10, 2), (6, 7, 10, 12, -2, 0, 11)),
    "int_without_step": (4, _range(OF_INT, 0, 10), (3, 10, 11)),
    "int_with_an_edge_off_the_step": (0, _range(OF_INT, 0, 9, 4), (8, 9, 4, 1)),
    "int_with_one_value": (5, _range(OF_INT, 5, 5), (5, 6)),
    "int_reversed": (5, _range(OF_INT, 10, 0), (5, 0, 10)),
    "int_outside": (11, _range(OF_INT, 0, 10), (3,)),
    "float_with_step": (0.5, _range(OF_FLOAT, 0.0, 1.0, 0.25), (0.25, 0.3, 1.0, 1.0000001, 0.0, -0.1)),
    "float_without_step": (0.5, _range(OF_FLOAT, 0.0, 1.0), (0.3, 1.0, 1.1, NAN, INFINITY)),
    "float_with_thirds": (0.0, _range(OF_FLOAT, 0.0, 1.0, 1 / 3), (1 / 3, 2 / 3, 0.333, 1.0)),
    "float_and_int": (0.5, _range(OF_FLOAT, 0.0, 1.0), (1,)),
    "text_with_a_range": ("x", _range(OF_INT, 0, 1), ("y",)),
    "read_only": (1, _descriptor(read_only=True), (2, 1)),
    "dynamic": (1, _descriptor(dynamic_typing=True), ("x", 2.0, None, [1])),
    "dynamic_and_read_only": (1, _descriptor(dynamic_typing=True, read_only=True), ("x",)),
    "with_the_type_of_text": (1, _descriptor(type=ParameterType.PARAMETER_STRING), ("x", 2)),
    "nothing": (None, ParameterDescriptor(), (1,)),
    "nothing_dynamic": (None, _descriptor(dynamic_typing=True), (1, "x", None)),
    "nothing_of_int": (None, _descriptor(type=ParameterType.PARAMETER_INTEGER), (1, "x")),
    "type": (Parameter.Type.INTEGER, ParameterDescriptor(), (1, "x")),
    "type_not_set": (Parameter.Type.NOT_SET, ParameterDescriptor(), (1,)),
    "bool_and_int": (True, ParameterDescriptor(), (1, False)),
    "mixed_list": ([1, 2.0], ParameterDescriptor(), ()),
    "empty_list": ([], ParameterDescriptor(), ([1], ["a"])),
    "tuple": ((1, 2), ParameterDescriptor(), ((3,), [4])),
    "bytes": (b"a", ParameterDescriptor(), (b"b",)),
    "list_of_bytes": ([b"a", b"b"], ParameterDescriptor(), ([b"c"],)),
    "list_of_text": (["a"], ParameterDescriptor(), (["b"], [], "b")),
    "list_of_floats": ([1.0], ParameterDescriptor(), ([1], [2.0])),
    "deleted": (1, ParameterDescriptor(), (None,)),
    "dict": ({"a": 1}, ParameterDescriptor(), ()),
    "set": ({1}, ParameterDescriptor(), ()),
    "range": (range(3), ParameterDescriptor(), (range(2),)),
}


def _declare(value: Any, descriptor: Any, later: Any = (), **options: Any) -> Any:
    node = Node("n", parameter_overrides=options.pop("overrides", None))
    found = [outcome(lambda: node.declare_parameter("a", value, descriptor, **options).value)]
    for one in later:
        (result,) = node.set_parameters([Parameter("a", value=one)])
        found.append((result.successful, result.reason, outcome(lambda: node.get_parameter("a").value)))
    return found


for _name, (_value, _about, _later) in DECLARED.items():
    _seven = [Parameter("a", value=7)]
    lines(
        "declared",
        **{
            _name: lambda value=_value, about=_about, later=_later: _declare(value, about, later),
            f"{_name}_with_an_override": lambda value=_value, about=_about, seven=_seven: _declare(
                value, about, overrides=seven
            ),
            f"{_name}_without_an_override": lambda value=_value, about=_about, seven=_seven: _declare(
                value, about, overrides=seven, ignore_override=True
            ),
        },
    )

_NO = SetParametersResult(successful=False, reason="why")
# Results of callbacks, or functions of the parameters that return them.
RESULTS = {
    "on_set": {
        "yes": SetParametersResult(successful=True),
        "no": _NO,
        "nothing": None,
        "true": True,
        "error": lambda parameters: 1 / 0,
        "no_for_the_second": lambda parameters: SetParametersResult(successful=parameters[0].name != "b"),
    },
    "pre_set": {
        "the_same": lambda parameters: parameters,
        "nothing": None,
        "an_empty_list": [],
        "one_more": lambda parameters: [*parameters, Parameter("c", value=1)],
        "other_values": lambda parameters: [Parameter(one.name, value=9) for one in parameters],
        "error": lambda parameters: 1 / 0,
        "text": "x",
        "tuple": tuple,
    },
    "post_set": {"nothing": None, "error": lambda parameters: 1 / 0, "number": 3},
}


def _set_with_callback(kind: Any, result: Any, *, at_once: Any) -> Any:
    node, seen = Node("n"), []
    for name in "ab":
        node.declare_parameter(name, 1)

    def callback(parameters: Any) -> Any:
        seen.append([(one.name, one.value) for one in parameters])
        return result(parameters) if callable(result) else result

    added = outcome(getattr(node, f"add_{kind}_parameters_callback"), callback)
    parameters = [Parameter("a", value=5), Parameter("b", value=6)]

    def results() -> Any:
        several = [node.set_parameters_atomically(parameters)] if at_once else node.set_parameters(parameters)
        return [(one.successful, one.reason) for one in several]

    return added, outcome(results), seen, [node.get_parameter(name).value for name in "ab"]


for _kind, _results in RESULTS.items():
    for _name, _result in _results.items():
        for _at_once in (False, True):
            lines(
                f"{_kind}.{'at_once' if _at_once else 'one_by_one'}",
                **{
                    _name: lambda kind=_kind, result=_result, at_once=_at_once: _set_with_callback(
                        kind, result, at_once=at_once
                    )
                },
            )


def _many() -> Node:
    node = Node("n")
    for value, name in enumerate(("a", "a.b", "a.b.c", "ab", "z.a", "z.b")):
        node.declare_parameter(name, value)
    return node


def _by_prefix(prefix: Any) -> Any:
    return sorted((key, one.name, one.value) for key, one in _many().get_parameters_by_prefix(prefix).items())


def _listed(prefixes: Any, depth: Any) -> Any:
    result = _many().list_parameters(prefixes, depth)
    return sorted(name for name in result.names if name[0] in "az"), sorted(result.prefixes)


for _prefix in ("a", "a.", "a.b", "z", "", "q", "A", "z.a", "ab", ".", "a.b.c", None, 3):
    lines("by_prefix", **{f"{_prefix!r}": lambda prefix=_prefix: _by_prefix(prefix)})
for _prefixes in ([], ["a"], ["a", "z"], ["q"], ["a."], ["a.b.c"], [""], ["a", "a"], "a", None, [1]):
    for _depth in (0, 1, 2):
        lines(
            "listed",
            **{f"{_prefixes}_{_depth}": lambda prefixes=_prefixes, depth=_depth: _listed(prefixes, depth)},
        )


def _accept(profile: Any) -> Any:
    result = QosCallbackResult()
    result.successful = True
    return result


_default = QoSOverridingOptions.with_default_policies
_DURATIONS = [QoSPolicyKind.DEADLINE, QoSPolicyKind.LIFESPAN, QoSPolicyKind.LIVELINESS_LEASE_DURATION]
# The options, and overrides of parameters, by the last part of their names.
OVERRIDES = {
    "none_set": (_default, {}),
    "depth": (_default, {"depth": 7}),
    "reliability": (_default, {"reliability": "best_effort"}),
    "history": (_default, {"history": "keep_all"}),
    "wrong_text": (_default, {"reliability": "x"}),
    "wrong_type": (_default, {"depth": "x"}),
    "negative_depth": (_default, {"depth": -1}),
    "refused": (lambda: _default(callback=lambda profile: QosCallbackResult()), {}),
    "accepted": (lambda: _default(callback=_accept), {}),
    "callback_with_an_error": (lambda: _default(callback=lambda profile: 1 / 0), {}),
    "other_id": (lambda: _default(entity_id="x"), {"depth": 9}),
    "durability": (
        lambda: QoSOverridingOptions([QoSPolicyKind.DURABILITY]),
        {"durability": "transient_local"},
    ),
    "durations": (lambda: QoSOverridingOptions(_DURATIONS), {"deadline": 10**9}),
    "no_kinds": (lambda: QoSOverridingOptions([]), {"depth": 9}),
    "invalid_kind": (lambda: QoSOverridingOptions([QoSPolicyKind.INVALID]), {}),
    "no_options": (lambda: None, {"depth": 9}),
}


def _overridden(kind: Any, options: Any, overrides: Any) -> Any:
    values = [Parameter(f"qos_overrides./t.{kind}.{name}", value=value) for name, value in overrides.items()]
    node = Node("n", parameter_overrides=values)
    more = (print,) if kind == "subscription" else ()
    create = getattr(node, f"create_{kind}")
    profile = create(
        String, "t", *more, qos_profile=QoSProfile(depth=3), qos_overriding_options=options()
    ).qos_profile
    declared = {name: one.value for name, one in node._parameters.items() if name.startswith("qos_overrides")}
    policies = profile.history.name, profile.depth, profile.reliability.name, profile.durability.name
    return policies, sorted(declared.items())


for _kind in ("publisher", "subscription"):
    for _name, (_options, _overrides) in OVERRIDES.items():
        lines(
            f"overrides.{_kind}",
            **{
                _name: lambda kind=_kind, options=_options, overrides=_overrides: _overridden(
                    kind, options, overrides
                )
            },
        )

if __name__ == "__main__":
    main()
