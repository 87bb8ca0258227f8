"""Loops that only look, like `while not node.done: pass`: robot time passes in them.

They call nothing of the kit, so nothing else could happen meanwhile. Programs, their modules and cells are
compiled with a call in each of them.
"""

import ast
from importlib.machinery import SourceFileLoader
from itertools import count
from typing import Any

from course_lib.ros.baton import POLL_STEP_NS, POLLS_BEFORE_TIME_PASSES, POLLS_PER_STEP, baton
from course_lib.ros.cells import cell
from course_lib.ros.tracebacks import is_own

_CALL = f"__import__({__name__!r}, fromlist=['look']).look()"
_rounds_in_cells = count(1)
_real_get_code = SourceFileLoader.get_code


class IdleLoops(ast.NodeTransformer):
    """Puts the call into a tree's loops, also as one of IPython's `ast_transformers`."""

    def visit(self, node: ast.AST) -> Any:
        """Extend the loops of a tree that change nothing themselves."""
        for loop in ast.walk(node):  # which does not recurse: some people's sums have thousands of terms
            if isinstance(loop, ast.While) and _only_looks(loop):
                (call,) = ast.parse(_CALL).body
                for part in ast.walk(call):
                    ast.copy_location(part, loop)
                loop.body.insert(0, call)
        return node


def _only_looks(loop: ast.While) -> bool:
    """Return whether a loop waits for what others change."""
    return _is_idle(loop.body) and _may_end(loop) and not _pauses(loop.test)


def _is_idle(statements: list[ast.stmt]) -> bool:
    """Return whether statements do nothing but leave the loop."""
    return all(
        isinstance(one, (ast.Pass, ast.Continue, ast.Break))
        or (isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant))
        or (isinstance(one, ast.If) and _is_idle(one.body) and _is_idle(one.orelse))
        for one in statements
    )


def _may_end(loop: ast.While) -> bool:
    """Return whether something can end a loop; `while True: pass` hangs in ROS as well, and is named."""
    is_endless = isinstance(loop.test, ast.Constant) and loop.test.value
    return not is_endless or any(isinstance(part, ast.Break) for part in ast.walk(loop))


def _pauses(test: ast.expr) -> bool:
    """Return whether a condition lets other code run meanwhile."""
    return any(isinstance(part, (ast.Await, ast.Yield, ast.YieldFrom)) for part in ast.walk(test))


def look() -> None:
    """Note a round of such a loop; after many rounds robot time passes."""
    if baton.governs():
        baton.poll()
    elif cell.runs_here():
        rounds = next(_rounds_in_cells)
        if rounds >= POLLS_BEFORE_TIME_PASSES and rounds % POLLS_PER_STEP == 0:
            cell.rest(POLL_STEP_NS * 1e-9)


def compiled(source: bytes, file: str) -> Any:
    """Compile a program's text; raises what `compile` raises."""
    return compile(IdleLoops().visit(ast.parse(source, file)), file, "exec", dont_inherit=True)


def install() -> None:
    """Compile the modules that programs import in the same way."""
    setattr(SourceFileLoader, "get_code", _get_code)  # noqa: B010 - mypy knows no patch


def _get_code(loader: SourceFileLoader, name: str) -> Any:
    """Return a module's code; that of the student's own files is not kept in a cache."""
    path = loader.get_filename(name)
    if not is_own(path):
        return _real_get_code(loader, name)
    source = loader.get_data(path)
    return compiled(source, path) if b"while" in source else _real_get_code(loader, name)
