"""Loops and sleeps with which a program waits for a change that other code makes.

A loop like `while not done: pass` contains no call of the kit, so robot time would stand still and
the loop would never end. A call that counts its rounds is compiled into such loops: after many
rounds it lets robot time advance. In a notebook, sleeps of a cell drive the live nodes.
"""

import ast
import threading
from collections.abc import Callable
from importlib.machinery import SourceFileLoader
from itertools import count
from typing import Any

from course_lib.ros.time import wall
from course_lib.ros.time.time_lock import POLL_STEP_NS, POLLS_BEFORE_TIME_PASSES, POLLS_PER_STEP, time_lock
from course_lib.ros.tracebacks import is_own
from course_lib.third_party import compile_python


class RunningCell:
    """The state of the running cell. `%load_ext course_lib` sets `drive`, which drives nodes."""

    def __init__(self) -> None:
        self.is_running = False
        self.drive: Callable[[float], bool] = lambda seconds: False

    def is_running_in_caller(self) -> bool:
        """Return whether the calling thread runs a cell."""
        return self.is_running and threading.current_thread() is threading.main_thread()

    def sleep(self, seconds: float) -> None:
        """Sleep [s]. Robot time advances if live nodes or threads of cells wait for it."""
        if not (self.is_running_in_caller() and self.drive(seconds)):
            wall.sleep(seconds)


cell = RunningCell()


_CALL = f"__import__({__name__!r}, fromlist=['count_round']).count_round()"
_rounds_in_cells = count(1)
_real_get_code = SourceFileLoader.get_code


class BusyWaitTransformer(ast.NodeTransformer):
    """Inserts the call into the waiting loops of a syntax tree.

    Also used as one of IPython's `ast_transformers`.
    """

    def visit(self, node: ast.AST) -> Any:
        """Insert the call into each loop of the tree that only waits."""
        # ast.walk does not recurse, so expressions may have thousands of terms.
        for loop in ast.walk(node):
            if not isinstance(loop, ast.While) or not _is_idle(loop.body):
                continue
            # `while True: pass` hangs in ROS as well, so it is left alone and reported.
            is_endless = isinstance(loop.test, ast.Constant) and loop.test.value
            may_end = not is_endless or any(isinstance(inner, ast.Break) for inner in ast.walk(loop))
            # A condition that awaits lets other coroutines run.
            yields = any(isinstance(p, (ast.Await, ast.Yield, ast.YieldFrom)) for p in ast.walk(loop.test))
            if may_end and not yields:
                (call,) = ast.parse(_CALL).body
                for inserted in ast.walk(call):
                    ast.copy_location(inserted, loop)
                loop.body.insert(0, call)
        return node


def _is_idle(statements: list[ast.stmt]) -> bool:
    """Return whether statements do nothing except leave the loop."""
    return all(
        isinstance(statement, (ast.Pass, ast.Continue, ast.Break))
        or (isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant))
        or (isinstance(statement, ast.If) and _is_idle(statement.body) and _is_idle(statement.orelse))
        for statement in statements
    )


def count_round() -> None:
    """Count a round of a waiting loop. After many rounds, let robot time advance."""
    if time_lock.is_program_thread():
        time_lock.poll(reads_clock=True)
    elif cell.is_running_in_caller():
        rounds = next(_rounds_in_cells)
        if rounds >= POLLS_BEFORE_TIME_PASSES and rounds % POLLS_PER_STEP == 0:
            cell.sleep(POLL_STEP_NS * 1e-9)


def compile_program(source: bytes, file: str) -> Any:
    """Compile a program's source. Raise the exceptions of `compile`."""
    tree = BusyWaitTransformer().visit(compile_python(source, file, ast.PyCF_ONLY_AST))
    try:
        return compile(tree, file, "exec", dont_inherit=True)
    except RecursionError:
        # Python compiles source that is nested more deeply than a syntax tree may be.
        return compile_python(source, file)


def install() -> None:
    """Compile imported modules of programs in the same way."""

    def get_code(loader: SourceFileLoader, name: str) -> Any:
        """Return a module's code. The code of the student's own modules is not cached."""
        path = loader.get_filename(name)
        source = loader.get_data(path) if is_own(path) else b""
        return compile_program(source, path) if b"while" in source else _real_get_code(loader, name)

    setattr(SourceFileLoader, "get_code", get_code)  # noqa: B010 - mypy rejects an assignment to a method
