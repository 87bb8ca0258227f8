"""Slips in functions that raise no error, such as `==` for `=`, found in the syntax tree of a student's code.

Those with numbers, units and arrays are in `number_slips.py`, those in classes of nodes in
`node_slips.py`.
"""

import ast
import re
import textwrap
from collections.abc import Iterator, Sequence
from itertools import pairwise

from course_lib.ros.syntax_hints import foreign_letter

# Methods of lists, dictionaries and sets that change them and return None.
IN_PLACE = {"append", "extend", "insert", "remove", "reverse", "sort", "clear", "update", "add", "discard"}
# Functions and methods that only return a value.
_PURE = {
    *("sorted", "reversed", "round", "abs", "min", "max", "sum", "clip", "radians", "degrees"),
    *("replace", "strip", "lower", "upper", "format", "split"),
}
# Functions of numpy that change their arguments, or the settings.
_CHANGING = {"copyto", "put", "place", "putmask", "fill_diagonal", "save", "savez", "savetxt"}
_CHANGING |= {"set_printoptions", "seterr"}
_SENDING = ("publish", "sendTransform")
_SIGNS = {ast.UAdd: "+", ast.USub: "-"}
_LONGEST = 60  # limit on the characters of a quoted line
_FIELD = re.compile(r"\{[a-z_]\w*(\.\w+|\[\w+\])*(:[^{}]*)?\}")
Function = ast.FunctionDef | ast.AsyncFunctionDef


def parse(source: str) -> ast.AST:
    """Parse code that may be indented; return an empty tree if it is not valid Python."""
    try:
        return ast.parse(textwrap.dedent(source).rstrip(":"))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ast.Module(body=[], type_ignores=[])


def function_slips(function: Function, attributes: set[str]) -> Iterator[str]:
    """Yield a sentence for each slip in a function, or a method of a class with these attributes."""
    yield from _foreign_letters(function)
    for block in _blocks(function):
        yield from _idle_statements(block)
        yield from _recreations(block)
        yield from _overwritten_components(block)
        yield from _late_assignments(block)
        yield from _loops(block, function.name)
        yield from _shared_objects(block)
        yield from _loops_over_changed_lists(block)
        yield from _unreachable(block)
        yield from _late_settings(block)
        yield from _shared_lists(block, function)
        yield from _coordinates_rotated_twice(block)
    yield from _replaced_parameters(function)
    yield from _swapped_pairs(function)
    yield from _misread_strings(function)
    yield from _odd_calls(function)
    yield from _shared_defaults(function)
    yield from _lost_results(function)
    yield from _endless_loops(function)
    yield from _other_files(function)
    yield from _other_viewers(function)
    yield from _lost_locals(function, attributes)
    yield from _unused_fields(function)
    yield from _plain_strings(function)
    yield from _unread_names(function)


def _blocks(function: Function) -> Iterator[Sequence[ast.stmt]]:
    """Yield each list of statements in a function, without nested functions."""
    waiting: list[Sequence[ast.stmt]] = [function.body]
    while waiting:
        block = waiting.pop(0)
        yield block
        for statement in block:
            if not isinstance(statement, Function | ast.ClassDef):
                inner = [getattr(statement, name, []) for name in ("body", "orelse", "finalbody")]
                handlers = [handler.body for handler in getattr(statement, "handlers", [])]
                waiting += filter(None, [*inner, *handlers])


def quote(node: ast.AST) -> str:
    """Return the first line of a statement in double quotes, truncated to a readable length."""
    text = ast.unparse(node).splitlines()[0]
    return f'"{text}"' if len(text) <= _LONGEST else f'"{text[: _LONGEST - 1]}…"'


def _idle_statements(block: Sequence[ast.stmt]) -> Iterator[str]:
    for statement in block:
        match statement:
            case ast.Expr(value=ast.Compare(ops=[ast.Eq()])):
                yield f"{quote(statement)} compares and changes nothing: a single = sets a value."
            case ast.Expr(
                value=ast.UnaryOp(
                    op=ast.UAdd() | ast.USub() as sign, operand=ast.UnaryOp(operand=ast.Name(id=name))
                )
            ):
                yield f"{quote(statement)} changes nothing: write {name} {_SIGNS[type(sign)]}= 1."
            case ast.Expr(value=ast.BinOp() | ast.Subscript()):
                yield (f"{quote(statement)} computes a value that is not used: write a name and = before it.")
            case ast.Expr(
                value=ast.Call(func=ast.Attribute(value=ast.Name(id="np" | "math"), attr=name))
            ) if name not in _CHANGING:
                yield f"{quote(statement)} has a result that is not used: write a name and = first."
            case ast.Expr(value=ast.Attribute() as named):
                yield f"{quote(statement)} does not call {named.attr}: write ( ) after it."
            case ast.Expr(
                value=ast.Call(func=ast.Name(id=name) | ast.Attribute(value=ast.Name(), attr=name))
            ) if name in _PURE:
                yield (
                    f"{quote(statement)} returns a value and changes nothing: write a name and = before it."
                )
            case ast.Assign(value=ast.UnaryOp(op=ast.UAdd())):
                name = ast.unparse(statement.targets[0])
                yield f"=+ sets {name} to the value on the right; += adds it to {name}."
            case ast.Assign(
                targets=[ast.Name(id=name)],
                value=ast.Call(func=ast.Attribute(value=ast.Name(id=other), attr=method)),
            ) if name == other and method in IN_PLACE:
                yield f"{method}() changes {name} and returns None: leave out {name} = before it."


def created_object(statement: ast.stmt) -> tuple[str, str]:
    """Return the name and the class of an object that a statement creates, or ("", "")."""
    match statement:
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call(func=ast.Name(id=kind))) if kind[
            0
        ].isupper():
            return name, kind
    return "", ""


def _sets_field(statement: ast.stmt, name: str) -> bool:
    if not isinstance(statement, ast.Assign | ast.AugAssign):
        return False
    targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
    return any(root_of(part) == name for target in targets for part in getattr(target, "elts", [target]))


def root_of(node: ast.AST) -> str:
    """Return the variable at the root of an attribute or subscript expression, or "" for a plain variable."""
    is_inside = False
    while isinstance(node, ast.Attribute | ast.Subscript):
        node, is_inside = node.value, True
    return node.id if is_inside and isinstance(node, ast.Name) else ""


def uses(node: ast.AST, name: str) -> bool:
    """Return whether a variable occurs in a statement or an expression."""
    return any(isinstance(part, ast.Name) and part.id == name for part in ast.walk(node))


def _recreations(block: Sequence[ast.stmt]) -> Iterator[str]:
    # Whether a field of each object has been set and the object has not been used otherwise yet.
    is_filled: dict[str, bool] = {}
    for statement in block:
        name, kind = created_object(statement)
        if name:
            if is_filled.get(name):
                yield f"{quote(statement)} creates a second {kind}: the values set before are in the first."
            is_filled[name] = False
            continue
        for filled_name in list(is_filled):
            if _sets_field(statement, filled_name):
                is_filled[filled_name] = True
            elif uses(statement, filled_name):
                del is_filled[filled_name]


def _overwritten_components(block: Sequence[ast.stmt]) -> Iterator[str]:
    """Yield a sentence for each part of a message that is replaced after its fields were set."""
    stored: dict[str, ast.stmt] = {}
    for statement in block:
        match statement:
            case ast.Assign(targets=[ast.Attribute() as target], value=ast.Call(func=ast.Name(id=kind))) if (
                kind[0].isupper()
            ):
                part = f"{ast.unparse(target)}."
                lost = [line for path, line in stored.items() if path.startswith(part)]
                if lost and not uses_expression(statement.value, part[:-1]):
                    yield (
                        f"{quote(statement)} replaces the whole {target.attr}, and with it what "
                        f"{quote(lost[0])} has set: set the fields after it."
                    )
        if isinstance(statement, ast.Assign):
            paths = [ast.unparse(target) for target in statement.targets]
            names = {path for path in paths if "." not in path}
            stored = {path: line for path, line in stored.items() if path.split(".")[0] not in names}
            stored |= {path: statement for path in paths if "." in path}
        else:
            # Once a message is published, its object may be filled again.
            stored = {path: line for path, line in stored.items() if not uses(statement, path.split(".")[0])}


def uses_expression(node: ast.AST, text: str) -> bool:
    """Return whether a part of a node is an expression with this source code."""
    return any(isinstance(part, ast.expr) and ast.unparse(part) == text for part in ast.walk(node))


def _coordinates_rotated_twice(block: Sequence[ast.stmt]) -> Iterator[str]:
    """Yield a sentence for each coordinate that is computed from one that is rotated already.

    A rotation needs both old coordinates, so the first new one must not replace an old one.
    """
    sines_and_cosines: dict[str, set[str]] = {"sin": set(), "cos": set()}
    rotated: list[str] = []
    for statement in block:
        match statement:
            case ast.Assign(targets=[ast.Name() | ast.Subscript() as target], value=value):
                words = set(re.findall(r"\w+", ast.unparse(value)))
                found = [one for one, names in sines_and_cosines.items() if words & {one, *names}]
            case _:
                continue
        if len(found) == 1 and isinstance(value, ast.Call):
            sines_and_cosines[found[0]].add(ast.unparse(target))
        if len(found) < 2:
            continue
        for name in rotated:
            if uses_expression(value, name):
                yield (
                    f"{quote(statement)} reads {name}, which is rotated already. Both new "
                    "coordinates need the old ones: compute them under new names first."
                )
        rotated.append(ast.unparse(target))


def _swapped_pairs(function: Function) -> Iterator[str]:
    """Yield a sentence for each loop over pairs whose names are in the wrong order."""
    for node in ast.walk(function):
        match node:
            case (
                ast.For(
                    target=ast.Tuple(elts=[ast.Name(id=first), ast.Name(id=second)]),
                    iter=pairs,
                )
                | ast.comprehension(
                    target=ast.Tuple(elts=[ast.Name(id=first), ast.Name(id=second)]), iter=pairs
                )
            ):
                pass
            case _:
                continue
        match pairs:
            case ast.Call(func=ast.Attribute(value=ast.Name(id=table), attr="items")) if (
                table == f"{second}s"
            ):
                yield (
                    f"{table}.items() gives the key first, a {second}, and then its value: write "
                    f"for {second}, {first} in {table}.items()."
                )
            case ast.Call(
                func=ast.Name(id="enumerate"),
                args=[ast.Name(id=items)],
            ) if items == f"{first}s":
                yield (
                    f"enumerate({items}) gives a number and then an item, so that {first} is 0, 1, "
                    f"… here. The pairs of a dictionary are {items}.items()."
                )


def _misread_strings(function: Function) -> Iterator[str]:
    """Yield a sentence for each string that Python reads as single letters, and for odd digits."""
    for node in ast.walk(function):
        match node:
            case ast.Compare(
                left=ast.Name(),
                ops=[ast.In() | ast.NotIn()],
                comparators=[ast.Constant(value=str(text))],
            ) if re.fullmatch(r"\w{4,}", text):
                yield (
                    f"{quote(node)} looks for a part of this one string: compare with ==, or write "
                    f"several names as a tuple, ({text!r}, …)."
                )
            case ast.Call(
                func=ast.Attribute(attr="strip" | "lstrip" | "rstrip" as name),
                args=[ast.Constant(value=str(text))],
            ) if re.search(r"\w.*\w.*\w", text):
                other = "removesuffix" if name == "rstrip" else "removeprefix"
                yield (
                    f"{name}({text!r}) removes each of these letters, in any order: "
                    f"{other}({text!r}) removes the whole word."
                )
            case ast.FormattedValue(
                format_spec=ast.JoinedStr(values=[ast.Constant(value=str(digits))]),
            ) if re.fullmatch(r"\.\d", digits):
                yield f":{digits} counts all digits: {digits}f has {digits[1]} after the point."
            case ast.Call(
                func=ast.Name(id="str"),
                args=[ast.Call(func=ast.Name(id="round"), args=[number, digit])],
            ):
                shown = f"{{{ast.unparse(number)}:.{ast.unparse(digit)}f}}"
                yield f"{quote(node)} leaves out zeros at the end: write {shown} in an f-string."


def _published_variable(statement: ast.AST) -> str:
    """Return the variable that a statement publishes, or ""."""
    match statement:
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr=method), args=[ast.Name(id=name)])) if (
            method in _SENDING
        ):
            return name
    return ""


def _late_assignments(block: Sequence[ast.stmt]) -> Iterator[str]:
    for index, statement in enumerate(block):
        name = _published_variable(statement)
        created = any(created_object(earlier)[0] == name for earlier in block[:index])
        later = []
        for after in block[index + 1 :]:
            if created_object(after)[0] == name:
                break
            if _sets_field(after, name):
                later.append(after)
        is_recreated = any(_published_variable(later) == name for later in block[index + 1 :])
        if name and created and later and not is_recreated:
            yield (
                f"{quote(later[0])} comes after {quote(statement)}: a message is sent as it is "
                "at that moment. Set all its fields first."
            )


def _loops(block: Sequence[ast.stmt], function: str) -> Iterator[str]:
    for index, loop in enumerate(block):
        if not isinstance(loop, ast.For):
            continue
        if isinstance(loop.body[-1], ast.Return):
            yield f"return ends the loop of {function} after its first item: move it out of the loop."
        if isinstance(loop.body[-1], ast.Break):
            yield f"break ends the loop of {function} after its first item: leave it out."
        before = {name.id for part in block[:index] for name in ast.walk(part) if isinstance(name, ast.Name)}
        inside = {created_object(statement)[0] for statement in loop.body} - before - {""}
        for later in block[index + 1 :]:
            match later:
                case ast.Expr(value=ast.Call(func=ast.Attribute(attr=method), args=[ast.Name(id=name)])) if (
                    name in inside and method in (*_SENDING, "append")
                ):
                    yield (
                        f"{quote(later)} is after the loop and gets only the last {name}: move it "
                        "into the loop."
                    )
        for name, statement in _restarts(loop):
            if any(uses(later, name) for later in block[index + 1 :]):
                yield f"{quote(statement)} in the loop runs for each item: move it before the loop."
        for name in [name for statement in loop.body for name in emptied_names(statement)]:
            if any(uses(later, name) for later in block[index + 1 :]):
                yield f'"{name} = []" in the loop empties the list for each item: move it before the loop.'


def _restarts(loop: ast.For) -> Iterator[tuple[str, ast.stmt]]:
    """Yield each variable that a loop resets and then only updates, and the first statement."""
    for index, statement in enumerate(loop.body):
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if not uses(value, name):
                later = [other for other in loop.body[index + 1 :] if uses(other, name)]
            case _:
                continue
        match later:
            case [ast.AugAssign(target=ast.Name(id=changed))] if changed == name:
                yield name, statement
            case [ast.Assign(targets=[ast.Name(id=changed)], value=changed_value)] if (
                changed == name and uses(changed_value, name)
            ):
                yield name, statement


def emptied_names(statement: ast.stmt) -> list[str]:
    """Return the variables that a statement sets to an empty list: `columns, rows = [], []`."""
    match statement:
        case ast.Assign(targets=[ast.Tuple(elts=targets)], value=ast.Tuple(elts=values)) if len(
            targets
        ) == len(values):
            pairs = list(zip(targets, values, strict=True))
        case ast.Assign(targets=targets, value=value):
            pairs = [(target, value) for target in targets]
        case _:
            return []
    return [
        target.id
        for target, value in pairs
        if isinstance(target, ast.Name) and isinstance(value, ast.List) and not value.elts
    ]


def _shared_lists(block: Sequence[ast.stmt], function: Function) -> Iterator[str]:
    """Yield a sentence for each list that has two names, of which both are filled."""
    for statement in block:
        if not isinstance(statement, ast.Assign) or len(statement.targets) < 2:
            continue
        names = [name for name in emptied_names(statement) if _changes(function, name)]
        if len(names) > 1:
            lists = ", ".join("[]" for _ in names)
            yield (
                f"{quote(statement)} creates one list with {len(names)} names. "
                f"Write {', '.join(names)} = {lists}."
            )


def _late_settings(block: Sequence[ast.stmt]) -> Iterator[str]:
    """Yield a sentence for each property that is set after its layout has been saved."""
    saved: dict[str, ast.stmt] = {}
    late: dict[str, ast.stmt] = {}
    for statement in block:
        match statement:
            case ast.Expr(value=ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr="save_rviz"))):
                saved[name] = statement
                late.pop(name, None)
            case ast.Assign(targets=[target]) if root_of(target) in saved:
                late.setdefault(root_of(target), statement)
            case ast.Expr(
                value=ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr="add" | "remove"))
            ) if name in saved:
                late.setdefault(name, statement)
    for name, statement in late.items():
        yield (
            f"{quote(statement)} comes after {quote(saved[name])}: the file has only the "
            "values set before. Save at the end."
        )


def _shared_objects(block: Sequence[ast.stmt]) -> Iterator[str]:
    """Yield a sentence for each object that a loop appends to a list, or assigns to all its items."""
    for index, loop in enumerate(block):
        if not isinstance(loop, ast.For):
            continue
        is_published = any(_published_variable(node) for node in ast.walk(loop))
        created = dict(filter(lambda found: found[0], map(created_object, block[:index])))
        inside = {created_object(node)[0] for node in ast.walk(loop) if isinstance(node, ast.stmt)}
        filled = {
            name
            for name in created
            if any(_sets_field(node, name) for node in ast.walk(loop) if isinstance(node, ast.stmt))
        }
        for node in ast.walk(loop):
            match node:
                case ast.Call(func=ast.Attribute(attr="append"), args=[ast.Name(id=name)]) if (
                    name in created and name not in inside
                ):
                    yield (
                        f"{name} is a single {created[name]}, created before the loop: the list "
                        "contains the same object several times. Create it inside the loop."
                    )
                case (
                    ast.Assign(targets=[ast.Attribute(attr=str(part))], value=ast.Name(id=name))
                    | ast.keyword(arg=str(part), value=ast.Name(id=name))
                ) if name in filled - inside and not is_published:
                    yield (
                        f"{name} is a single {created[name]}, created before the loop: the {part} of "
                        "each item is this object, with the last values. Create it inside the loop."
                    )


def _loops_over_changed_lists(block: Sequence[ast.stmt]) -> Iterator[str]:
    """Yield a sentence for each loop that sets its variable to change the list, or removes items from it."""
    for index, loop in enumerate(block):
        match loop:
            case ast.For(
                target=ast.Name(id=name),
                iter=ast.Name(id=items),
                body=[*_, ast.Assign(targets=[ast.Name(id=stored)], value=value) as last],
            ) if stored == name and not any(uses(later, name) for later in block[index + 1 :]):
                yield (
                    f"{quote(last)} sets the variable of the loop, and {items} stays as it is. "
                    f"Write {items} = [{ast.unparse(value)} for {name} in {items}]."
                )
        if not isinstance(loop, ast.For) or not isinstance(loop.iter, ast.Name | ast.Attribute):
            continue
        items = ast.unparse(loop.iter)
        for part in ast.walk(loop):
            body = getattr(part, "body", None)
            statements: list[ast.stmt] = body if isinstance(body, list) else []
            for place, statement in enumerate(statements):
                match statement:
                    case ast.Expr(
                        value=ast.Call(func=ast.Attribute(value=changed, attr="remove" | "pop"))
                    ) if (
                        ast.unparse(changed) == items
                        # A loop that ends with the removal skips nothing.
                        and not any(isinstance(later, ast.Break | ast.Return) for later in statements[place:])
                    ):
                        yield (
                            f"{quote(statement)} changes {items} during the loop over it, which "
                            f"then skips an item: loop over a copy, list({items})."
                        )


def _lost_results(function: Function) -> Iterator[str]:
    """Yield a sentence for each recursive call whose list is not used."""
    for inner in ast.walk(function):
        if not isinstance(inner, Function):
            continue
        created = {
            node.targets[0].id
            for node in ast.walk(inner)
            if isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and isinstance(node.value, ast.List)
        }
        returned = {
            node.value.id
            for node in ast.walk(inner)
            if isinstance(node, ast.Return) and isinstance(node.value, ast.Name)
        }
        for node in ast.walk(inner):
            match node:
                case ast.Expr(value=ast.Call(func=ast.Name(id=name)) as call) if name == inner.name:
                    for result in sorted(created & returned):
                        if not uses(call, result):
                            yield (
                                f"{quote(call)} returns a list that is not used: write "
                                f"{result}.extend({ast.unparse(call)})."
                            )


def _shared_defaults(function: Function) -> Iterator[str]:
    arguments = [*function.args.posonlyargs, *function.args.args]
    for argument, default in zip(arguments[::-1], function.args.defaults[::-1], strict=False):
        if isinstance(default, ast.List | ast.Dict | ast.Set | ast.Call) and _changes(function, argument.arg):
            name, value = argument.arg, ast.unparse(default)
            yield (
                f"the default {name}={value} is created once, and every call of {function.name} "
                f"gets the same one. Write {name} = {value} in the function instead."
            )


def _changes(function: Function, name: str) -> bool:
    """Return whether a function mutates the object that a variable refers to."""
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Name(id=changed), attr=method)) if method in IN_PLACE:
                pass
            case ast.AugAssign(target=ast.Name(id=changed)):
                pass
            case ast.Subscript(value=ast.Name(id=changed), ctx=ast.Store()):
                pass
            case _:
                continue
        if changed == name:
            return True
    return False


_ENDLESS = ("True", "1", "rclpy.ok()", "not rospy.is_shutdown()")


def _endless_loops(function: Function) -> Iterator[str]:
    """Yield a sentence for each loop that publishes and never ends, as ROS 1 programs have it."""
    for node in ast.walk(function):
        match node:
            case ast.While(test=test, body=body) if ast.unparse(test) in _ENDLESS and not any(
                isinstance(part, ast.Break | ast.Return) for one in body for part in ast.walk(one)
            ):
                methods = {
                    call.func.attr
                    for call in ast.walk(node)
                    if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute)
                }
                # A function that spins the node itself is a program of its own.
                if methods & {"spin", "spin_once", "spin_until_future_complete"}:
                    continue
                calls_own_method = any(
                    isinstance(one, ast.Expr)
                    and isinstance(one.value, ast.Call)
                    and ast.unparse(one.value.func).startswith("self.")
                    for one in body
                )
                if methods & set(_SENDING) or calls_own_method:
                    yield (
                        f'"while {ast.unparse(test)}" in {function.name} never ends, so that no callback of '
                        "the node is called. A timer repeats the work: self.create_timer(period, function)."
                    )


def _other_viewers(function: Function) -> Iterator[str]:
    """Yield a sentence about a layout whose displays are added to the viewer of another cell."""
    own = [name for name, kind in map(created_object, function.body) if kind == "Viewer"]
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
    stored = {node.id for node in names if isinstance(node.ctx, ast.Store)}
    for node in ast.walk(function):
        match node:
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id=name), attr="add" | "save_rviz" as method)
            ) if own and name not in stored:
                yield (
                    f"{quote(node)} uses the {name} of another cell, and this function has its own "
                    f"one, {own[0]}: write {own[0]}.{method}."
                )


UNREAD = "which nothing reads afterwards."


def _unread_names(function: Function) -> Iterator[str]:
    """Yield a sentence for each parameter, loop variable and result that a function never reads."""
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
    read = {node.id for node in names if not isinstance(node.ctx, ast.Store)}
    read |= {name for node in ast.walk(function) if isinstance(node, ast.Global) for name in node.names}
    parameters = [argument.arg for argument in function.args.args]
    for name in parameters if "self" not in parameters[:1] else ():
        if name not in read and not name.startswith("_"):
            yield f"{function.name} never uses {name}: does its result not depend on it?"
    yield from _unread_items(function)
    for node in ast.walk(function):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call()) if (
                name not in read and not name.startswith("_")
            ):
                yield f"{quote(node)} sets {name}, {UNREAD}"


def _unread_items(function: Function) -> Iterator[str]:
    """Yield a sentence for each loop that does not use its items, or uses them too late."""
    for node in ast.walk(function):
        match node:
            case ast.For(target=target, iter=items, body=body):
                inner: list[ast.AST] = list(body)
            case ast.ListComp(elt=ast.expr() as item, generators=[loop]):
                target, items, inner = loop.target, loop.iter, [item, *loop.ifs]
            case _:
                continue
        names = [part.id for part in ast.walk(target) if isinstance(part, ast.Name)]
        # A loop that counts, and a list of equal items, need no name.
        is_count = isinstance(items, ast.Call) and ast.unparse(items.func) in ("range", "count")
        parts = [part for one in inner for part in ast.walk(one)]
        is_fixed = not any(isinstance(part, ast.Name | ast.Attribute) for part in parts)
        is_count |= any(isinstance(part, ast.AugAssign) for part in parts)
        is_read = any(uses(one, name) for one in inner for name in names)
        if not (is_count or is_fixed or is_read or names[0].startswith("_")):
            yield (
                f"The loop over {quote(items)} never uses {' or '.join(names)}: should each pass "
                "do something with it?"
            )
        kept = [*inner[:1]] if isinstance(node, ast.ListComp) else []
        for part in parts:
            match part:
                case ast.Call(
                    func=ast.Attribute(attr="create_timer" | "create_subscription" | "append"),
                    args=arguments,
                ):
                    kept += arguments
        for callback in kept:
            if isinstance(callback, ast.Lambda):
                own = [one.arg for one in callback.args.args]
                late = [one for one in names if uses(callback.body, one) and one not in own]
                if late:
                    yield (
                        f"{quote(callback)} reads {late[0]} when it is called, after the loop, so "
                        f"that all get the last one: write lambda {late[0]}={late[0]}: …"
                    )


def _unused_fields(function: Function) -> Iterator[str]:
    """Yield a sentence for each variable that is set and never read, and has the name of a field."""
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
    read = {node.id for node in names if isinstance(node.ctx, ast.Load)}
    declared = {
        name
        for node in ast.walk(function)
        if isinstance(node, ast.Global | ast.Nonlocal)
        for name in node.names
    }
    messages = [node.arg for node in function.args.args if node.arg != "self"]
    messages += [created_object(one)[0] for one in ast.walk(function) if isinstance(one, ast.stmt)]
    owner = next((name for name in messages if name in _MESSAGE_NAMES), "")
    for node in ast.walk(function):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)]) if (
                owner and name in _FIELD_NAMES and name not in read | declared
            ):
                yield f"{quote(node)} sets a variable that nothing reads: is {owner}.{name} meant?"


# Usual names of messages, and fields that a program sets.
_MESSAGE_NAMES = {"marker", "message", "msg", "state", "pose", "path", "scan", "status", "image"}
_FIELD_NAMES = {
    *("header", "stamp", "frame_id", "pose", "position", "orientation", "scale", "color"),
    *("lifetime", "text", "points", "ns", "id", "type", "action", "name", "velocity", "level"),
    *("values", "poses"),
}


def _odd_calls(function: Function) -> Iterator[str]:
    """Yield a sentence for each call whose arguments or whose result are not the intended ones."""
    for node in ast.walk(function):
        match node:
            case ast.For(
                target=ast.Name(id=index),
                iter=ast.Call(
                    func=ast.Name(id="range"),
                    args=[ast.BinOp(left=ast.Call(func=ast.Name(id="len")) as length, op=ast.Sub())],
                ) as numbers,
            ) if not any(isinstance(part, ast.BinOp) and uses(part, index) for part in ast.walk(node)):
                yield (
                    f"{quote(numbers)} leaves out the last item: the indices are "
                    f"range({ast.unparse(length)})."
                )
            case ast.Call(
                func=ast.Attribute(attr="create_timer"),
                args=[_, ast.Call(func=ast.Attribute(value=ast.Name(id="self"), attr=method)), *_],
            ):
                yield (
                    f"{quote(node)} calls {method} now, and passes what it returns: leave out the "
                    f"( ) after self.{method}."
                )
            case ast.Expr(value=ast.Call(func=ast.Attribute(value=items, attr="pop"), args=[])) if (
                f"{ast.unparse(items)}.append(" in ast.unparse(function)
            ):
                yield (
                    f"{quote(node)} removes the newest item: {ast.unparse(items)}.pop(0) removes "
                    "the oldest one."
                )
            case ast.Return(value=ast.Name(id="SetParametersResult")):
                yield (
                    "SetParametersResult is the class: return a result, SetParametersResult(successful=True)."
                )
            case ast.Return(value=ast.Call(func=ast.Name("SetParametersResult"), args=[], keywords=[])):
                yield (
                    "SetParametersResult() rejects the values, without a reason. Write "
                    "SetParametersResult(successful=True), or successful=False and a reason in "
                    "quotes."
                )
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id="np"), attr="matmul" | "dot" as name), args=[a, b, c]
            ):
                product = " @ ".join(map(ast.unparse, (a, b, c)))
                yield (
                    f"np.{name} multiplies two matrices; the third is where the result is stored. "
                    f"Write {product}."
                )


def _other_files(function: Function) -> Iterator[str]:
    """Yield a sentence about a layout that is saved in one file and returned from another."""
    saved: list[str] = []
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(attr="save_rviz"), args=[ast.Constant(value=str(name))]):
                saved.append(name)
    for node in ast.walk(function):
        match node:
            case ast.Call(
                func=ast.Attribute(attr="read_text", value=ast.Call(args=[ast.Constant(value=str(name))]))
            ) if saved and name not in saved:
                yield (f"The layout is saved as {saved[0]}, but the text is read from {name}: use one name.")


def find_hidden_error(source: str) -> str:
    """Return a sentence about a handler of every error that does nothing, or ""."""
    for node in ast.walk(parse(source)):
        match node:
            case ast.ExceptHandler(
                type=None | ast.Name(id="Exception" | "BaseException"),
                body=[ast.Pass() | ast.Continue() | ast.Return()],
            ):
                head = ast.unparse(node).splitlines()[0]
                return (
                    f'"{head}" also hides your own errors, like a misspelled name: print the '
                    "error there, or catch only the exception that you expect."
                )
    return ""


def _replaced_parameters(function: Function) -> Iterator[str]:
    """Yield a sentence for each parameter that is set to a fixed value before it is read."""
    parameters = {argument.arg for argument in function.args.args}
    for index, statement in enumerate(function.body):
        match statement:
            case ast.Assign(targets=[ast.Name() | ast.Tuple() as target], value=value) if _is_literal(value):
                parts = target.elts if isinstance(target, ast.Tuple) else [target]
                names = [part.id for part in parts if isinstance(part, ast.Name)]
            case _:
                continue
        for name in names:
            if name in parameters and not any(uses(earlier, name) for earlier in function.body[:index]):
                yield (
                    f"{quote(statement)} replaces the {name} that {function.name} gets with each "
                    "call: leave it out."
                )


def _is_literal(node: ast.expr) -> bool:
    try:
        ast.literal_eval(node)
    except (ValueError, TypeError):
        return False
    return True


def _unreachable(block: Sequence[ast.stmt]) -> Iterator[str]:
    for statement, after in pairwise(block):
        if isinstance(statement, ast.Return | ast.Continue | ast.Break | ast.Raise):
            yield f"{quote(after)} comes after {quote(statement)} and never runs."
        match statement:
            case ast.Expr(value=ast.Call(func=ast.Attribute(attr=name), args=args)) if (
                name in _SENDING or not args
            ) and ast.dump(statement) == ast.dump(after):
                yield f"{quote(statement)} is there twice in a row: leave one of them out."


def _lost_locals(function: Function, attributes: set[str]) -> Iterator[str]:
    nodes = list(ast.walk(function))
    names = [node for node in nodes if isinstance(node, ast.Name)]
    read_names = {node.id for node in names if isinstance(node.ctx, ast.Load)}
    loops = [node.target for node in nodes if isinstance(node, ast.For | ast.comprehension)]
    # The variable of a loop is not meant to last.
    inner = [part for target in loops for part in ast.walk(target)]
    for node in names:
        is_lost = isinstance(node.ctx, ast.Store) and node.id in attributes - read_names
        if is_lost and node not in inner:
            yield (
                f"{node.id} = … in {function.name} sets a local variable, which is lost at the end "
                f"of the method. To keep it, write self.{node.id} = …"
            )


def _foreign_letters(function: Function) -> Iterator[str]:
    """Yield a sentence for each string with a foreign letter that looks like a Latin one."""
    for node in ast.walk(function):
        match node:
            case ast.Constant(value=str(text)) if found := foreign_letter(text):
                yield f"{found}: type the string again."


def _plain_strings(function: Function) -> Iterator[str]:
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
    local = {node.id for node in names if isinstance(node.ctx, ast.Store)}
    local |= {argument.arg for argument in function.args.args}
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
            and (field := _FIELD.search(node.value))
            # Code in a string of several lines has its own f-strings and dictionaries.
            and ("\n" not in node.value or re.split(r"\W", field[0])[1] in local)
        ):
            text = field[0] if "\n" in node.value else node.value[:_LONGEST]
            yield f"the string {text!r} has names in {{ }}: write f before its quotes."
