"""The source of a student's class or function, and of the student's other definitions that it uses.

`inspect.getsource` finds no class of a notebook, because the module of the cells has no file. The
methods of the class know their cell, though, and the cell contains the class.
"""

import ast
import functools
import linecache
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, lru_cache
from types import FunctionType, MethodType, ModuleType
from typing import Any

from course_lib.course.exercise import code_cells, read_notebook
from course_lib.course.exercise import source as text_of
from course_lib.course.material import exercises_dir
from course_lib.errors import CourseError
from course_lib.export.module import without_magics
from course_lib.ros.student_code import is_student_file

# Limit on the definitions of one answer.
MOST_DEFINITIONS = 50
# The class of functions wrapped by functools.cache or functools.lru_cache.
_CACHE = type(functools.cache(len))
Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
Scope = Mapping[str, Any]
# Returns the source of the definition that a name has in a scope, and its own scope, or None.
Find = Callable[[str, Scope], tuple[str, Scope] | None]


def source_of(subject: Any, week: str) -> str:
    """Return the source of a class or function with the definitions that it uses, or "".

    Args:
        subject: The student's object.
        week: The week of the exercise, whose unchanged definitions are left out.
    """
    found = _source_of_value(subject)
    return _with_helpers(*found, _find_value, week) if found else ""


def is_from_cell(subject: Any, cell: str) -> bool:
    """Return whether a cell may have defined a class or function.

    It has not if it contains a syntax error, or another definition of this name. An object whose
    source is unknown may be from any cell.
    """
    found = _source_of_value(subject)
    if found is None:
        return True
    definitions = dict(_definitions(cell))
    if not definitions:
        try:
            ast.parse(without_magics(cell))
        except (SyntaxError, ValueError):
            return False
        return True
    # A definition in a block, like the body of an if, is not a top-level statement.
    return definitions.get(subject.__name__, found[0]) == found[0]


def source_in_cells(name: str, cells: Sequence[str], week: str) -> str:
    """Return the source of a definition in a notebook with the definitions that it uses, or "".

    Args:
        name: The name of the class or function.
        cells: The sources of the code cells.
        week: The week of the exercise, whose unchanged definitions are left out.
    """
    scope = {key: text for cell in cells for key, text in _definitions(cell)}
    return _with_helpers(scope[name], scope, _find_text, week) if name in scope else ""


def _with_helpers(own: str, scope: Scope, find: Find, week: str) -> str:
    """Return a definition's source, followed by the student's definitions that it uses."""
    sources, waiting = {own: None}, [(own, scope)]
    while waiting and len(sources) < MOST_DEFINITIONS:
        text, scope = waiting.pop(0)
        for name in _used_names(text):
            found = find(name, scope)
            if found and found[0] not in sources:
                sources[found[0]] = None
                waiting.append(found)
    handed_out = _released_definitions(week)
    return "\n\n".join(text for text in sources if text == own or text not in handed_out)


def _find_text(name: str, scope: Scope) -> tuple[str, Scope] | None:
    return (scope[name], scope) if name in scope else None


def _find_value(name: str, scope: Scope) -> tuple[str, Scope] | None:
    first, _, attribute = name.partition(".")
    value = scope.get(first)
    if attribute:
        value = vars(value).get(attribute) if isinstance(value, ModuleType) else None
    return _source_of_value(value)


def _source_of_value(value: Any) -> tuple[str, Scope] | None:
    """Return the source of a student's function or class and the variables that it sees, or None."""
    value = _unwrap(value)
    function = _function_of(value)
    if function is None or not is_student_file(function.__code__.co_filename):
        return None
    text = _find_definition(value.__name__, function, isinstance(value, type))
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    enclosed = {}
    for name, cell in cells:
        # A variable that is set later has no value yet.
        try:
            enclosed[name] = cell.cell_contents
        except ValueError:
            continue
    return (text, {**function.__globals__, **enclosed}) if text else None


def _unwrap(value: Any) -> Any:
    """Return the function inside a partial, a bound method or a decorator's wrapper."""
    # A wrapper may wrap itself.
    for _ in range(MOST_DEFINITIONS):
        if isinstance(value, functools.partial):
            value = value.func
        elif isinstance(value, MethodType | staticmethod | classmethod):
            value = value.__func__
        elif isinstance(value, FunctionType | _CACHE) and "__wrapped__" in vars(value):
            value = vars(value)["__wrapped__"]
        else:
            break
    return value


def _function_of(value: Any) -> FunctionType | None:
    """Return a function, or the first one that the body of a class defines."""
    if isinstance(value, FunctionType):
        return value
    if not isinstance(value, type):
        return None
    for member in vars(value).values():
        function = _unwrap(member.fget if isinstance(member, property) else member)
        # A class may also have functions defined elsewhere as attributes.
        if (
            isinstance(function, FunctionType)
            and function.__qualname__.startswith(f"{value.__qualname__}.")
            and is_student_file(function.__code__.co_filename)
        ):
            return function
    return None


def _find_definition(name: str, function: FunctionType, is_class: bool) -> str:
    """Return the source of a function, or of the class of a method, or ""."""
    code = function.__code__
    text = ""
    for node in ast.walk(_parse("".join(linecache.getlines(code.co_filename)))):
        match node:
            case ast.ClassDef() if is_class and node.name == name:
                is_found = _first_line(node) <= code.co_firstlineno <= (node.end_lineno or 0)
            case ast.FunctionDef() | ast.AsyncFunctionDef() if not is_class and node.name == code.co_name:
                is_found = code.co_firstlineno in (_first_line(node), node.lineno)
            case ast.Assign(targets=[ast.Name(id=stored)], value=ast.Lambda() as value) if not is_class:
                is_found = code.co_name == "<lambda>" and value.lineno == code.co_firstlineno
                if is_found:
                    text = _as_function(stored, value)
                continue
            case _:
                continue
        if is_found:
            text = ast.unparse(node)
    return text


def _first_line(node: Definition) -> int:
    return min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])


def _definitions(cell: str) -> Iterator[tuple[str, str]]:
    """Yield the name and the source of each function and class at the top level of a cell."""
    for node in getattr(_parse(without_magics(cell)), "body", ()):
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
                yield node.name, ast.unparse(node)
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Lambda() as value):
                yield name, _as_function(name, value)


def _as_function(name: str, value: ast.Lambda) -> str:
    """Return a lambda as a function, because hints analyse functions."""
    return f"def {name}({ast.unparse(value.args)}):\n    return {ast.unparse(value.body)}"


@lru_cache(maxsize=MOST_DEFINITIONS)
def _parse(text: str) -> ast.AST:
    try:
        tree = ast.parse(text)
        # A sum of very many terms can be parsed, but not written again.
        ast.unparse(tree)
        return tree
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ast.Module(body=[], type_ignores=[])


def _used_names(text: str) -> Iterator[str]:
    """Yield the names that code reads, with one attribute, as in "helpers.turned"."""
    for node in ast.walk(_parse(text)):
        match node:
            case ast.Name(id=name, ctx=ast.Load()):
                yield name
            case ast.Attribute(value=ast.Name(id=name), attr=attribute) if name != "self":
                yield f"{name}.{attribute}"


@cache
def _released_definitions(week: str) -> frozenset[str]:
    """Return the sources of the definitions in the unchanged exercise."""
    try:
        notebook = read_notebook(exercises_dir() / f"{week}_exercise.ipynb")
    except CourseError:
        return frozenset()
    return frozenset(text for _, cell in code_cells(notebook) for _, text in _definitions(text_of(cell)))
