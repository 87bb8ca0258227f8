"""A notebook's code cell as Python: the names that it binds, what it checks, whether it is still a stub."""

import ast
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from course_lib.course.checked import cell_digest
from course_lib.export.cells import without_magics

MAX_HEAD = 40  # characters of a cell's first line


@dataclass(frozen=True)
class CodeCell:
    """A code cell: its number among the code cells, its source, whether it was run in the saved notebook."""

    number: int
    source: str
    ran: bool

    @property
    def name(self) -> str:
        """How messages name it."""
        head = next((line.strip() for line in self.source.splitlines() if line.strip()), "")
        return f"code cell {self.number} ({head[:MAX_HEAD]}{'…' * (len(head) > MAX_HEAD)})"

    @property
    def digest(self) -> str:
        """Of its source."""
        return cell_digest(self.source)

    @cached_property
    def tree(self) -> ast.Module:
        """Its Python; empty where it cannot be parsed."""
        try:
            return ast.parse(without_magics(self.source))
        except (SyntaxError, ValueError):
            return ast.Module([], [])

    @cached_property
    def syntax_error(self) -> str:
        """Return what is wrong with its Python, or ""."""
        try:
            compile(without_magics(self.source), "cell", "exec", ast.PyCF_ALLOW_TOP_LEVEL_AWAIT, True)
        except (SyntaxError, ValueError) as error:
            line = f", line {error.lineno}" if isinstance(error, SyntaxError) and error.lineno else ""
            return f"{self.name}{line}: {getattr(error, 'msg', error)}"
        return ""

    @cached_property
    def gives(self) -> frozenset[str]:
        """The names that it binds, not counting those inside functions and classes."""
        return frozenset(_bound(self.tree))

    @cached_property
    def checks(self) -> Mapping[str, ast.expr]:
        """What it gives to `check`, by task."""
        calls = (node for node in ast.walk(self.tree) if isinstance(node, ast.Call) and len(node.args) > 1)
        return {
            str(call.args[0].value): call.args[1]
            for call in calls
            if getattr(call.func, "id", "") == "check" and isinstance(call.args[0], ast.Constant)
        }

    @cached_property
    def is_stub(self) -> bool:
        """Whether it still raises NotImplementedError somewhere."""
        raised = (node.exc for node in ast.walk(self.tree) if isinstance(node, ast.Raise) and node.exc)
        return any(ast.unparse(one).startswith("NotImplementedError") for one in raised)


def _bound(tree: ast.AST) -> Iterator[str]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.alias):
            yield (node.asname or node.name).partition(".")[0]
        else:
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                yield node.id
            yield from _bound(node)
