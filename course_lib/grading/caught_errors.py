"""Errors that a student's own code catches and hides, as in `except Exception: pass`."""

import ast
import linecache
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from types import FrameType
from typing import Any, Self

from course_lib.grading.run.outcome import describe
from course_lib.grading.slips import parse
from course_lib.ros.graph.graph import START_NS, current_graph
from course_lib.ros.student_code import is_student_file

# Catching these classes catches mistakes in the code as well.
_ALL_ERRORS = {"Exception", "BaseException"}
# Errors that are mistakes in the code. Others may be expected: a lookup of a transform that has not
# arrived, or math.acos of a number above 1.
_MISTAKES = (NameError, AttributeError, TypeError, ImportError, AssertionError)


@dataclass(frozen=True)
class Handler:
    """A handler of errors: an `except` clause or a call of `suppress`.

    Args:
        head: Its first line.
        kinds: The names of the classes that it catches, without their modules.
        is_silent: Whether it does not raise the error again.
    """

    head: str
    kinds: frozenset[str]
    is_silent: bool = True


class CaughtErrors:
    """The errors that a student's handlers hide while the `with` block runs.

    `mistake` names the first mistake in the code that a handler of every error hides, and `other`
    the last one of all other errors, if it is in the second half of a scenario: at the beginning
    the transforms have not arrived yet. Both are "" if there is none.

    Python's trace function reports each error where it is raised, before a handler sees it. Tracing
    takes time, so only code with a handler is traced.

    Args:
        source: The student's code.
    """

    def __init__(self, source: str) -> None:
        self._has_handler = any(
            handler.is_silent for node in ast.walk(parse(source)) for handler in _handlers(node)
        )
        self._before: Any = None
        self.mistake = ""
        self.other = ""

    def __enter__(self) -> Self:
        if self._has_handler:
            self._before = sys.gettrace()
            sys.settrace(self._trace_calls)
        return self

    def __exit__(self, *_: object) -> None:
        if self._has_handler:
            sys.settrace(self._before)

    def _trace_calls(self, frame: FrameType, event: str, _: Any) -> Any:
        if event != "call" or self.mistake or not is_student_file(frame.f_code.co_filename):
            return None
        frame.f_trace_lines = False
        return self._trace_errors

    def _trace_errors(self, frame: FrameType, event: str, raised: Any) -> Any:
        if event == "exception" and not self.mistake:
            _, error, trace = raised
            handler = _handler_of(frame.f_code.co_filename, frame.f_lineno, error)
            if handler is not None:
                # An error gets its traceback only when a handler catches it.
                before, error.__traceback__ = error.__traceback__, trace
                text = f'"{handler.head}" hides this error: {describe(error)}'
                error.__traceback__ = before
                if handler.kinds & _ALL_ERRORS and isinstance(error, _MISTAKES):
                    self.mistake = text
                else:
                    graph = current_graph()
                    # More than half of the scenario is over, or no scenario runs.
                    if graph.end_ns is None or 2 * graph.now_ns > START_NS + graph.end_ns:
                        self.other = text
        return self._trace_errors


def _handlers(node: ast.AST) -> Iterator[Handler]:
    """Yield the handlers of a statement for its own body."""
    match node:
        case ast.Try(handlers=handlers) | ast.TryStar(handlers=handlers):
            for handler in handlers:
                inner = [part for statement in handler.body for part in ast.walk(statement)]
                is_silent = not any(isinstance(part, ast.Raise) for part in inner)
                yield Handler(ast.unparse(handler).splitlines()[0], _names_of(handler.type), is_silent)
        case ast.With(items=[ast.withitem(context_expr=ast.Call(func=called, args=kinds) as call)]) if (
            ast.unparse(called).endswith("suppress")
        ):
            yield Handler(f"with {ast.unparse(call)}:", _names_of(ast.Tuple(kinds)))


def _names_of(kind: ast.expr | None) -> frozenset[str]:
    kinds = kind.elts if isinstance(kind, ast.Tuple) else [kind]
    return frozenset("BaseException" if kind is None else ast.unparse(kind).split(".")[-1] for kind in kinds)


def _handler_of(filename: str, line: int, error: BaseException) -> Handler | None:
    """Return the handler that catches an error raised on a line, or None without one."""
    kinds = {kind.__name__ for kind in type(error).__mro__}
    for handlers in _handlers_by_line("".join(linecache.getlines(filename))).get(line, ()):
        first = next((handler for handler in handlers if handler.kinds & kinds), None)
        if first is not None and first.is_silent:
            return first
    return None


@lru_cache(maxsize=50)
def _handlers_by_line(text: str) -> dict[int, list[list[Handler]]]:
    """Return the handlers of each statement around a line of a program, the innermost statement first."""
    found: dict[int, list[list[Handler]]] = {}
    # ast.walk visits outer statements first.
    for node in ast.walk(parse(text)):
        if handlers := list(_handlers(node)):
            body: list[ast.stmt] = getattr(node, "body", [])
            for line in range(body[0].lineno, (body[-1].end_lineno or 0) + 1):
                found[line] = [handlers, *found.get(line, [])]
    return found
