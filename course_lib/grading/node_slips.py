"""Slips in the classes of nodes that raise no error, and the first slip of a student's code."""

import ast
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from functools import cache
from itertools import combinations

from course_lib.errors import join_words
from course_lib.grading.number_slips import number_slips
from course_lib.grading.slips import (
    Function,
    created_object,
    function_slips,
    parse,
    quote,
    root_of,
    uses,
    uses_expression,
)
from course_lib.ros.messages.definitions import definition, type_names

# Objects that receive messages only after they are created. A publisher that is created in a
# callback does send, so it is never the reason that a check fails.
_RECEIVERS = {"Buffer", "TransformListener", "create_subscription"}


def find_slip(source: str) -> str:
    """Return a sentence about the first slip in the code, or ""."""
    tree = parse(source)
    for outer in ast.walk(tree):
        if isinstance(outer, ast.ClassDef):
            for slip in (
                *_repeated_methods(outer),
                *_renewed_receivers(outer),
                *_unfilled_buffers(outer),
                *_replaced_methods(outer),
                *_odd_parameter_callbacks(outer),
                *_undeclared_names(outer),
                *_unread_attributes(outer),
                *_early_ends(outer),
                *_odd_tables(outer),
            ):
                return slip
        attributes = {
            node.attr
            for node in (ast.walk(outer) if isinstance(outer, ast.ClassDef) else ())
            if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "self"
        }
        functions = outer.body if isinstance(outer, ast.ClassDef | ast.Module) else []
        for function in functions:
            if isinstance(function, Function):
                for slip in (
                    *function_slips(function, attributes),
                    *_method_slips(function),
                    *number_slips(function),
                ):
                    return slip
        if isinstance(outer, ast.ClassDef):
            for slip in (
                *_repeated_timers(outer),
                *_odd_callbacks(outer),
                *_misspelled_attributes(outer),
                *_uncalled_methods(outer),
                *_fields_of_node(outer),
                *_unread_values(outer),
                *_replaced_stamps(outer),
            ):
                return slip
    return next(_exchanged_arguments(tree), "") or next(_variants_of_names(tree), "")


def _variants_of_names(tree: ast.AST) -> Iterator[str]:
    """Yield a sentence for two strings like base_link and Base_link, which differ in case only."""
    strings = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    names = [one for one in strings if isinstance(one, str) and re.fullmatch(r"/?\w+_\w+", one)]
    for name, later in combinations(dict.fromkeys(names), 2):
        if name.lower() == later.lower():
            yield f"{name!r} and {later!r} are two names: ROS distinguishes upper and lower case."


def _exchanged_arguments(tree: ast.AST) -> Iterator[str]:
    """Yield a sentence for each call whose arguments have the names of parameters, in another order."""
    functions = {one.name: one for one in getattr(tree, "body", ()) if isinstance(one, Function)}
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in functions:
                passed = [one.id for one in args if isinstance(one, ast.Name)]
                expected = [one.arg for one in functions[name].args.args]
                is_same = sorted(passed) == sorted(expected) and len(passed) == len(args)
                if is_same and passed != expected:
                    yield (
                        f"{quote(node)} passes its values in another order than def "
                        f"{name}({', '.join(expected)})."
                    )


def callbacks_of(cls: ast.ClassDef) -> Iterator[Function]:
    """Yield the methods of a class that are passed as callbacks."""
    called = [node.func for node in ast.walk(cls) if isinstance(node, ast.Call)]
    passed = {
        node.attr
        for node in ast.walk(cls)
        if isinstance(node, ast.Attribute) and node not in called and root_of(node) == "self"
    }
    for function in cls.body:
        if isinstance(function, Function) and function.name in passed - {"__init__"}:
            yield function


def _repeated_methods(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each method that a later one of the same name replaces."""
    # Decorators like @property and its setter need the same name twice.
    names = Counter(f.name for f in cls.body if isinstance(f, Function) and not f.decorator_list)
    for name, count in names.items():
        if count > 1:
            yield (
                f"{cls.name} has def {name} {count} times, and only the last one counts: delete "
                "the others, or give them names of their own."
            )


def _renewed_receivers(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each buffer, listener or subscription created in a callback."""
    for function in callbacks_of(cls):
        for node in ast.walk(function):
            match node:
                case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name in _RECEIVERS:
                    yield (
                        f"{quote(node)} is in {function.name}: each call creates a new one, "
                        "which has received nothing yet. Create it once, in __init__."
                    )


def _unfilled_buffers(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each buffer into which no listener puts transforms."""
    created = {
        ast.unparse(target)
        for node in ast.walk(cls)
        if isinstance(node, ast.Assign)
        for target, value in pairs_of(node)
        if isinstance(value, ast.Call) and ast.unparse(value.func) == "Buffer"
    }
    listeners = [
        node
        for node in ast.walk(cls)
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "TransformListener"
    ]
    filled = {ast.unparse(argument) for listener in listeners for argument in listener.args[:1]}
    for buffer in sorted(created - filled):
        call = f"TransformListener({buffer}, self)"
        # A local variable may be passed to a function that creates the listener.
        asked = (f"{buffer}.lookup_transform", f"{buffer}.can_transform", f"{buffer}.transform")
        if not buffer.startswith("self.") or not any(
            isinstance(node, ast.Attribute) and ast.unparse(node) in asked for node in ast.walk(cls)
        ):
            continue
        if not listeners:
            yield f"{buffer} receives no transforms: create a listener in __init__, {call}."
        elif all(isinstance(listener.args[0], ast.Call) for listener in listeners if listener.args):
            yield f"{quote(listeners[0])} fills another buffer than {buffer}: write {call}."


def pairs_of(node: ast.Assign) -> list[tuple[ast.expr, ast.expr]]:
    """Return each target of an assignment with its value, as in `self.poses, self.buffer = [], Buffer()`."""
    match node:
        case ast.Assign(targets=[ast.Tuple(elts=targets)], value=ast.Tuple(elts=values)) if len(
            targets
        ) == len(values):
            return list(zip(targets, values, strict=True))
    return [(target, node.value) for target in node.targets]


def _odd_parameter_callbacks(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each parameter callback that does not return a result at its end."""
    methods = {f.name: f for f in cls.body if isinstance(f, Function)}
    result = "return SetParametersResult(successful=True)"
    for node in ast.walk(cls):
        match node:
            case ast.Call(
                func=ast.Attribute(attr="add_on_set_parameters_callback"), args=[ast.Attribute(attr=name)]
            ) if name in methods:
                if isinstance(methods[name], ast.AsyncFunctionDef):
                    yield (
                        f"async makes {name} return a coroutine instead of a result, so ROS "
                        "rejects each value: leave async out."
                    )
                elif fixed := _returned_constant(methods[name]):
                    yield (
                        f"{name} returns {fixed}, and ROS expects a SetParametersResult: "
                        f"{result}, or successful=False and a reason."
                    )
                elif first := _first_parameter(methods[name]):
                    yield (
                        f"{first} is only the first parameter of a call, which may set several: "
                        "write a loop over all of them."
                    )
                elif late := _late_check(methods[name]):
                    yield late
                elif _may_end_without_return(methods[name].body):
                    yield (
                        f"{name} may end without return, and then ROS rejects the value: end it "
                        f"with {result}."
                    )


def _late_check(function: Function) -> str:
    """Return a sentence about a timer that a parameter callback changes too early, or "".

    A new timer may also get the old value of the parameter.
    """
    for node in ast.walk(function):
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("create_timer"):
            for old in ast.walk(node):
                if isinstance(old, ast.Call) and ast.unparse(old.func).endswith("get_parameter"):
                    return (
                        f"{quote(old)} in {function.name} still has the old value: ROS sets the new "
                        "one after this callback. Use parameter.value."
                    )
        changed = ""
        body = getattr(node, "body", [])
        for statement in body if isinstance(body, list) else []:
            text = ast.unparse(statement)
            if isinstance(statement, ast.If) and changed and "successful=False" in text:
                return (
                    f"{changed} comes before the value is checked, so a rejected value changes the "
                    "timer, too: return successful=False first."
                )
            if not isinstance(statement, ast.If) and re.search(r"(create|destroy)_timer\(", text):
                changed = changed or quote(statement)
    return ""


# By the method or class that creates an object: the attributes that rclpy reads from it later, and
# the calls that set its other properties.
_READ_LATER = {
    "create_timer": (
        {"callback", "timer_period_ns"},
        "the period is timer_period_ns, in nanoseconds. Or destroy the timer and create a new one",
    ),
    "create_publisher": (set(), "topic, type and QoS are arguments of create_publisher"),
    "create_subscription": ({"callback"}, "topic and QoS are arguments of create_subscription"),
    "create_client": (set(), "type and name are arguments of create_client"),
    "create_service": ({"callback"}, "type, name and callback are arguments of create_service"),
    "TransformBroadcaster": (set(), "each transform has its frames: sendTransform sends it"),
    "StaticTransformBroadcaster": (set(), "each transform has its frames: sendTransform sends it"),
}


def _unread_attributes(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each attribute set on an object of rclpy that does not read it."""
    created: dict[str, str] = {}
    read: set[str] = set()
    for node in ast.walk(cls):
        match node:
            case ast.Assign(value=ast.Call(func=ast.Attribute(attr=kind) | ast.Name(id=kind))):
                if kind in _READ_LATER:
                    created |= {ast.unparse(target): kind for target in node.targets}
            case ast.Attribute(attr=name, ctx=ast.Load()):
                read.add(name)
    idle = [name for name, kind in created.items() if kind == "TransformBroadcaster"]
    idle = [name for name in idle if name.rpartition(".")[2] not in read]
    for method in cls.body if idle else ():
        for node in ast.walk(method) if getattr(method, "name", "__init__") != "__init__" else ():
            name = ast.unparse(node) if isinstance(node, ast.Attribute) else ""
            if created.get(name, "").startswith("Static"):
                yield (
                    f"{name} is for frames that never move, and {idle[0]} is not used: "
                    f"{getattr(method, 'name', '')} needs {idle[0]}."
                )
    for node in ast.walk(cls):
        match node:
            case ast.Assign(targets=[ast.Attribute(value=owner, attr=name)]) if kind := created.get(
                ast.unparse(owner), ""
            ):
                used, advice = _READ_LATER[kind]
                if name not in used | read:
                    yield f"{quote(node)} sets an attribute that ROS does not read: {advice}."


def _returned_constant(function: Function) -> str:
    """Return the True or False that a function returns, or ""."""
    for node in ast.walk(function):
        match node:
            case ast.Return(value=ast.Constant(value=bool() as value)):
                return str(value)
    return ""


def _first_parameter(function: Function) -> str:
    """Return the expression that selects the first item of a callback's list, or ""."""
    names = [one.arg for one in function.args.args[1:2]]
    has_loop = any(isinstance(node, ast.For | ast.comprehension) for node in ast.walk(function))
    for node in ast.walk(function):
        match node:
            case ast.Subscript(value=ast.Name(id=name), slice=ast.Constant(value=0)) if (
                name in names and not has_loop
            ):
                return ast.unparse(node)
    return ""


def _may_end_without_return(block: Sequence[ast.stmt]) -> bool:
    match block[-1]:
        case ast.Return() | ast.Raise():
            return False
        case ast.If(body=body, orelse=[_, *_] as other):
            return _may_end_without_return(body) or _may_end_without_return(other)
        case ast.With(body=body):
            return _may_end_without_return(body)
        case ast.Try(body=body, handlers=handlers, orelse=orelse):
            return any(
                _may_end_without_return(part) for part in (orelse or body, *(h.body for h in handlers))
            )
        # A loop that ends with return has a slip of its own.
        case ast.For(body=body):
            return _may_end_without_return(body)
        case ast.While(test=ast.Constant(value=True)):
            return False
    return True


def _undeclared_names(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each comparison of a parameter, or of its name, that is never true."""
    declared = {
        name
        for node in ast.walk(cls)
        if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "declare_parameter"
        for argument in node.args[:1]
        if isinstance(argument, ast.Constant) and isinstance(name := argument.value, str)
    }
    is_checked = "_set_parameters_callback" in ast.unparse(cls)
    for node in ast.walk(cls):
        match node:
            case ast.Compare(
                left=ast.Attribute(attr="name"),
                ops=[ast.Eq()],
                comparators=[ast.Constant(value=str(name))],
            ) if declared and name not in declared:
                near = get_close_matches(name, declared, 1, 0.75)
                known = join_words(sorted(map(repr, declared)))
                if near:
                    yield f"{quote(node)} is never true: the parameter is declared as {near[0]!r}."
                elif is_checked:
                    yield f"{quote(node)} is never true: the node declares {known}."
            case ast.For(target=ast.Name(id=one), body=body):
                inner = [part for statement in body for part in ast.walk(statement)]
                uses = {
                    part.attr
                    for part in inner
                    if isinstance(part, ast.Attribute) and ast.unparse(part.value) == one
                }
                for part in inner:
                    match part:
                        case ast.Compare(
                            left=ast.Name(id=left), ops=[ast.Eq()], comparators=[ast.Constant(value=str())]
                        ) if left == one and uses & {"name", "value"}:
                            yield (
                                f"{quote(part)} is never true: {one} is a Parameter, and its name "
                                f"is {one}.name."
                            )


def _fields_of_node(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each field of a new message that is set on the node instead."""
    read = {
        node.attr
        for node in ast.walk(cls)
        if isinstance(node, ast.Attribute)
        and isinstance(node.ctx, ast.Load)
        and ast.unparse(node.value) == "self"
    }
    for function in cls.body:
        if not isinstance(function, Function) or function.name == "__init__":
            continue
        created = [
            found
            for node in ast.walk(function)
            if isinstance(node, ast.stmt) and (found := created_object(node))[0]
        ]
        for node in ast.walk(function):
            match node:
                case ast.Attribute(value=ast.Name(id="self"), attr=field, ctx=ast.Store()) if (
                    field not in read
                ):
                    owners = [name for name, kind in created if field in _fields_of(kind)]
                    if len(owners) == 1:
                        yield (
                            f"self.{field} = … sets an attribute of the node that nothing reads: "
                            f"is {owners[0]}.{field} meant?"
                        )


@cache
def _fields_of(kind: str) -> frozenset[str]:
    """Return the fields of all message types with a class of this name."""
    types = [name for name in type_names() if name.endswith(f"/msg/{kind}")]
    return frozenset(field.name for name in types for field in definition(name).fields)


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
                "outside of __init__: should both be the same attribute?"
            )


def _replaced_stamps(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a question for each callback that sets the stamp of the received message."""
    for function in callbacks_of(cls):
        names = [argument.arg for argument in function.args.args[1:2]]
        for node in ast.walk(function):
            match node:
                case ast.Assign(targets=[ast.Attribute() as target]) if any(
                    re.match(rf"{name}\.header\.stamp\b", ast.unparse(target)) for name in names
                ):
                    yield (
                        f"{quote(node)} replaces the time at which {names[0]} was made: is the old "
                        "one needed?"
                    )


def _unread_values(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each stored value of a plain node's callback that nothing reads."""
    if [ast.unparse(base) for base in cls.bases] != ["Node"]:
        return
    read = {
        node.attr
        for node in ast.walk(cls)
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load)
    }
    for function in callbacks_of(cls):
        for node in ast.walk(function):
            match node:
                case ast.Assign(
                    targets=[ast.Attribute(value=ast.Name(id="self"), attr=name)],
                    value=value,
                ) if name not in read and "(" not in ast.unparse(value):
                    yield f"{quote(node)} keeps a value that no line reads: is it used?"


def _uncalled_methods(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each method of a plain node that changes the node, and that nothing calls."""
    # Without any callback the node has a hint of its own.
    if [ast.unparse(base) for base in cls.bases] != ["Node"] or not list(callbacks_of(cls)):
        return
    used = {node.attr for node in ast.walk(cls) if isinstance(node, ast.Attribute)}
    for function in cls.body:
        if not isinstance(function, Function) or function.decorator_list:
            continue
        sets_attribute = any(
            isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store) and root_of(node) == "self"
            for node in ast.walk(function)
        )
        if sets_attribute and function.name not in used and not function.name.startswith(("__", "destroy_")):
            yield (
                f"{function.name} is never called: write self.{function.name}() where its lines should "
                "run, or pass it to create_timer, create_subscription or "
                "add_on_set_parameters_callback."
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
                    f"{quote(node)} replaces the method {name}, which cannot be called any more: "
                    "choose another name for one of them."
                )


def _repeated_timers(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for timers that add up: created in a callback, or two with one callback."""
    for function in callbacks_of(cls):
        calls = [node for node in ast.walk(function) if isinstance(node, ast.Call)]
        methods = {node.func.attr for node in calls if isinstance(node.func, ast.Attribute)}
        if "create_timer" in methods and not methods & {"destroy_timer", "cancel"}:
            yield (
                f"create_timer is in {function.name}: each call creates another timer, and all of "
                "them run. Create it once, in __init__, or destroy the old one first, with "
                "destroy_timer."
            )
    callbacks: Counter[str] = Counter()
    for node in ast.walk(cls):
        match node:
            case ast.Call(func=ast.Attribute(attr="create_timer"), args=[_, ast.Attribute() as callback, *_]):
                callbacks[ast.unparse(callback)] += 1
    for name, count in callbacks.items():
        if count > 1 and "destroy_timer" not in ast.unparse(cls):
            yield f"{count} timers call {name}, so that it runs {count} times: keep one of them."


_ENDINGS = {
    "destroy_node": "ends the node",
    "shutdown": "ends all nodes",
    "cancel": "ends the timer",
    "destroy_timer": "ends the timer",
    "destroy_publisher": "ends the publisher",
    "destroy_subscription": "ends the subscription",
}


def _early_ends(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each line that keeps a node from running or from publishing."""
    for function in [part for part in cls.body if isinstance(part, Function)]:
        for statement in function.body:
            match statement:
                case ast.Expr(
                    value=ast.Call(func=ast.Attribute(attr="destroy_node" | "shutdown" as name))
                ) if function.name == "__init__":
                    yield (
                        f"{quote(statement)} in __init__ {_ENDINGS[name]} before it has run: leave "
                        "it out. The program that spins the node calls it, after spin."
                    )
        for node in ast.walk(function):
            if isinstance(node, ast.If) and "get_subscription_count" in ast.unparse(node.test):
                yield (
                    f'"if {ast.unparse(node.test)}" waits for a subscription. During the check '
                    "nobody subscribes, and a viewer is not counted either: publish without this "
                    "condition."
                )
    for function in callbacks_of(cls):
        readings = {
            ast.unparse(node.targets[0])
            for node in ast.walk(function)
            if isinstance(node, ast.Assign) and re.search(r"\.now\(\)", ast.unparse(node.value))
            if isinstance(node.targets[0], ast.Name)
        }
        for node in ast.walk(function):
            match node:
                case ast.BinOp(left=left, op=ast.Sub(), right=right) if any(
                    uses(right, name) for name in readings
                ) and (".now()" in ast.unparse(left) or any(uses(left, name) for name in readings)):
                    yield (
                        f"{quote(node)} is the time since this call of {function.name} began. Read "
                        "the clock once in __init__, self.start = self.get_clock().now(), and "
                        "subtract that."
                    )


def _odd_tables(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each dictionary that is asked for keys of another kind than it has."""
    stored: dict[str, str] = {}
    asked: dict[str, str] = {}
    literals: dict[str, ast.Dict] = {}
    for node in ast.walk(cls):
        match node:
            case ast.Assign(targets=[target], value=ast.Dict() as literal):
                literals[ast.unparse(target)] = literal
            case ast.Subscript(value=ast.Attribute() as owner, slice=index, ctx=ast.Store()):
                stored.setdefault(ast.unparse(owner), ast.unparse(index))
            case ast.Compare(left=sought, ops=[ast.In() | ast.NotIn()], comparators=[owner]):
                asked.setdefault(ast.unparse(owner), ast.unparse(sought))
    for name, kept in stored.items():
        other = asked.get(name, kept)
        kinds = ("int", "str", "float")
        if any(kept == f"{kind}({other})" or other == f"{kind}({kept})" for kind in kinds):
            yield (
                f"{name} has keys like {kept}, and is asked for {other}: a number and a string are "
                "different keys. Use one of them in both places."
            )
    for name, table in literals.items():
        keys = [key.value for key in table.keys if isinstance(key, ast.Constant)]
        values = [value.value for value in table.values if isinstance(value, ast.Constant)]
        is_swapped = any(isinstance(key, float) and key % 1 for key in keys)
        if name in asked and is_swapped and all(type(value) is int for value in values) and values:
            shown = join_words([ast.unparse(key) for key in table.keys if key is not None])
            yield (
                f"{asked[name]} in {name} looks among the keys, which are {shown} here: in "
                "{key: value} the key comes first. Exchange keys and values."
            )


# Classes and methods that create a publisher.
_PUBLISHING = {"TransformBroadcaster", "StaticTransformBroadcaster", "create_publisher"}


def late_publishers(source: str) -> Iterator[str]:
    """Yield a remark on a publisher that a callback creates: ROS 2 loses its first messages."""
    for cls in ast.walk(parse(source)):
        for function in callbacks_of(cls) if isinstance(cls, ast.ClassDef) else ():
            for node in ast.walk(function):
                match node:
                    case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name in _PUBLISHING:
                        yield (
                            f"Here the checks accept {name}(…) in {function.name}. On ROS 2 a "
                            "new publisher needs a moment to find its subscriptions, and what "
                            "it sends before is lost: create it once, in __init__."
                        )
                        return


def _odd_callbacks(cls: ast.ClassDef) -> Iterator[str]:
    """Yield a sentence for each callback that is a generator, or ends its node, timer or publisher."""
    for function in callbacks_of(cls):
        if any(isinstance(node, ast.Yield | ast.YieldFrom) for node in ast.walk(function)):
            yield (
                f"yield makes {function.name} a generator, so that a call runs none of its lines: "
                "leave yield out."
            )
        if "create_timer" in ast.unparse(function):
            continue
        # A call in an if or a try is meant for a certain moment.
        for statement in function.body:
            match statement:
                case ast.Expr(value=ast.Call(func=ast.Attribute(attr=name))) if name in _ENDINGS:
                    yield (
                        f"{quote(statement)} in {function.name} {_ENDINGS[name]} when the "
                        "callback runs for the first time: leave it out."
                    )


def _method_slips(method: Function) -> Iterator[str]:
    """Yield a sentence for each slip in a method of a class, which callbacks of a node usually are."""
    if method.args.args[:1] and method.args.args[0].arg == "self":
        yield from _blocking_calls(method)
        yield from _waiting_loops(method)
        yield from _odd_node_calls(method)
        yield from _foreign_lookups(method)
        yield from _lost_counts(method)
        yield from _reset_attributes(method)


def _blocking_calls(function: Function) -> Iterator[str]:
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Name(id="time"), attr="sleep")):
                yield (
                    f"time.sleep in {function.name} stops the whole node: no other callback runs "
                    "before it ends. Use a timer."
                )
            case ast.Call(
                func=ast.Attribute(attr="wait_for_service" | "wait_for_server"), args=[], keywords=[]
            ) if function.name != "__init__":
                yield (
                    f"{quote(node)} in {function.name} stops the whole node until the server is "
                    "available: call service_is_ready() or server_is_ready(), and return if it is False."
                )
            case ast.Call(
                func=ast.Attribute(
                    value=ast.Name(id="rclpy"), attr="spin" | "spin_once" | "spin_until_future_complete"
                )
                | ast.Name(id="spin_for" | "run_live")
            ):
                yield (
                    f"{quote(node.func)} in {function.name} waits for callbacks, which cannot run "
                    "before this one returns: leave it out, because the node is already spinning."
                )


def _lost_counts(function: Function) -> Iterator[str]:
    """Yield a sentence for each local variable that is incremented as if the next call kept it."""
    shared = {
        name
        for node in ast.walk(function)
        if isinstance(node, ast.Global | ast.Nonlocal)
        for name in node.names
    }
    for index, statement in enumerate(function.body):
        match statement:
            case ast.AugAssign(target=ast.Name(id=name), value=ast.Constant() | ast.BinOp()) if (
                name not in shared and not any(uses(later, name) for later in function.body[index + 1 :])
            ):
                yield (
                    f"{quote(statement)} changes a local variable of {function.name}, which "
                    f"starts anew in the next call: keep the value in self.{name}."
                )


def _reset_attributes(function: Function) -> Iterator[str]:
    """Yield a sentence for each attribute that a callback sets to a number before it counts it up."""
    if function.name == "__init__":
        return
    for index, statement in enumerate(function.body):
        match statement:
            case ast.Assign(
                targets=[ast.Attribute(value=ast.Name(id="self")) as target],
                value=ast.Constant(value=int() | float() | None),
            ):
                attribute = ast.unparse(target)
            case _:
                continue
        for later in function.body[index + 1 :]:
            match later:
                case ast.AugAssign(target=counted) if ast.unparse(counted) == attribute:
                    pass
                case ast.Assign(targets=[ast.Tuple(elts=stored)], value=ast.Tuple(elts=read)) if (
                    attribute in map(ast.unparse, stored) and attribute in map(ast.unparse, read)
                ):
                    pass
                case ast.For() | ast.While() if uses_expression(later, attribute):
                    break
                case _:
                    continue
            yield (
                f"{quote(statement)} in {function.name} runs in each call, so that the value "
                "of the earlier call is lost: set it once, in __init__."
            )
            break


def _waiting_loops(function: Function) -> Iterator[str]:
    """Yield a sentence for each loop that waits for messages, which arrive only after the method ends."""
    for node in ast.walk(function):
        match node:
            case ast.While(test=ast.Constant() | ast.Compare()):
                continue
            case ast.While(test=test, body=body) if all(map(_is_wait, body)):
                yield (
                    f'"while {ast.unparse(test)}" in {function.name} waits for messages, but the node '
                    "receives none before the method ends: check once, with if, and return if it "
                    "is too early."
                )


def _is_wait(statement: ast.stmt) -> bool:
    match statement:
        case ast.Pass() | ast.Continue() | ast.Expr(value=ast.Constant()):
            return True
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr="sleep" | "info" | "warn" | "warning"))):
            return True
    return False


def _odd_node_calls(function: Function) -> Iterator[str]:
    """Yield a sentence for each call of a method that has a better counterpart in ROS, or other arguments.

    A lookup at the present time is too early: no transform has reached it.
    """
    for node in ast.walk(function):
        match node:
            case ast.Call(
                func=ast.Attribute(attr="lookup_transform" | "can_transform" as method),
                args=[_, _, time],
                keywords=[],
            ) if re.search(r"\.now\(\)(\.to_msg\(\))?$", ast.unparse(time)):
                yield (
                    f"{ast.unparse(time)} in {method} is later than the last transform "
                    "that has arrived: pass the stamp of a message, or Time() for the newest "
                    "transform."
                )
            case ast.Call(func=ast.Attribute(attr="create_timer" | "create_subscription"), args=args):
                for argument in args:
                    if isinstance(argument, ast.Lambda) and isinstance(argument.body, ast.Attribute):
                        name = ast.unparse(argument.body)
                        yield f"{quote(argument)} does not call {argument.body.attr}: pass {name} alone."
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id="threading"), attr="Timer" | "Thread")
                | ast.Name(id="Timer" | "Thread")
            ):
                yield (
                    f"{quote(node)} calls its function once, by the wall clock. A timer of the "
                    "node calls it repeatedly: self.create_timer(period, function)."
                )


def _foreign_lookups(function: Function) -> Iterator[str]:
    """Yield a sentence for each lookup for a message that ignores the message's frame or stamp."""
    given = {argument.arg for argument in function.args.args[1:]}
    moved = {
        node.args[0].id
        for node in ast.walk(function)
        if isinstance(node, ast.Call) and "do_transform_" in ast.unparse(node.func)
        if node.args and isinstance(node.args[0], ast.Name)
    }
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(attr="lookup_transform"), args=[target, source, time, *_]) if (
                given & moved and "header" not in ast.unparse(target)
            ):
                header = f"{min(given & moved)}.header"
                if isinstance(source, ast.Constant):
                    yield (
                        f"lookup_transform has the fixed frame {source.value!r}, and a message may "
                        f"be in another one: pass {header}.frame_id."
                    )
                if re.fullmatch(r"(\w+\.)*Time\(\)", ast.unparse(time)):
                    yield (
                        f"{ast.unparse(time)} in lookup_transform requests the newest transform. "
                        f"The message was stamped earlier: pass {header}.stamp."
                    )
