"""Slips that raise no error, such as `==` for `=`, found in the syntax tree of a student's code."""

import ast
import re
import textwrap
from collections import Counter
from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from itertools import pairwise

# Methods of lists, dictionaries and sets that change them and return None.
IN_PLACE = {"append", "extend", "insert", "remove", "reverse", "sort", "clear", "update", "add", "discard"}
# Functions and methods that only return a value.
_PURE = {"sorted", "reversed", "round", "abs", "replace", "strip", "lower", "upper", "format", "split"}
_SENDING = ("publish", "sendTransform")
# Objects that receive messages only after they are created. A publisher that is created in a
# callback does send, so it is never the reason that a check fails.
_RECEIVERS = {"Buffer", "TransformListener", "create_subscription"}
_SIGNS = {ast.UAdd: "+", ast.USub: "-"}
_LONGEST = 60  # characters of a quoted line
_FIELD = re.compile(r"\{[a-z_]\w*(\.\w+|\[\w+\])*(:[^{}]*)?\}")
Function = ast.FunctionDef | ast.AsyncFunctionDef


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
        if isinstance(outer, ast.ClassDef):
            for slip in (*_renewed_receivers(outer), *_replaced_methods(outer)):
                return slip
        attributes = _attributes_of_self(outer) if isinstance(outer, ast.ClassDef) else set()
        functions = outer.body if isinstance(outer, ast.ClassDef | ast.Module) else []
        for function in functions:
            if isinstance(function, Function):
                for slip in _slips(function, attributes):
                    return slip
        if isinstance(outer, ast.ClassDef):
            for slip in (
                *_repeated_timers(outer),
                *_destructive_callbacks(outer),
                *_generators(outer),
                *_misspelled_attributes(outer),
            ):
                return slip
    return ""


def _slips(function: Function, attributes: set[str]) -> Iterator[str]:
    for block in _blocks(function):
        yield from _idle_statements(block)
        yield from _recreations(block)
        yield from _late_assignments(block)
        yield from _loops(block, function.name)
        yield from _reused_objects(block)
        yield from _shrinking_loops(block)
        yield from _unreachable(block)
    yield from _odd_operators(function)
    yield from _empty_results(function)
    yield from _lost_factors(function)
    yield from _shared_defaults(function)
    yield from _lost_results(function)
    if function.args.args[:1] and function.args.args[0].arg == "self":
        yield from _blocking_calls(function)
        yield from _waiting_loops(function)
        yield from _endless_loops(function)
        yield from _python_timers(function)
        yield from _early_lookups(function)
        yield from _idle_lambdas(function)
    yield from _other_files(function)
    yield from _lost_locals(function, attributes)
    yield from _plain_strings(function)
    yield from _integer_quotients(function)
    yield from _cut_quotients(function)


def _blocks(function: Function) -> Iterator[Sequence[ast.stmt]]:
    """Yield each list of statements in a function, without nested functions."""
    waiting: list[Sequence[ast.stmt]] = [function.body]
    while waiting:
        block = waiting.pop(0)
        yield block
        for statement in block:
            if not isinstance(statement, Function | ast.ClassDef):
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
            case ast.Expr(
                value=ast.UnaryOp(
                    op=ast.UAdd() | ast.USub() as sign, operand=ast.UnaryOp(operand=ast.Name(id=name))
                )
            ):
                yield f"{_quote(statement)} changes nothing: write {name} {_SIGNS[type(sign)]}= 1."
            case ast.Expr(value=ast.BinOp()):
                yield (
                    f"{_quote(statement)} computes a value that is not used: write a name and = before it."
                )
            case ast.Expr(value=ast.Attribute() as named):
                yield f"{_quote(statement)} names {named.attr} and does not call it: write ( ) after it."
            case ast.Expr(
                value=ast.Call(func=ast.Name(id=name) | ast.Attribute(value=ast.Name(), attr=name))
            ) if name in _PURE:
                yield (
                    f"{_quote(statement)} returns a value and changes nothing: write a name and = before it."
                )
            case ast.Assign(value=ast.UnaryOp(op=ast.UAdd())):
                name = ast.unparse(statement.targets[0])
                yield f"=+ sets {name} to the value on the right; += adds it to {name}."
            case ast.Assign(
                targets=[ast.Name(id=name)],
                value=ast.Call(func=ast.Attribute(value=ast.Name(id=other), attr=method)),
            ) if name == other and method in IN_PLACE:
                yield f"{method}() changes {name} and returns None: leave out {name} = before it."


def _created_object(statement: ast.stmt) -> tuple[str, str]:
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
    """Return the variable at the root of an attribute or subscript expression, or "" for a plain variable."""
    is_inside = False
    while isinstance(node, ast.Attribute | ast.Subscript):
        node, is_inside = node.value, True
    return node.id if is_inside and isinstance(node, ast.Name) else ""


def _uses(node: ast.AST, name: str) -> bool:
    return any(isinstance(one, ast.Name) and one.id == name for one in ast.walk(node))


def _recreations(block: Sequence[ast.stmt]) -> Iterator[str]:
    # Whether a field of each object has been set and the object has not been used otherwise yet.
    is_filled: dict[str, bool] = {}
    for statement in block:
        name, kind = _created_object(statement)
        if name:
            if is_filled.get(name):
                yield f"{_quote(statement)} creates a second {kind}: what was set before is in the first."
            is_filled[name] = False
            continue
        for filled_name in list(is_filled):
            if _sets_field(statement, filled_name):
                is_filled[filled_name] = True
            elif _uses(statement, filled_name):
                del is_filled[filled_name]


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
        created = any(_created_object(one)[0] == name for one in block[:index])
        later = []
        for after in block[index + 1 :]:
            if _created_object(after)[0] == name:
                break
            if _sets_field(after, name):
                later.append(after)
        is_recreated = any(_published_variable(one) == name for one in block[index + 1 :])
        if name and created and later and not is_recreated:
            yield (
                f"{_quote(later[0])} comes after {_quote(statement)}: a message is sent as it is "
                "at that moment. Set everything before."
            )


def _loops(block: Sequence[ast.stmt], function: str) -> Iterator[str]:
    for index, loop in enumerate(block):
        if not isinstance(loop, ast.For):
            continue
        if isinstance(loop.body[-1], ast.Return):
            yield f"return ends the loop of {function} after its first item: move it out of the loop."
        before = {name.id for one in block[:index] for name in ast.walk(one) if isinstance(name, ast.Name)}
        inside = {_created_object(one)[0] for one in loop.body} - before - {""}
        for later in block[index + 1 :]:
            match later:
                case ast.Expr(value=ast.Call(func=ast.Attribute(attr=method), args=[ast.Name(id=name)])) if (
                    name in inside and method in (*_SENDING, "append")
                ):
                    yield (
                        f"{_quote(later)} is after the loop and gets only the last {name}: move it "
                        "into the loop."
                    )
        emptied_names = [
            one.targets[0].id
            for one in loop.body
            if isinstance(one, ast.Assign)
            and isinstance(one.targets[0], ast.Name)
            and isinstance(one.value, ast.List)
            and not one.value.elts
        ]
        for name in emptied_names:
            if any(_uses(one, name) for one in block[index + 1 :]):
                yield f'"{name} = []" in the loop empties the list for each item: move it before the loop.'


def _reused_objects(block: Sequence[ast.stmt]) -> Iterator[str]:
    for index, loop in enumerate(block):
        if not isinstance(loop, ast.For):
            continue
        created = dict(filter(lambda found: found[0], map(_created_object, block[:index])))
        inside = {_created_object(one)[0] for one in ast.walk(loop) if isinstance(one, ast.stmt)}
        for node in ast.walk(loop):
            match node:
                case ast.Call(func=ast.Attribute(attr="append"), args=[ast.Name(id=name)]) if (
                    name in created and name not in inside
                ):
                    yield (
                        f"{name} is a single {created[name]}, created before the loop: the list "
                        "gets it again and again. Create it inside the loop."
                    )


def _shrinking_loops(block: Sequence[ast.stmt]) -> Iterator[str]:
    """Yield a sentence for each loop over a list from which it removes items."""
    for loop in block:
        if not isinstance(loop, ast.For) or not isinstance(loop.iter, ast.Name | ast.Attribute):
            continue
        items = ast.unparse(loop.iter)
        for part in ast.walk(loop):
            body = getattr(part, "body", None)
            statements: list[ast.stmt] = body if isinstance(body, list) else []
            for index, statement in enumerate(statements):
                match statement:
                    case ast.Expr(
                        value=ast.Call(func=ast.Attribute(value=changed, attr="remove" | "pop"))
                    ) if (
                        ast.unparse(changed) == items
                        # A loop that ends with the removal skips nothing.
                        and not any(isinstance(one, ast.Break | ast.Return) for one in statements[index:])
                    ):
                        yield (
                            f"{_quote(statement)} changes {items} during the loop over it, which "
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
                        if not _uses(call, result):
                            yield (
                                f"{_quote(call)} returns a list that is not used: write "
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


def _blocking_calls(function: Function) -> Iterator[str]:
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Name(id="time"), attr="sleep")):
                yield (
                    f"time.sleep in {function.name} stops the whole node: no other callback runs "
                    "before it ends. Use a timer."
                )
            case ast.Call(
                func=ast.Attribute(
                    value=ast.Name(id="rclpy"), attr="spin" | "spin_once" | "spin_until_future_complete"
                )
                | ast.Name(id="spin_for" | "run_live")
            ):
                yield (
                    f"{_quote(node.func)} in {function.name} waits for callbacks while the node is "
                    "busy with this one: leave it out, the node is spun from outside."
                )


def _waiting_loops(function: Function) -> Iterator[str]:
    """Yield a sentence for each loop that waits for messages, which arrive only after the method ends."""
    for node in ast.walk(function):
        match node:
            case ast.While(test=ast.Constant() | ast.Compare()):
                continue
            case ast.While(test=test, body=body) if all(map(_only_waits, body)):
                yield (
                    f'"while {ast.unparse(test)}" in {function.name} waits for messages, and the node '
                    "receives none before the method ends: ask once, with if, and return if it is too early."
                )


def _endless_loops(function: Function) -> Iterator[str]:
    """Yield a sentence for each loop that publishes and never ends, as ROS 1 programs have it."""
    for node in ast.walk(function):
        match node:
            case ast.While(test=test, body=body) if _is_endless(test) and not _leaves(body):
                methods = {
                    call.func.attr
                    for call in ast.walk(node)
                    if isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute)
                }
                if methods & set(_SENDING) or _calls_own_method(node):
                    yield (
                        f'"while {ast.unparse(test)}" in {function.name} never ends, so that no callback of '
                        "the node is called. A timer repeats the work: self.create_timer(period, function)."
                    )


def _is_endless(test: ast.expr) -> bool:
    return ast.unparse(test) in ("True", "1", "rclpy.ok()", "not rospy.is_shutdown()")


def _leaves(body: Sequence[ast.stmt]) -> bool:
    return any(isinstance(node, ast.Break | ast.Return) for one in body for node in ast.walk(one))


def _calls_own_method(loop: ast.While) -> bool:
    return any(
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Call)
        and ast.unparse(node.value.func).startswith("self.")
        for node in loop.body
    )


def _only_waits(statement: ast.stmt) -> bool:
    match statement:
        case ast.Pass() | ast.Continue() | ast.Expr(value=ast.Constant()):
            return True
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr="sleep" | "info" | "warn" | "warning"))):
            return True
    return False


def _python_timers(function: Function) -> Iterator[str]:
    for node in ast.walk(function):
        match node:
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id="threading"), attr="Timer") | ast.Name(id="Timer")
            ):
                yield (
                    f"{_quote(node)} calls its function once, after the wall clock. A timer of the "
                    "node calls it again and again: self.create_timer(period, function)."
                )


def _early_lookups(function: Function) -> Iterator[str]:
    """Yield a sentence for each lookup at the present time, which no transform has reached."""
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(attr="lookup_transform"), args=[_, _, time], keywords=[]) if (
                re.search(r"\.now\(\)(\.to_msg\(\))?$", ast.unparse(time))
            ):
                yield (
                    f"{ast.unparse(time)} in lookup_transform is later than the last transform "
                    "that has arrived: pass the stamp of a message, or Time() for the newest "
                    "transform."
                )


def _lost_factors(function: Function) -> Iterator[str]:
    for node in ast.walk(function):
        match node:
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id="np"), attr="matmul" | "dot" as name), args=[a, b, c]
            ):
                product = " @ ".join(map(ast.unparse, (a, b, c)))
                yield (
                    f"np.{name} multiplies two matrices; the third is where the result is stored. "
                    f"Write {product}."
                )


def _idle_lambdas(function: Function) -> Iterator[str]:
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(attr="create_timer" | "create_subscription"), args=args):
                for one in args:
                    if isinstance(one, ast.Lambda) and isinstance(one.body, ast.Attribute):
                        name = ast.unparse(one.body)
                        yield f"{_quote(one)} names {one.body.attr} and does not call it: pass {name} alone."


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
                yield f"The layout is saved as {saved[0]}, and the text is that of {name}: use one name."


def _callbacks_of(cls: ast.ClassDef) -> Iterator[Function]:
    """Yield the methods of a class that are passed as callbacks."""
    called = [node.func for node in ast.walk(cls) if isinstance(node, ast.Call)]
    passed = {
        node.attr
        for node in ast.walk(cls)
        if isinstance(node, ast.Attribute) and node not in called and _root(node) == "self"
    }
    for function in cls.body:
        if isinstance(function, Function) and function.name in passed - {"__init__"}:
            yield function


def _renewed_receivers(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each buffer, listener or subscription created in a callback."""
    for function in _callbacks_of(cls):
        for node in ast.walk(function):
            match node:
                case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name in _RECEIVERS:
                    yield (
                        f"{_quote(node)} is in {function.name}: each call creates a new one, "
                        "which has received nothing yet. Create it once, in __init__."
                    )


def _generators(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each callback that yields: a call of it runs none of its lines."""
    for function in _callbacks_of(cls):
        if any(isinstance(node, ast.Yield | ast.YieldFrom) for node in ast.walk(function)):
            yield (
                f"yield makes {function.name} a generator, and a call runs none of its lines: leave it out."
            )


def _misspelled_attributes(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each attribute that is only set and resembles one that is only read."""
    read: set[str] = set()
    stored: dict[str, ast.expr] = {}
    for function in cls.body:
        if not isinstance(function, Function):
            continue
        for node in ast.walk(function):
            match node:
                case ast.Attribute(value=ast.Name(id="self"), attr=name, ctx=ast.Load()):
                    read.add(name)
                case ast.Attribute(value=ast.Name(id="self"), attr=name) if function.name != "__init__":
                    stored[name] = node
    for name in stored.keys() - read:
        similar = get_close_matches(name, read - stored.keys(), 1, 0.8)
        if similar:
            yield (
                f"self.{name} is set and never read, and self.{similar[0]} is read and never set "
                "outside of __init__: are they meant to be one?"
            )


def _replaced_methods(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each method that an attribute of the same name replaces."""
    methods = {node.name for node in cls.body if isinstance(node, Function) and not node.decorator_list}
    for node in ast.walk(cls):
        match node:
            case ast.Assign(targets=[ast.Attribute(value=ast.Name(id="self"), attr=name)], value=value) if (
                name in methods and not isinstance(value, ast.Lambda)
            ):
                yield (
                    f"{_quote(node)} replaces the method {name}, which cannot be called after it: "
                    "choose another name for one of them."
                )


def find_growing_list(source: str) -> str:
    """Return a sentence about a list of a node that grows with each call of a callback, or ""."""
    for cls in ast.walk(parse(source)):
        if not isinstance(cls, ast.ClassDef):
            continue
        created = set[str]()
        for node in ast.walk(cls):
            match node:
                case ast.Assign(
                    targets=[ast.Attribute(value=ast.Name(id="self")) as target],
                    value=ast.List(elts=[]) | ast.Call(func=ast.Name(), args=[], keywords=[]),
                ):
                    created.add(ast.unparse(target))
        for function in _callbacks_of(cls):
            for node in ast.walk(function):
                match node:
                    case ast.Call(func=ast.Attribute(value=grown, attr="append" | "extend")):
                        pass
                    case ast.AugAssign(target=ast.Attribute() as grown, op=ast.Add(), value=ast.List()):
                        pass
                    case _:
                        continue
                items = ast.unparse(grown)
                owner = ".".join(items.split(".")[:2])
                if owner in created and not _shortens(cls, items, owner):
                    return (
                        f"{items} keeps the items of each earlier call of {function.name}: empty "
                        "it there first, or create a new list in each call."
                    )
    return ""


def _shortens(cls: ast.ClassDef, items: str, owner: str) -> bool:
    """Return whether a class shortens or replaces a list outside of __init__."""
    for function in cls.body:
        if not isinstance(function, Function) or function.name == "__init__":
            continue
        # += stores a list, and makes it longer.
        longer = [node.target for node in ast.walk(function) if isinstance(node, ast.AugAssign)]
        for node in ast.walk(function):
            match node:
                case ast.Call(func=ast.Attribute(value=changed, attr="clear" | "pop" | "popleft" | "remove")):
                    pass
                case ast.Attribute(ctx=ast.Store() | ast.Del()) as changed if changed not in longer:
                    pass
                case ast.Subscript(value=changed, slice=ast.Slice()):
                    pass
                case ast.Subscript(value=changed, ctx=ast.Store() | ast.Del()):
                    pass
                case ast.Call(func=ast.Name(id="len"), args=[changed]):
                    pass
                case _:
                    continue
            if ast.unparse(changed) in (items, owner):
                return True
    return False


def _empty_results(function: Function) -> Iterator[str]:
    """Yield a sentence for each empty result of a parameter callback."""
    for node in ast.walk(function):
        match node:
            case ast.Return(value=ast.Call(func=ast.Name("SetParametersResult"), args=[], keywords=[])):
                yield (
                    "SetParametersResult() rejects the values, without a reason. Write "
                    "SetParametersResult(successful=True), or successful=False and a reason in "
                    "quotes."
                )


def _repeated_timers(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for timers that add up: created in a callback, or two with one callback."""
    for function in _callbacks_of(cls):
        calls = [node for node in ast.walk(function) if isinstance(node, ast.Call)]
        methods = {node.func.attr for node in calls if isinstance(node.func, ast.Attribute)}
        if "create_timer" in methods and not methods & {"destroy_timer", "cancel"}:
            yield (
                f"create_timer is in {function.name}: each call creates another timer, and all of "
                "them run. Create it once, in __init__, or end the old one first, with "
                "destroy_timer."
            )
    callbacks: Counter[str] = Counter()
    for node in ast.walk(cls):
        match node:
            case ast.Call(func=ast.Attribute(attr="create_timer"), args=[_, ast.Attribute() as callback, *_]):
                callbacks[ast.unparse(callback)] += 1
    for name, count in callbacks.items():
        if count > 1 and "destroy_timer" not in ast.unparse(cls):
            yield f"{count} timers call {name}, so that it runs {count} times: leave one of them."


_ENDINGS = {
    "destroy_node": "ends the node",
    "shutdown": "ends all nodes",
    "cancel": "ends the timer",
    "destroy_timer": "ends the timer",
    "destroy_publisher": "ends the publisher",
    "destroy_subscription": "ends the subscription",
}


def _destructive_callbacks(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each callback that ends its node, its timer or its publisher."""
    for function in _callbacks_of(cls):
        if "create_timer" in ast.unparse(function):
            continue
        # A call in an if or a try is meant for a certain moment.
        for statement in function.body:
            match statement:
                case ast.Expr(value=ast.Call(func=ast.Attribute(attr=name))) if name in _ENDINGS:
                    yield (
                        f"{_quote(statement)} in {function.name} {_ENDINGS[name]} when the "
                        "callback runs for the first time: leave it out."
                    )


def _integer_quotients(function: Function) -> Iterator[str]:
    """Yield a question about // where the result is neither an index nor a count."""
    whole: set[int] = set()
    counts = {
        name.id
        for node in ast.walk(function)
        for part in _integer_operands(node)
        for name in ast.walk(part)
        if isinstance(name, ast.Name)
    }
    for node in ast.walk(function):
        inner = list(_integer_operands(node))
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if name in counts:
                inner.append(value)
        whole |= {id(part) for one in inner for part in ast.walk(one)}
    for node in ast.walk(function):
        match node:
            case ast.BinOp(op=ast.FloorDiv()) if id(node) not in whole:
                yield f"{_quote(node)} leaves out the fraction: is a whole number meant? / divides."


def _cut_quotients(function: Function) -> Iterator[str]:
    """Yield a question about int( ) or round( ) of a quotient that is returned or set."""
    for node in ast.walk(function):
        match node:
            case ast.Assign(
                targets=[ast.Name(id=name)],
                value=ast.Call(func=ast.Name(id="int" | "round" as cut), args=[argument]),
            ) if any(isinstance(part, ast.Div) for part in ast.walk(argument)):
                places = [inner for other in ast.walk(function) for inner in _integer_operands(other)]
                if not any(_uses(place, name) for place in places):
                    yield f"{cut}( ) leaves out the fraction of {name}: is a whole number meant?"


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
                    f'"{head}" also hides your own errors, like a misspelled name: print the error there, '
                    "or catch only the exception that you expect."
                )
    return ""


def _integer_operands(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the subexpressions that must be integers."""
    match node:
        case ast.Subscript(slice=index):
            yield index
        case ast.Call(func=ast.Name(id="range" | "int" | "divmod" | "chr"), args=args):
            yield from args
        case ast.keyword(arg="id" | "sec" | "nanosec" | "nanoseconds" | "depth", value=value):
            yield value
        case ast.Assign(targets=[ast.Attribute(attr="id" | "sec" | "nanosec")], value=value):
            yield value


def _odd_operators(function: Function) -> Iterator[str]:
    for node in ast.walk(function):
        match node:
            case ast.BinOp(left=ast.Constant(value=1), op=ast.FloorDiv()):
                yield f"{_quote(node)} is 0 for every number above 1: / divides, // leaves out the fraction."
            case ast.Compare(
                ops=[ast.Is() | ast.IsNot() as operator], comparators=[ast.Constant(value=value)]
            ) if isinstance(value, str | int | float) and not isinstance(value, bool):
                sign = "==" if isinstance(operator, ast.Is) else "!="
                yield f"{_quote(node)} tests whether both are one object: compare values with {sign}."


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


def _lost_locals(function: Function, attributes: set[str]) -> Iterator[str]:
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
    read_names = {node.id for node in names if isinstance(node.ctx, ast.Load)}
    for node in names:
        if isinstance(node.ctx, ast.Store) and node.id in attributes - read_names:
            yield (
                f"{node.id} = … in {function.name} sets a variable that ends with the method. To "
                f"keep it, write self.{node.id} = …"
            )


def _is_local(function: Function, name: str) -> bool:
    """Return whether a function sets a variable or has a parameter of this name."""
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
    stored = {node.id for node in names if isinstance(node.ctx, ast.Store)}
    return name in stored | {argument.arg for argument in function.args.args}


def _plain_strings(function: Function) -> Iterator[str]:
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
            and ("\n" not in node.value or _is_local(function, re.split(r"\W", field[0])[1]))
        ):
            text = field[0] if "\n" in node.value else node.value[:_LONGEST]
            yield f"the string {text!r} has names in {{ }}: write f before its quotes."
