# mypy: ignore-errors
"""Random sequences of calls: parameters with descriptors and callbacks, and transitions that fail.

The seed is the name of a probe. Both worlds draw the same numbers, until an outcome differs.
"""

import random
from typing import Any

from probing import lines, main, outcome
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterValue,
    SetParametersResult,
)
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String

NAN, INFINITY = float("nan"), float("inf")
NUMBERS = (None, True, False, 0, 1, 5, -3, 10, 2**40, 0.0, 0.5, 1.0, 2.5, NAN, INFINITY)
TEXTS = ("", "a", "text", b"x", [b"a"], ["a", "b"], ["a", 1], {"a": 1})
LISTS = ([True], [1, 2], [0.5], [], [1, 0.5], [None], (1, 2), (0.5,), object)
VALUES = (*NUMBERS, *TEXTS, *LISTS)
NAMES = ("a", "b", "a.b", "a.b.c", "ns.x", "", "a b", "1", "a.", ".a", "qos", "use_sim_time", "a/b", "ä")
CALLS = (
    *("declare",) * 4,
    *("set",) * 3,
    *("declare_two", "undeclare", "set_two", "set_atomically", "get", "get_or", "by_prefix", "describe"),
    *("set_descriptor", "add_callback", "list"),
)


class Chance(random.Random):
    """The random choices of one program of calls, and what its callbacks have received."""

    def __init__(self, seed: Any) -> None:
        super().__init__(seed)
        self.received = []

    def parameter(self, name: Any = None) -> Any:
        name = self.choice(NAMES) if name is None else name
        return Parameter(name, value=self.choice(VALUES))

    def descriptor(self) -> Any:
        if self.random() < 0.5:
            return ParameterDescriptor()
        descriptor = ParameterDescriptor(
            name=self.choice(("", "other")),
            description=self.choice(("", "text")),
            read_only=self.random() < 0.2,
            dynamic_typing=self.random() < 0.3,
            type=self.choice((0, 0, 1, 2, 3, 4, 6, 9, 77)),
        )
        if self.random() < 0.3:
            first, last, step = (self.choice(n) for n in ((-5, 0, 3), (5, 10, -10), (0, 1, 2, 3, 20)))
            descriptor.integer_range = [IntegerRange(from_value=first, to_value=last, step=step)]
        if self.random() < 0.3:
            first, last, step = (self.choice(n) for n in ((-0.5, 0.0, 1.0), (1.0, 2.5), (0.0, 0.5, 0.3)))
            descriptor.floating_point_range = [FloatingPointRange(from_value=first, to_value=last, step=step)]
        return descriptor

    def callback(self, kind: Any) -> Any:
        """Return a callback of one kind, which sometimes replaces or rejects parameters."""

        def receive(parameters: Any) -> Any:
            self.received.append((kind, [(one.name, str(one.value)) for one in parameters]))
            if kind == "pre_set":
                replaced = ([], [*parameters, Parameter("b", value=1)])
                return parameters if self.random() < 0.7 else self.choice(replaced)
            if kind == "on_set":
                return SetParametersResult(successful=self.random() < 0.7, reason="why")
            return None

        return receive


def _call(node: Any, chance: Any) -> Any:
    """Return the result of one random call."""
    kind, name = chance.choice(CALLS), chance.choice(NAMES)
    match kind:
        case "declare":
            value, descriptor = chance.choice(VALUES), chance.descriptor()
            return node.declare_parameter(
                name, value, descriptor, ignore_override=chance.random() < 0.2
            ).value
        case "declare_two":
            first, second = (name, chance.choice(VALUES)), (chance.choice(NAMES), 1, chance.descriptor())
            prefix = chance.choice(("", "ns", "ns."))
            return [(one.name, one.value) for one in node.declare_parameters(prefix, [first, second])]
        case "undeclare":
            return node.undeclare_parameter(name)
        case "set":
            return node.set_parameters([chance.parameter(name)])
        case "set_two":
            return node.set_parameters([chance.parameter(name), chance.parameter()])
        case "set_atomically":
            return node.set_parameters_atomically([chance.parameter(name), chance.parameter()])
        case "get":
            return node.get_parameter(name).value
        case "get_or":
            return node.get_parameter_or(name, chance.choice((None, Parameter("q", value=3)))).value
        case "by_prefix":
            found = node.get_parameters_by_prefix(chance.choice(("", "a", "ns", "a.")))
            return {key: one.value for key, one in sorted(found.items()) if "start_type" not in key}
        case "describe":
            return node.describe_parameter(name)
        case "set_descriptor":
            alternative = chance.choice((None, ParameterValue(type=2, integer_value=3)))
            return node.set_descriptor(name, chance.descriptor(), alternative)
        case "add_callback":
            kind = chance.choice(("pre_set", "on_set", "post_set"))
            getattr(node, f"add_{kind}_parameters_callback")(chance.callback(kind))
            return kind
        case _:
            prefixes = chance.choice((["a"], ["ns"], [""], []))
            known = outcome(node.has_parameter, name), outcome(node.get_parameter_type, name)
            return *known, node.list_parameters(prefixes, chance.choice((0, 1, 2)))


def parameters(seed: Any) -> Any:
    chance = Chance(seed)
    overrides = [Parameter(chance.choice(NAMES[:5]), value=chance.choice((1, 0.5, "x", [1], True)))]
    node = Node(
        "n",
        allow_undeclared_parameters=chance.random() < 0.4,
        automatically_declare_parameters_from_overrides=chance.random() < 0.3,
        parameter_overrides=overrides if chance.random() < 0.5 else None,
    )
    return [outcome(_call, node, chance) for _ in range(25)], chance.received


class Unreliable(LifecycleNode):
    """A node whose transitions fail in every way."""

    def __init__(self, chance: Any) -> None:
        super().__init__("n")
        self.chance = chance

    def _change(self, state: Any) -> Any:
        self.chance.received.append(state.label)
        results = TransitionCallbackReturn
        drawn = self.chance.choice((*[results.SUCCESS] * 5, results.FAILURE, results.ERROR, None, 0))
        if drawn == 0:
            raise ValueError("text")
        return drawn

    on_configure = on_activate = on_deactivate = on_cleanup = on_shutdown = on_error = _change


def transitions(seed: Any) -> Any:
    chance, found = Chance(seed), []
    node = Unreliable(chance)
    publisher = node.create_lifecycle_publisher(String, "t", 1)
    for _ in range(12):
        name = chance.choice(("configure", "activate", "activate", "deactivate", "cleanup", "shutdown"))
        found.append((name, outcome(getattr(node, f"trigger_{name}")), publisher.is_activated))
    return found, chance.received


lines("parameters", **{str(seed): lambda seed=seed: parameters(seed) for seed in range(80)})
lines("transitions", **{str(seed): lambda seed=seed: transitions(seed) for seed in range(40)})

if __name__ == "__main__":
    main()
