"""Reading of JSON and Python written by others: students, browsers or programs.

Files may be incomplete.
"""

import ast
import json
from bisect import bisect_left
from typing import Any

TOO_DEEP = "it is nested too deeply for Python: split the expression"


def read_json(text: str | bytes) -> Any:
    """Return the value of a JSON string.

    Raises:
        ValueError: The text is not JSON, or is nested more deeply than Python can read.
    """
    try:
        return json.loads(text)
    except RecursionError as error:
        raise ValueError("it is nested too deeply") from error


def compile_python(source: str | bytes, file: str = "<unknown>", flags: int = 0) -> Any:
    """Compile a program.

    Raises:
        ValueError: The program contains a null byte.
        SyntaxError: The program is not Python, or is nested more deeply than Python can compile.
            Python itself would raise a MemoryError or RecursionError.
    """
    try:
        return compile(source, file, "exec", flags, dont_inherit=True)
    except (MemoryError, RecursionError) as error:
        raise SyntaxError(TOO_DEEP, (file, _first_deep_line(source, flags), None, None)) from error


def parse_python(source: str | bytes, file: str = "<unknown>") -> ast.Module:
    """Return the syntax tree of a program. Raises the same errors as `compile_python`."""
    tree: ast.Module = compile_python(source, file, ast.PyCF_ONLY_AST)
    return tree


def _first_deep_line(source: str | bytes, flags: int) -> int:
    """Return the number of the first line at which a program is nested too deeply."""
    lines = source.splitlines(keepends=True)

    def is_too_deep(count: int) -> bool:
        try:
            compile(type(source)().join(lines[:count]), "", "exec", flags, dont_inherit=True)  # type: ignore[arg-type]
        except (MemoryError, RecursionError):
            return True
        except (SyntaxError, ValueError):
            return False
        return False

    return bisect_left(range(len(lines)), True, key=is_too_deep)
