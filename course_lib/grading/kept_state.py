"""State that code keeps between calls although each call needs its own, such as a list that grows."""

import ast
import builtins
from collections.abc import Iterator

from course_lib.grading.node_slips import callbacks_of, pairs_of
from course_lib.grading.slips import Function, emptied_names, parse, quote

_GROWING = {"append", "extend", "insert", "add", "update", "setdefault", "appendleft"}
_SHORTENING = {"clear", "pop", "popleft", "remove"}


def find_growing_list(source: str, *, is_certain: bool = False) -> str:
    """Return a sentence about a list that grows with each call of a callback or a function, or "".

    Args:
        source: The student's code.
        is_certain: Whether to report only lists of which each call needs a new one: those that
            get several items in one call, and those of functions. A node may remember one item of
            each call on purpose.
    """
    tree = parse(source)
    for outer in ast.walk(tree):
        if isinstance(outer, ast.ClassDef):
            owners = _created_lists(outer)
            for function in callbacks_of(outer):
                for slip in (
                    *_growing(outer, function, owners, is_certain=is_certain),
                    *_kept_entries(outer, function),
                    *_taken_items(outer, function),
                ):
                    return slip
    for function in getattr(tree, "body", ()):
        if isinstance(function, Function):
            for slip in (*_kept_containers(function), *_kept_globals(function)):
                return slip
    return ""


def _created_lists(cls: ast.ClassDef) -> set[str]:
    """Return the attributes that a class sets to an empty list, or to an object that may hold lists."""
    # A list in the body of the class is a single one for all its objects.
    in_body = [name for part in cls.body if isinstance(part, ast.Assign) for name in emptied_names(part)]
    created = {f"{owner}.{name}" for name in in_body for owner in ("self", cls.name)}
    for node in ast.walk(cls):
        if not isinstance(node, ast.Assign):
            continue
        for target, value in pairs_of(node):
            match target, value:
                case ast.Attribute(value=ast.Name(id="self")), ast.List(elts=[]):
                    created.add(ast.unparse(target))
                case ast.Attribute(value=ast.Name(id="self")), ast.Call(func=ast.Name(id=kind), args=[]) if (
                    kind[0].isupper() or not value.keywords
                ):
                    created.add(ast.unparse(target))
    return created


def _growing(cls: ast.ClassDef, function: Function, owners: set[str], *, is_certain: bool) -> Iterator[str]:
    """Yield a sentence for each list to which a callback adds items without end."""
    aliases = _aliases(function)
    free = _free_names(function)
    in_loops = {
        id(part)
        for loop in ast.walk(function)
        if isinstance(loop, ast.For | ast.While)
        for part in ast.walk(loop)
    }
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(value=grown, attr="append" | "extend" as method)):
                is_several = method == "extend" or id(node) in in_loops
            case ast.AugAssign(target=ast.Attribute() | ast.Name() as grown, op=ast.Add(), value=value) if (
                isinstance(value, ast.List | ast.ListComp | ast.Name | ast.Subscript)
            ):
                is_several = not isinstance(value, ast.List) or len(value.elts) > 1 or id(node) in in_loops
                # `total += x` adds up numbers, so nothing grows.
                if isinstance(value, ast.Name | ast.Subscript) and _resolve(grown, aliases) not in owners:
                    continue
            case _:
                continue
        items = _resolve(grown, aliases)
        owner = ".".join(items.split(".")[:2])
        if is_certain and not is_several:
            # The first item is one that an earlier call added, so a function that reads it is wrong.
            read = (ast.unparse(part) for part in ast.walk(function) if isinstance(part, ast.Subscript))
            if f"{items}[0]" not in read:
                continue
        if owner in owners and not _is_shortened(cls, items, owner):
            yield (
                f"{items} keeps the items of each earlier call of {function.name}: empty it there "
                "first, or create a new list in each call."
            )
        elif items in free and not _is_shortened(function, items, items):
            yield (
                f"{items} is outside of {function.name} and keeps the items of each earlier call: "
                f"create a new list in {function.name}."
            )


def _kept_entries(cls: ast.ClassDef, function: Function) -> Iterator[str]:
    """Yield a sentence for each dictionary that a callback fills, reads as a whole, and never empties."""
    used = {ast.unparse(node) for node in ast.walk(cls) if isinstance(node, ast.Attribute)}
    removed = {ast.unparse(node) for node in ast.walk(cls) if isinstance(node, ast.Delete)}
    for node in ast.walk(function):
        match node:
            case ast.Assign(targets=[ast.Subscript(value=ast.Attribute() | ast.Name() as filled)]):
                items = ast.unparse(filled)
            case _:
                continue
        is_replaced = any(
            ast.unparse(target) == items
            for node in ast.walk(function)
            if isinstance(node, ast.Assign)
            for target in node.targets
        )
        is_kept = items.startswith("self.") or items in _free_names(function)
        is_read = f"{items}.values" in used
        is_emptied = any(f"{items}.{method}" in used for method in _SHORTENING) or any(
            statement.startswith(f"del {items}[") for statement in removed
        )
        if is_kept and is_read and not is_replaced and not is_emptied:
            yield (
                f"{items} keeps the entries of each earlier call of {function.name}: create a new "
                "dictionary in each call, or remove what is no longer there."
            )


def _taken_items(cls: ast.ClassDef, function: Function) -> Iterator[str]:
    """Yield a sentence for each list outside of a callback from which each call takes items."""
    free = _free_names(function)
    used = {ast.unparse(node) for node in ast.walk(cls) if isinstance(node, ast.Attribute)}
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr="pop" | "remove" | "clear")) if (
                name in free and not any(f"{name}.{method}" in used for method in _GROWING)
            ):
                yield (
                    f"{quote(node)} takes items out of {name}, which is outside of "
                    f"{function.name}: the next call has fewer of them. Work with a copy, "
                    f"list({name})."
                )


def _aliases(function: Function) -> dict[str, str]:
    """Return the variables that are another name of an attribute of self, as in `items = self.items`."""
    aliases: dict[str, str] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.Assign):
            for target, value in pairs_of(node):
                match target, value:
                    case ast.Name(id=name), ast.Attribute():
                        aliases[name] = ast.unparse(value)
                    case ast.Name(id=name), ast.Name(id=other):
                        aliases[name] = other
                    case ast.Name(id=name), _:
                        aliases.pop(name, None)
    return aliases


def _resolve(node: ast.AST, aliases: dict[str, str]) -> str:
    """Return the source of an expression, with an alias at its beginning replaced by its attribute."""
    root, dot, rest = ast.unparse(node).partition(".")
    return aliases.get(root, root) + dot + rest


def _free_names(function: Function) -> set[str]:
    """Return the names that a function and its inner functions read and do not set."""
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
    declared = {name for node in ast.walk(function) if isinstance(node, ast.Global) for name in node.names}
    local = {node.id for node in names if isinstance(node.ctx, ast.Store)} - declared
    local |= {node.arg for node in ast.walk(function) if isinstance(node, ast.arg)}
    local |= {node.name for node in ast.walk(function) if isinstance(node, Function)}
    return {node.id for node in names} - local - set(dir(builtins))


def _is_shortened(scope: ast.ClassDef | Function, items: str, owner: str) -> bool:
    """Return whether a class, outside of __init__, or a function shortens or replaces a list."""
    functions = (
        [scope]
        if isinstance(scope, Function)
        else [part for part in scope.body if isinstance(part, Function)]
    )
    for function in functions:
        if function.name == "__init__":
            continue
        aliases = _aliases(function)
        # += stores a list, and extends it.
        longer = [node.target for node in ast.walk(function) if isinstance(node, ast.AugAssign)]
        for node in ast.walk(function):
            match node:
                case ast.Call(func=ast.Attribute(value=changed, attr=method)) if method in _SHORTENING:
                    pass
                case (
                    ast.Name(ctx=ast.Store() | ast.Del())
                    | ast.Attribute(ctx=ast.Store() | ast.Del()) as changed
                ) if changed not in longer:
                    if ast.unparse(changed) in (items, owner):
                        return True
                    continue
                case ast.Subscript(value=changed, slice=ast.Slice()):
                    pass
                case ast.Subscript(value=changed, ctx=ast.Store() | ast.Del()):
                    pass
                case _:
                    continue
            if _resolve(changed, aliases) in (items, owner):
                return True
    return False


def _kept_containers(function: Function) -> Iterator[str]:
    """Yield a sentence for each list or dictionary outside of a function that the function fills."""
    free = _free_names(function)
    used = {ast.unparse(node) for node in ast.walk(function) if isinstance(node, ast.Attribute)}
    for node in ast.walk(function):
        match node:
            case ast.Expr(value=ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr=method))) if (
                method in _GROWING
            ):
                pass
            case ast.Assign(targets=[ast.Subscript(value=ast.Name(id=name))]):
                pass
            case _:
                continue
        if name in free and not any(f"{name}.{method}" in used for method in _SHORTENING):
            yield (
                f"{name} is outside of {function.name} and keeps what each earlier call put into "
                f"it: create it in {function.name}."
            )


def _kept_globals(function: Function) -> Iterator[str]:
    """Yield a sentence for each global variable that a function reads and then changes."""
    declared = [name for node in ast.walk(function) if isinstance(node, ast.Global) for name in node.names]
    for name in declared:
        for statement in function.body:
            uses = [node for node in ast.walk(statement) if isinstance(node, ast.Name) and node.id == name]
            is_set = isinstance(statement, ast.Assign) and not any(
                isinstance(node.ctx, ast.Load) for node in uses
            )
            if uses and is_set:
                break
            if uses:
                yield (
                    f"global keeps {name} between the calls of {function.name}, which begins with "
                    f"the value of the call before: set {name} in {function.name} first."
                )
                break
