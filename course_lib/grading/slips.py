"""Slips in a student's code that raise no error, such as `==` for `=`, found in its syntax tree.

Each is almost never what a student means. They are only looked for after a failed check, because a
slip is not a mistake where the result is right.
"""

import ast
import re
import textwrap
from collections.abc import Iterator, Sequence
from itertools import pairwise

# Methods of lists, dictionaries and sets that change them and return None.
IN_PLACE = {"append", "extend", "insert", "remove", "reverse", "sort", "clear", "update", "add", "discard"}
_SENDING = ("publish", "sendTransform")
_LONGEST = 60  # characters of a quoted line
_FIELD = re.compile(r"\{[a-z_]\w*(\.\w+|\[\w+\])*(:[^{}]*)?\}")
_Function = ast.FunctionDef | ast.AsyncFunctionDef


def parse(source: str) -> ast.AST:
    """Parse code that may be indented; return an empty tree if it is not valid Python."""
    try:
        return ast.parse(textwrap.dedent(source).rstrip(":"))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ast.Module(body=[], type_ignores=[])


def find_slip(source: str) -> str:
    """Return a sentence about the first slip in the code, or ""."""
    tree = parse(source)
    for outer in ast.walk(tree):
        own = _attributes_of_self(outer) if isinstance(outer, ast.ClassDef) else set()
        functions = outer.body if isinstance(outer, ast.ClassDef | ast.Module) else []
        for function in functions:
            if isinstance(function, _Function):
                for slip in _slips(function, own):
                    return slip
    return ""


def _slips(function: _Function, own: set[str]) -> Iterator[str]:
    for block in _blocks(function):
        yield from _idle_statements(block)
        yield from _recreations(block)
        yield from _late_assignments(block)
        yield from _loops(block, function.name)
        yield from _unreachable(block)
    yield from _lost_locals(function, own)
    yield from _plain_strings(function)


def _blocks(function: _Function) -> Iterator[Sequence[ast.stmt]]:
    """Yield each list of statements in a function, without nested functions."""
    waiting: list[Sequence[ast.stmt]] = [function.body]
    while waiting:
        block = waiting.pop(0)
        yield block
        for statement in block:
            if not isinstance(statement, _Function | ast.ClassDef):
                inner = [getattr(statement, name, []) for name in ("body", "orelse", "finalbody")]
                handlers = [one.body for one in getattr(statement, "handlers", [])]
                waiting += filter(None, [*inner, *handlers])


def _quote(node: ast.AST) -> str:
    text = ast.unparse(node).splitlines()[0]
    return f'"{text}"' if len(text) <= _LONGEST else f'"{text[: _LONGEST - 1]}…"'


def _idle_statements(block: Sequence[ast.stmt]) -> Iterator[str]:
    for statement in block:
        match statement:
            case ast.Expr(value=ast.Compare(ops=[ast.Eq()])):
                yield f"{_quote(statement)} compares and changes nothing: a single = sets a value."
            case ast.Expr(value=ast.Attribute() as named):
                yield f"{_quote(statement)} names {named.attr} and does not call it: write ( ) after it."
            case ast.Assign(value=ast.UnaryOp(op=ast.UAdd())):
                name = ast.unparse(statement.targets[0])
                yield f"=+ sets {name} to the value on the right; += adds it to {name}."
            case ast.Assign(
                targets=[ast.Name(id=name)],
                value=ast.Call(func=ast.Attribute(value=ast.Name(id=other), attr=method)),
            ) if name == other and method in IN_PLACE:
                yield f"{method}() changes {name} and returns None: leave out {name} = before it."


def _find_created(statement: ast.stmt) -> tuple[str, str]:
    """Return the name and the class of an object that a statement creates, or ("", "")."""
    match statement:
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=ast.Name(id=kind))) if kind[
            0
        ].isupper():
            return name, kind
    return "", ""


def _sets_field(statement: ast.stmt, name: str) -> bool:
    return isinstance(statement, ast.Assign | ast.AugAssign) and any(
        _root(target) == name
        for target in (statement.targets if isinstance(statement, ast.Assign) else [statement.target])
    )


def _root(node: ast.AST) -> str:
    """Return the variable whose attribute or item an expression is, or "" for a plain variable."""
    is_inside = False
    while isinstance(node, ast.Attribute | ast.Subscript):
        node, is_inside = node.value, True
    return node.id if is_inside and isinstance(node, ast.Name) else ""


def _uses(node: ast.AST, name: str) -> bool:
    return any(isinstance(one, ast.Name) and one.id == name for one in ast.walk(node))


def _recreations(block: Sequence[ast.stmt]) -> Iterator[str]:
    # Whether a field of each object is set, and it was not used for anything else yet.
    is_filled: dict[str, bool] = {}
    for statement in block:
        name, kind = _find_created(statement)
        if name:
            if is_filled.get(name):
                yield f"{_quote(statement)} creates a second {kind}: what was set before is in the first."
            is_filled[name] = False
            continue
        for known in list(is_filled):
            if _sets_field(statement, known):
                is_filled[known] = True
            elif _uses(statement, known):
                del is_filled[known]


def _find_published(statement: ast.AST) -> str:
    """Return the variable that a statement publishes, or ""."""
    match statement:
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr=method), args=[ast.Name(id=name)])) if (
            method in _SENDING
        ):
            return name
    return ""


def _late_assignments(block: Sequence[ast.stmt]) -> Iterator[str]:
    for index, statement in enumerate(block):
        name = _find_published(statement)
        created = any(_find_created(one)[0] == name for one in block[:index])
        later = []
        for after in block[index + 1 :]:
            if _find_created(after)[0] == name:
                break
            if _sets_field(after, name):
                later.append(after)
        again = any(_find_published(one) == name for one in block[index + 1 :])
        if name and created and later and not again:
            yield (
                f"{_quote(later[0])} comes after {_quote(statement)}: a message is sent as it is at that "
                "moment. Set everything before."
            )


def _loops(block: Sequence[ast.stmt], function: str) -> Iterator[str]:
    for index, loop in enumerate(block):
        if not isinstance(loop, ast.For):
            continue
        if isinstance(loop.body[-1], ast.Return):
            yield f"return ends the loop of {function} after its first item: move it out of the loop."
        before = {name.id for one in block[:index] for name in ast.walk(one) if isinstance(name, ast.Name)}
        inside = {_find_created(one)[0] for one in loop.body} - before - {""}
        for later in block[index + 1 :]:
            match later:
                case ast.Expr(value=ast.Call(func=ast.Attribute(attr=method), args=[ast.Name(id=name)])) if (
                    name in inside and method in (*_SENDING, "append")
                ):
                    yield (
                        f"{_quote(later)} is after the loop and gets only the last {name}: move it into the "
                        "loop."
                    )
        emptied = [
            one.targets[0].id
            for one in loop.body
            if isinstance(one, ast.Assign)
            and isinstance(one.targets[0], ast.Name)
            and isinstance(one.value, ast.List)
            and not one.value.elts
        ]
        for name in emptied:
            if any(_uses(one, name) for one in block[index + 1 :]):
                yield f'"{name} = []" in the loop empties the list for each item: move it before the loop.'


def _unreachable(block: Sequence[ast.stmt]) -> Iterator[str]:
    for statement, after in pairwise(block):
        if isinstance(statement, ast.Return):
            yield f"{_quote(after)} comes after {_quote(statement)} and never runs."


def _attributes_of_self(cls: ast.ClassDef) -> set[str]:
    return {
        node.attr
        for node in ast.walk(cls)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self"
    }


def _lost_locals(function: _Function, own: set[str]) -> Iterator[str]:
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
    read = {node.id for node in names if isinstance(node.ctx, ast.Load)}
    for node in names:
        if isinstance(node.ctx, ast.Store) and node.id in own - read:
            yield (
                f"{node.id} = … in {function.name} sets a variable that ends with the method. To keep it, "
                f"write self.{node.id} = …"
            )


def _plain_strings(function: _Function) -> Iterator[str]:
    formatted = {
        id(node.func.value)
        for node in ast.walk(function)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
    }
    inside = {
        id(part) for node in ast.walk(function) if isinstance(node, ast.JoinedStr) for part in node.values
    }
    for node in ast.walk(function):
        if (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and id(node) not in formatted | inside
            and "\n" not in node.value
            and _FIELD.search(node.value)
        ):
            yield f"the string {node.value[:_LONGEST]!r} has names in {{ }}: write f before its quotes."
