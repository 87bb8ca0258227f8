# mypy: ignore-errors
"""Random sequences of calls: parameters with descriptors and callbacks, transitions that fail, tasks.

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
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future
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


class Tasks:
    """Futures and tasks that complete, cancel and create each other, and what has run in which order."""

    def __init__(self, chance: Any) -> None:
        self.chance, self.received = chance, chance.received
        self.executor = SingleThreadedExecutor()
        self.executor.add_node(Node("n"))
        self.futures = [Future(executor=self.executor), Future(), Future(executor=self.executor)]

    def function(self, name: Any) -> Any:
        kind = self.chance.choice(("ok", "ok", "raise", "stop", "task", "cancel"))

        def call(*arguments: Any, **named: Any) -> Any:
            self.received.append((name, arguments, named))
            if kind in ("raise", "stop"):
                raise ValueError(name) if kind == "raise" else StopIteration(name)
            if kind == "task":
                self.add(lambda: self.received.append((name, "inner")))
            if kind == "cancel":
                self.futures[0].cancel()
            return name

        return call

    def coroutine(self, name: Any) -> Any:
        kind = self.chance.choice(("ok", "ok", "raise", "again", "nested", "stop"))
        awaited = [self.chance.choice(self.futures) for _ in range(self.chance.randint(0, 2))]

        async def call() -> Any:
            self.received.append((name, "begin"))
            for future in awaited:
                try:
                    self.received.append((name, await future))
                except Exception as error:
                    self.received.append((name, repr(error)))
                    if kind == "again":
                        raise
            if kind in ("raise", "stop"):
                raise KeyError(name) if kind == "raise" else StopAsyncIteration(name)
            if kind == "nested":
                self.received.append((name, await self.add(lambda: f"inside {name}")))
            return name

        return call

    def when_done(self, name: Any) -> Any:
        kind = self.chance.choice(("ok", "ok", "raise", "late", "task", "remove"))

        def call(future: Any) -> None:
            self.received.append((name, future.done(), future.cancelled()))
            if kind == "raise":
                raise ValueError(name)
            if kind == "late":
                future.add_done_callback(lambda done: self.received.append((name, "late")))
            if kind == "task":
                self.add(lambda: self.received.append((name, "inner")))
            if kind == "remove":
                self.received.append((name, future.remove_done_callback(call)))

        return call

    def add(self, work: Any, *arguments: Any, **named: Any) -> Any:
        self.futures.append(self.executor.create_task(work, *arguments, **named))
        return self.futures[-1]

    def spin(self) -> Any:
        raised = [outcome(self.executor.spin_once, timeout_sec=0.003) for _ in range(30)]
        return [text for text in raised if text != "None"]

    def change(self, name: Any) -> Any:
        kind = self.chance.choice(
            (
                *("coroutine", "callback", "set", "spin", "until") * 2,
                *("function", "object", "exception", "cancel"),
            )
        )
        future = self.chance.choice(self.futures)
        match kind:
            case "function":
                self.add(self.function(name), *self.chance.choice(((), (1, 2))), k=1)
            case "coroutine":
                self.add(self.coroutine(name))
            case "object":
                self.add(self.coroutine(name)())
            case "callback":
                future.add_done_callback(self.when_done(name))
            case "set":
                self.chance.choice(self.futures[:3]).set_result(name)
            case "exception":
                self.chance.choice(self.futures[:3]).set_exception(ValueError(name))
            case "cancel":
                future.cancel()
            case "spin":
                return self.spin()
            case _:
                self.executor.spin_until_future_complete(future, timeout_sec=0.2)
        return kind


def tasks(seed: Any) -> Any:
    chance = Chance(seed)
    program, found = Tasks(chance), []
    for step in range(chance.randint(5, 18)):
        chance.received.append(outcome(program.change, f"step {step}"))
    found += [program.spin(), *(outcome(future.result) for future in program.futures)]
    return chance.received, found, [(one.done(), one.cancelled()) for one in program.futures]


lines("parameters", **{str(seed): lambda seed=seed: parameters(seed) for seed in range(80)})
lines("transitions", **{str(seed): lambda seed=seed: transitions(seed) for seed in range(40)})
lines("tasks", **{str(seed): lambda seed=seed: tasks(seed) for seed in range(80)})

if __name__ == "__main__":
    main()
