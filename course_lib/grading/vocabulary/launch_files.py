"""Checks on the text of a launch file, which is parsed and never run."""

import ast
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.wording import Problem, close, word

LONGEST = 10_000  # characters
FUNCTION = "generate_launch_description"
Names = Mapping[str, ast.expr]  # what is assigned to each variable


@word("the launch file declares {argument}")
def expect_launch_argument(
    evidence: Evidence, argument: str, *, default: str, call: int = 0
) -> Iterable[Problem]:
    """Expect an argument of the launch file with this default."""
    tree, names = _parsed(evidence, call)
    for action in _listed(tree, names, "DeclareLaunchArgument"):
        given = _keywords(action, names)
        first = _plain(action.args[0], names) if action.args else given.get("name")
        if first == argument:
            value = given.get("default_value")
            if value == default:
                return []
            return [
                Problem(f"the default of {argument} is {value!r}, expected {default!r}", "a default is wrong")
            ]
    missing = "an argument of the launch file is missing"
    return [Problem(f"the list of the launch file declares no argument {argument!r}", missing)]


@word("the launch file starts {executable}")
def expect_launch_node(
    evidence: Evidence,
    package: str,
    executable: str,
    *,
    name: str | None = None,
    options: Mapping[str, Any] | None = None,
    call: int = 0,
) -> Iterable[Problem]:
    """Expect a Node action in the list that is returned.

    Args:
        evidence: Its `call`-th returned value is the text of the launch file.
        package: Of the executable.
        executable: Its name.
        name: The new name of its node.
        options: Words of `arguments` with the value behind each; "$(layout)" is a launch configuration.
        call: Number of the call that returned the text.
    """
    tree, names = _parsed(evidence, call)
    nodes = [_keywords(action, names) for action in _listed(tree, names, "Node")]
    for node in nodes:
        if (node.get("package"), node.get("executable")) == (package, executable):
            return [*_misnamed(node, executable, name), *_misfits(node, executable, options or {})]
    others = ", ".join(f"{node.get('executable')} of {node.get('package')}" for node in nodes) or "nothing"
    text = f"the list of the launch file starts {others}, expected {executable} of {package}"
    return [Problem(text, "a node is missing in the launch file")]


def _misnamed(node: Mapping[str, Any], executable: str, name: str | None) -> Iterator[Problem]:
    if name is not None and node.get("name") != name:
        text = f"the name of {executable} is {node.get('name')!r}, expected {name!r}"
        yield Problem(text, "a node in the launch file has another name")


def _misfits(node: Mapping[str, Any], executable: str, options: Mapping[str, Any]) -> Iterator[Problem]:
    words = node.get("arguments")
    words = words if isinstance(words, list) else []
    pairs = dict(zip(words[::2], words[1::2], strict=False)) if all(isinstance(w, str) for w in words) else {}
    for option, expected in options.items():
        value = pairs.get(option)
        if not (value == expected or (isinstance(expected, float) and _equal(value, expected))):
            text = f"the word behind {option!r} of {executable} is {value!r}, expected {str(expected)!r}"
            yield Problem(text, "the arguments of a node in the launch file are wrong")


def _equal(value: Any, expected: float) -> bool:
    try:
        return close(float(value), expected, 1e-6)
    except (TypeError, ValueError):
        return False


def _parsed(evidence: Evidence, call: int) -> tuple[ast.Module, Names]:
    """Return the file's syntax tree, and what it assigns to names; raise a Problem if there is none."""
    text = evidence.returns[call] if call < len(evidence.returns) else None
    if not isinstance(text, str) or not text.strip() or len(text) > LONGEST:
        raise Problem("no text of a launch file came back", "there is no launch file")
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise Problem(f"Python says of the launch file: {error}", "the launch file is not Python") from None
    functions = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef) and n.name == FUNCTION]
    if not any(isinstance(n, ast.Return) and n.value for f in functions for n in ast.walk(f)):
        text = f"the launch file has no function {FUNCTION} that returns something"
        raise Problem(text, "the launch file describes nothing")
    assigned = [n for n in ast.walk(tree) if isinstance(n, ast.Assign) and isinstance(n.targets[0], ast.Name)]
    return tree, {n.targets[0].id: n.value for n in assigned if isinstance(n.targets[0], ast.Name)}


def _listed(tree: ast.Module, names: Names, action: str) -> Iterator[ast.Call]:
    """Yield the calls of an action's class that reach a LaunchDescription."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and _called(node) in ("LaunchDescription", "add_action"):
            for part in (*node.args, *(keyword.value for keyword in node.keywords)):
                yield from (call for call in _calls(part, names) if _called(call) == action)


def _calls(node: ast.expr, names: Names) -> Iterator[ast.Call]:
    """Yield the calls in an expression of lists and variables; each part is visited once, so bombs end."""
    waiting, seen = [node], set[int]()
    while waiting:
        part = waiting.pop(0)
        if id(part) in seen:
            continue
        seen.add(id(part))
        match part:
            case ast.Call():
                yield part
            case ast.Name(id=name) if name in names:
                waiting.append(names[name])
            case ast.List(elts=parts) | ast.Tuple(elts=parts):
                waiting += parts
            case ast.Starred(value=value):
                waiting.append(value)
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                waiting += [left, right]


def _called(call: ast.Call) -> str:
    """Return the last part of the name that is called."""
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")


def _keywords(call: ast.Call, names: Names) -> dict[str, Any]:
    return {keyword.arg: _plain(keyword.value, names) for keyword in call.keywords if keyword.arg}


def _plain(node: ast.expr, names: Names) -> Any:
    """Return the value of a literal or of a variable that holds one; "$(name)" for a launch configuration."""
    match node:
        case ast.Constant(value=value):
            return value
        case ast.Name(id=name) if name in names:
            return _plain(names[name], {})
        case ast.List(elts=parts) | ast.Tuple(elts=parts):
            return [_plain(part, names) for part in parts]
        case ast.Call(args=[first, *_]) if _called(node) == "LaunchConfiguration":
            return f"$({_plain(first, names)})"
        case ast.Call(args=[first]) if _called(node) == "str":
            return str(_plain(first, names))
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() | float() as value)):
            return -value
    return None
