"""The student's side of a scenario: what is run, in the kernel and in the grader's worker alike."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.grading.plain import plain
from course_lib.grading.student_error import describe
from course_lib.ros import standin_path, virtual_time
from course_lib.ros.baton import baton
from course_lib.ros.graph import Graph, use_graph
from course_lib.ros.seeding import seeded

MAX_ERRORS = 20
NOTHING_RETURNED = {"object": "nothing, because the call did not end"}  # unlike None, equal to no answer


@dataclass(frozen=True)
class Part:
    """What the student's side gets to know: the task's kind, the seed, the arguments of calls."""

    kind: str
    seed: int
    calls: Sequence[tuple[Sequence[Any], dict[str, Any]]] = ()


@dataclass
class Outcome:
    """What came back: plain data."""

    returns: list[Any] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)


def perform(part: Part, subject: Any, graph: Graph, outcome: Outcome) -> None:
    """Run the student's object on a graph; whatever it returns or raises goes into `outcome`.

    Raises:
        KeyboardInterrupt: The run was interrupted before its end.
    """
    standin_path.install()
    virtual_time.install()
    with baton.known(), use_graph(graph), seeded(part.seed):
        for action in _actions(part, subject, outcome):
            try:
                action()
            except KeyboardInterrupt:
                if not graph.ended:
                    raise
            except BaseException as error:  # the student's code may raise anything, SystemExit too
                outcome.errors = [*outcome.errors, describe(error)][:MAX_ERRORS]
        baton.let_others_finish()


def _actions(part: Part, subject: Any, outcome: Outcome) -> list[Callable[[], None]]:
    if part.kind == "node":
        return [lambda: run_node(subject)]
    if part.kind == "file":
        return [lambda: outcome.returns.append(plain(Path(subject).read_text(encoding="utf-8")))]
    if part.kind != "function":
        return [lambda: outcome.returns.append(plain(subject))]

    def call(args: Sequence[Any], kwargs: dict[str, Any]) -> None:
        outcome.returns.append(NOTHING_RETURNED)  # so that a call that raises keeps its place
        outcome.returns[-1] = plain(_callable(subject, "a function")(*args, **kwargs))

    return [lambda a=args, k=kwargs: call(a, k) for args, kwargs in part.calls]  # type: ignore[misc]


def run_node(make: Any) -> None:
    """Make the node, or the nodes, and spin them; a function that returns None has run itself."""
    import rclpy
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.node import Node
    from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

    made = _callable(make, "a node class")
    if not _initialises(make):
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        made = made()
        nodes = [made] if isinstance(made, Node) else list(made or ())
        if nodes:
            executor = SingleThreadedExecutor()
            for node in nodes:
                executor.add_node(node)
            executor.spin()
    except ExternalShutdownException:
        pass  # the student's code called rclpy.shutdown(): an end like any other
    finally:
        uninstall_signal_handlers()


def _initialises(make: Any) -> bool:
    """Whether a function calls `rclpy.init()` itself, as every `main()` does."""
    code = getattr(make, "__code__", None)
    return code is not None and "init" in code.co_names


def _callable(subject: Any, expected: str) -> Callable[..., Any]:
    if not callable(subject):
        name = type(subject).__name__
        instead = "" if type(subject).__module__ == "builtins" else f": give {name} itself, without ()"
        raise CourseError(f"got an object of {name}, expected {expected}{instead}")
    made: Callable[..., Any] = subject
    return made
