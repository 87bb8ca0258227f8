"""Slips with numbers, units and arrays that raise no error, found in the syntax tree of a student's code."""

import ast
import math
import re
from collections.abc import Iterator

from course_lib.grading.slips import Function, quote, uses

_INTEGER_TYPE = re.compile(r"(np\.|numpy\.|['\"])?u?int(8|16|32|64)?(['\"])?|np\.integer")
_FILLED = {"zeros", "ones", "empty", "full", "eye", "arange", "zeros_like", "ones_like", "empty_like"}
_NANO = {1e9, 1e-9}
_LONG_AGO = 1e6  # [s]


def number_slips(function: Function) -> Iterator[str]:
    """Yield a sentence for each slip with a number, a unit or an array in a function."""
    yield from _item_products(function)
    yield from _odd_conditions(function)
    yield from _wrong_angles(function)
    yield from _integer_quotients(function)
    yield from _cut_quotients(function)
    yield from _integer_arrays(function)
    yield from _nanoseconds(function)
    yield from _whole_seconds(function)
    yield from _short_periods(function)
    yield from _quaternions(function)
    yield from _comparisons_with_nan(function)
    yield from _products_of_zero(function)
    yield from _added_letters(function)
    yield from _filtered_indices(function)
    yield from _absolute_times(function)
    yield from _covered_limits(function)
    yield from _odd_selections(function)


def _wrong_angles(function: Function) -> Iterator[str]:
    """Yield a sentence for each angle in degrees where a function takes radians."""
    in_degrees = {
        target.id
        for node in ast.walk(function)
        if isinstance(node, ast.Assign)
        if _is_conversion(node.value) or _is_share_of_360(node.value)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(attr="sin" | "cos" | "tan" as name), args=[value]) if named := [
                part.id
                for part in ast.walk(value)
                if isinstance(part, ast.Name) and part.id in in_degrees | _DEGREES
            ]:
                if not re.search(r"\b(radians|deg2rad)\(", ast.unparse(value)):
                    yield f"{quote(node)}: {name} takes radians, and {named[0]} is in degrees."
            case ast.Call(func=ast.Attribute(attr="sin" | "cos" | "tan" as name), args=[argument]) if any(
                map(_is_conversion, ast.walk(argument))
            ):
                yield f"{quote(node)}: {name} takes radians, so leave out the conversion to degrees."
            case ast.Call(
                func=ast.Attribute(attr="sin" | "cos" as name),
                args=[share],
            ) if _is_share_of_360(share):
                yield f"{quote(node)}: {name} takes radians: a full turn is 2 * math.pi."
            case ast.Call(
                func=ast.Attribute(attr="radians" | "deg2rad" as name),
                args=[angle],
            ) if re.search(r"\b(math|np)\.(pi|tau)\b", ast.unparse(angle)):
                yield f"{quote(node)}: an angle with pi is in radians already: leave out {name}( )."
            case ast.Assign(
                targets=[ast.Name(id=name)],
                value=ast.Call(func=ast.Attribute(attr="radians"), args=[ast.Name(id=angle)]),
            ) if name == angle and name in _ANGLES & {one.arg for one in function.args.args}:
                yield f"{quote(node)}: angles are in radians here: is this one in degrees?"
            case ast.BinOp(
                left=ast.Name(id=name) | ast.Attribute(attr=name),
                op=ast.Add() | ast.Sub() | ast.Mod(),
                right=ast.Constant() as degrees,
            ) if name in _ANGLES and (turn := _TURNS.get(ast.unparse(degrees))):
                yield f"{quote(node)}: angles are in radians here, and {ast.unparse(degrees)}° is {turn}."


def _is_conversion(node: ast.AST) -> bool:
    """Return whether an expression is a call that converts an angle to degrees."""
    return isinstance(node, ast.Call) and getattr(node.func, "attr", "") in ("degrees", "rad2deg")


def _is_share_of_360(node: ast.AST) -> bool:
    """Return whether an expression is a product or quotient with 360 that remains in degrees."""
    text = ast.unparse(node)
    has_turn = any(isinstance(part, ast.Constant) and part.value == 360 for part in ast.walk(node))
    is_product = isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div)
    return is_product and has_turn and not re.search(r"\bpi\b|tau|radians|deg2rad", text)


# Usual names of angles in degrees.
_DEGREES = {"degrees", "deg", "angle_deg", "yaw_deg", "heading_deg", "degree"}
_ANGLES = {"angle", "yaw", "heading", "theta", "turn", "first", "second", "lift", "elbow"}
_TURNS = {
    **dict.fromkeys(("90", "90.0"), "math.pi / 2"),
    **dict.fromkeys(("180", "180.0"), "math.pi"),
    **dict.fromkeys(("360", "360.0"), "2 * math.pi"),
}


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
        whole |= {id(part) for node in inner for part in ast.walk(node)}
    for node in ast.walk(function):
        match node:
            case ast.BinOp(op=ast.FloorDiv()) if id(node) not in whole:
                yield f"{quote(node)} leaves out the fraction: is a whole number meant? / divides."


def _cut_quotients(function: Function) -> Iterator[str]:
    """Yield a question about int( ) or round( ) of a quotient that is returned or assigned."""
    for node in ast.walk(function):
        match node:
            case ast.Assign(
                targets=[ast.Name(id=name)],
                value=ast.Call(func=ast.Name(id="int" | "round" as cut), args=[argument]),
            ):
                is_fraction = any(isinstance(part, ast.Div) for part in ast.walk(argument))
                match argument:
                    # A product with a fraction, like steps * 0.02.
                    case ast.BinOp(op=ast.Mult(), left=left, right=right):
                        numbers = [
                            factor.value for factor in (left, right) if isinstance(factor, ast.Constant)
                        ]
                        is_fraction |= any(isinstance(number, float) and number % 1 for number in numbers)
                places = [inner for other in ast.walk(function) for inner in _integer_operands(other)]
                if is_fraction and not any(uses(place, name) for place in places):
                    yield f"{cut}( ) leaves out the fraction of {name}: is a whole number meant?"
            case ast.Return(value=ast.expr() as returned):
                for item in getattr(returned, "elts", [returned]):
                    match item:
                        case ast.Call(
                            func=ast.Name(id="round") | ast.Attribute(attr="round" | "around"),
                            args=[_, *_],
                        ):
                            yield f"{quote(item)} leaves out digits: return the number itself."
            case ast.Call(
                func=ast.Attribute(attr="create_timer"),
                args=[
                    ast.Call(
                        func=ast.Name(id="int" | "round" as cut),
                        args=[period],
                    ) as whole,
                    *_,
                ],
            ) if any(isinstance(part, ast.Div) for part in ast.walk(period)):
                yield f"{quote(whole)} makes a period below 1 s 0: leave out {cut}( )."
            case ast.Call(
                func=ast.Name(id="int"),
                args=[ast.BinOp(op=ast.Mult(), right=ast.Constant(value=1000))],
            ):
                yield f"{quote(node)} cuts 99.7 off to 99: round( ) gives the nearest whole number."


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


def _integer_arrays(function: Function) -> Iterator[str]:
    """Yield a sentence for each array of integers that cuts off the fractions of numbers."""
    created: dict[str, str] = {}
    parameters = [argument.arg for argument in function.args.args]
    for node in ast.walk(function):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call) if _has_integers(call):
                created[name] = ast.unparse(call)
    for node in ast.walk(function):
        match node:
            case ast.Assign(targets=targets, value=value) if _may_be_fraction(value) or (
                isinstance(value, ast.Name) and value.id in parameters
            ):
                parts = [part for target in targets for part in getattr(target, "elts", [target])]
                for part in parts:
                    match part:
                        case ast.Subscript(value=ast.Name(id=name)) if name in created:
                            yield (
                                f"{name} has whole numbers only, because of {created[name]}, and "
                                "cuts off fractions: write 0.0 for 0, or dtype=float."
                            )
            case ast.Call() if _cuts_values(node) and not _is_index(function, node):
                yield f"{quote(node)} cuts off the fraction of each number: leave out the integer type."


def _has_integers(call: ast.Call) -> bool:
    """Return whether a call creates an array of integers, as np.array([0, 0]) does."""
    match call:
        case ast.Call(
            func=ast.Attribute(attr="array" | "asarray"), args=[ast.List() | ast.Tuple() as items, *_]
        ):
            numbers = [node for node in ast.walk(items) if isinstance(node, ast.Constant)]
            has_names = any(isinstance(node, ast.Name | ast.Call) for node in ast.walk(items))
            whole = bool(numbers) and all(type(number.value) is int for number in numbers) and not has_names
            has_type = len(call.args) > 1 or any(keyword.arg == "dtype" for keyword in call.keywords)
            return _has_integer_type(call) or (whole and not has_type)
        case ast.Call(func=ast.Attribute(attr=name)) if name in _FILLED:
            return _has_integer_type(call)
    return False


def _has_integer_type(call: ast.Call) -> bool:
    """Return whether a call passes an integer type."""
    passed = [*call.args[1:], *(keyword.value for keyword in call.keywords if keyword.arg == "dtype")]
    return any(_INTEGER_TYPE.fullmatch(ast.unparse(argument)) for argument in passed)


def _may_be_fraction(value: ast.expr) -> bool:
    """Return whether a value is computed and not certain to be an integer."""
    match value:
        case ast.Constant(value=number):
            return type(number) is float and number != int(number)
        case ast.Name() | ast.Subscript():
            return False
        case ast.Call(func=ast.Name(id="int" | "len" | "round" | "ord")):
            return False
        case ast.Tuple(elts=items) | ast.List(elts=items):
            return any(map(_may_be_fraction, items))
    parts = list(ast.walk(value))
    return any(
        isinstance(part, ast.Div | ast.Attribute)
        or (isinstance(part, ast.Constant) and isinstance(part.value, float))
        or (isinstance(part, ast.BinOp) and not isinstance(part.op, ast.FloorDiv | ast.Mod))
        for part in parts
    )


def _cuts_values(call: ast.Call) -> bool:
    """Return whether a call converts other numbers to integers, as .astype(int) does."""
    match call:
        case ast.Call(func=ast.Attribute(attr="astype"), args=[kind]):
            # uint8 is the type of images, whose values are whole numbers.
            return bool(_INTEGER_TYPE.fullmatch(ast.unparse(kind))) and "uint8" not in ast.unparse(kind)
        case ast.Call(
            func=ast.Attribute(attr="array" | "asarray"), args=[ast.List() | ast.Tuple() as items, *_]
        ):
            return _has_integer_type(call) and any(map(_may_be_fraction, items.elts))
        case ast.Call(func=ast.Attribute(attr="array" | "asarray"), args=[_, *_]):
            return _has_integer_type(call) and "uint8" not in ast.unparse(call)
    return False


def _is_index(function: Function, call: ast.Call) -> bool:
    """Return whether the result of a call is an index, or is assigned to a variable that is one."""
    names = {
        name.id
        for node in ast.walk(function)
        if isinstance(node, ast.Assign) and any(part is call for part in ast.walk(node.value))
        for target in node.targets
        for name in ast.walk(target)
        if isinstance(name, ast.Name)
    }
    return any(
        part is call or (isinstance(part, ast.Name) and part.id in names)
        for node in ast.walk(function)
        for inner in _integer_operands(node)
        for part in ast.walk(inner)
    )


def _nanoseconds(function: Function) -> Iterator[str]:
    """Yield a sentence for each number of nanoseconds that is used as a number of seconds."""
    numbers = [node.value for node in ast.walk(function) if isinstance(node, ast.Constant)]
    is_converted = any(type(n) in (int, float) and n in _NANO for n in numbers) or any(
        ast.unparse(node) == "10 ** 9" for node in ast.walk(function) if isinstance(node, ast.BinOp)
    )
    if is_converted:
        return
    for node in ast.walk(function):
        match node:
            case ast.BinOp(op=ast.Add(), left=left, right=right) if _ends_with(left, "sec") and any(
                _ends_with(node, "nanosec") for node in ast.walk(right)
            ):
                yield (
                    f"{quote(node)} is not a number of seconds: nanosec counts billionths, so "
                    f"write {ast.unparse(left)} + {ast.unparse(left).removesuffix('sec')}nanosec "
                    "/ 1e9."
                )
    kept = {
        ast.unparse(target)
        for node in ast.walk(function)
        if isinstance(node, ast.Assign)
        and any(_ends_with(part, "nanoseconds") for part in ast.walk(node.value))
        for target in node.targets
    }
    for node in ast.walk(function):
        match node:
            case ast.BinOp(op=ast.Mult() | ast.Div()):
                for part in ast.walk(node):
                    if _ends_with(part, "nanoseconds") or (
                        isinstance(part, ast.Name | ast.Attribute) and ast.unparse(part) in kept
                    ):
                        yield f"{ast.unparse(part)} counts nanoseconds: / 1e9 converts it to seconds."
                        return


def _whole_seconds(function: Function) -> Iterator[str]:
    """Yield a sentence for each time in a calculation of which only the whole seconds are read."""
    if any(_ends_with(node, "nanosec") for node in ast.walk(function)):
        return
    for node in ast.walk(function):
        match node:
            case ast.BinOp(left=left, right=right):
                operands = [left, right]
            case ast.Assign(value=value):
                operands = [value]
            case _:
                continue
        for time in operands:
            is_item = isinstance(time, ast.Subscript)
            if _ends_with(time, "sec") or (
                is_item and ast.unparse(time).endswith("seconds_nanoseconds()[0]")
            ):
                yield (
                    f"{quote(time)} has no fraction of a second: add the nanoseconds / 1e9. A clock "
                    "gives both by now().nanoseconds / 1e9."
                )


def _short_periods(function: Function) -> Iterator[str]:
    """Yield a sentence for each period of 0, or in seconds where nanoseconds are expected."""
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(attr="create_timer"), args=[ast.Constant(value=0), *_]):
                yield (
                    f"{quote(node)} has the period 0, and calls as often as it can: a period is in "
                    "seconds, 0.1 for 10 times a second."
                )
            case ast.Assign(targets=[ast.Attribute(attr="timer_period_ns")], value=value) if not (
                # A variable may already be in nanoseconds.
                isinstance(value, ast.Name)
                or any(
                    isinstance(part, ast.Constant)
                    and isinstance(part.value, int | float)
                    and part.value >= 1e3
                    for part in ast.walk(value)
                )
                or re.search(r"_ns\b|nanoseconds|NS\b|\*\*", ast.unparse(value))
            ):
                yield f"{quote(node)}: in nanoseconds this is int(({ast.unparse(value)}) * 1e9)."


def _comparisons_with_nan(function: Function) -> Iterator[str]:
    for node in ast.walk(function):
        match node:
            case ast.Compare(left=left, ops=[ast.Eq() | ast.NotEq() as operator], comparators=[right]) if (
                names := {ast.unparse(left), ast.unparse(right)} & {"math.nan", "np.nan"}
            ):
                result = "never" if isinstance(operator, ast.Eq) else "always"
                other = ast.unparse(right if ast.unparse(left) in names else left)
                yield f"{quote(node)} is {result} true. Use math.isnan({other})."


def _products_of_zero(function: Function) -> Iterator[str]:
    """Yield a sentence for each product that begins with zeros and therefore stays zero."""
    zeros = {
        target.id: node
        for node in function.body
        if isinstance(node, ast.Assign) and re.match(r"0$|0\.0$|np\.zeros", ast.unparse(node.value))
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    for node in ast.walk(function):
        match node:
            case ast.AugAssign(target=ast.Name(id=name), op=ast.Mult() | ast.MatMult()):
                pass
            case ast.Assign(
                targets=[ast.Name(id=name)],
                value=ast.BinOp(op=ast.Mult() | ast.MatMult()) as product,
            ) if uses(product, name):
                pass
            case _:
                continue
        if name in zeros:
            first = "np.eye" if "zeros" in ast.unparse(zeros[name]) else "1.0"
            yield f"{quote(zeros[name])}: a product that begins with 0 stays 0. Begin with {first}."


def _added_letters(function: Function) -> Iterator[str]:
    """Yield a sentence for each string that += adds to a list letter by letter."""
    lists = {
        ast.unparse(target)
        for node in ast.walk(function)
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.List | ast.ListComp)
        for target in node.targets
    }
    for node in ast.walk(function):
        match node:
            case ast.AugAssign(target=target, op=ast.Add(), value=ast.Constant(value=str())) if (
                ast.unparse(target) in lists
            ):
                yield (
                    f"{quote(node)} adds each letter of the string as an item: write "
                    f"{ast.unparse(target)}.append({ast.unparse(node.value)})."
                )


def _quaternions(function: Function) -> Iterator[str]:
    """Yield a sentence for each quaternion in another order than x, y, z, w, or with an angle."""
    for node in ast.walk(function):
        match node:
            case ast.Assign(targets=[ast.Tuple(elts=[ast.Attribute(attr="w"), *rest])], value=value) if [
                getattr(part, "attr", "") for part in rest
            ] == ["x", "y", "z"] and not isinstance(value, ast.Tuple | ast.List):
                yield f"{quote(node)}: the order of ROS is x, y, z, w: put w last on the left."
            case ast.Assign(targets=[ast.Attribute(value=owner, attr="z")], value=ast.Name(id=angle)) if (
                angle in _ANGLES and re.search(r"(orientation|rotation)$", ast.unparse(owner))
            ):
                yield (
                    f"{quote(node)}: a quaternion has no angle in z. A turn by {angle} about z is "
                    f"z = math.sin({angle} / 2), w = math.cos({angle} / 2)."
                )
            case ast.Assign(
                targets=[ast.Attribute(value=owner, attr="z" | "w")],
                value=ast.BinOp(
                    left=ast.Call(func=ast.Attribute(attr="sin" | "cos" as name), args=[argument]),
                    op=ast.Div(),
                    right=ast.Constant(value=2),
                ),
            ) if re.search(r"(orientation|rotation)$", ast.unparse(owner)):
                yield (
                    f"{quote(node)} divides the {name} by 2: a quaternion needs half of the angle, "
                    f"math.{name}({ast.unparse(argument)} / 2)."
                )


def _ends_with(node: ast.AST, field: str) -> bool:
    return isinstance(node, ast.Attribute) and node.attr == field


def _filtered_indices(function: Function) -> Iterator[str]:
    """Yield a sentence for an index in a list of selected beams that is used as the number of a beam."""
    if not any(_ends_with(node, "angle_increment") for node in ast.walk(function)):
        return
    chosen = set()
    for node in ast.walk(function):
        match node:
            case ast.Assign(
                targets=[ast.Name(id=name)],
                value=ast.ListComp(
                    elt=ast.Name(id=item),
                    generators=[ast.comprehension(target=ast.Name(id=other), ifs=[_, *_])],
                ),
            ) if item == other:
                chosen.add(name)
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Subscript(slice=mask)) if any(
                isinstance(node, ast.Compare) for node in ast.walk(mask)
            ):
                chosen.add(name)
    for node in ast.walk(function):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Name(id="np"), attr=method), args=[ast.Name(id=name)]):
                pass
            case ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr=method)):
                pass
            case _:
                continue
        if name in chosen and method in ("index", "argmin", "nanargmin"):
            yield (
                f"{quote(node)} is an index in {name}, the selected beams, but the angle needs the "
                "index in all beams: enumerate(message.ranges) yields it with each distance."
            )


def _absolute_times(function: Function) -> Iterator[str]:
    """Yield a sentence for each time since 1970 that is compared with a few seconds."""
    times = {
        ast.unparse(node.targets[0])
        for node in ast.walk(function)
        if isinstance(node, ast.Assign)
        and re.search(r"\bnow\(\)\.(nanoseconds|to_msg\(\)\.sec)|\btime\.time\(\)", ast.unparse(node.value))
        and not any(isinstance(part, ast.Sub | ast.Mod) for part in ast.walk(node.value))
    }
    subtracted = {
        ast.unparse(part)
        for node in ast.walk(function)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub | ast.Mod)
        for part in ast.walk(node)
        if isinstance(part, ast.Name | ast.Attribute)
    }
    tables = {
        node.targets[0].id: node.value
        for node in ast.walk(function)
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }
    for node in ast.walk(function):
        match node:
            case ast.Compare(left=left, comparators=[limit]) if (
                name := ast.unparse(left)
            ) in times - subtracted:
                value = tables.get(limit.id, limit) if isinstance(limit, ast.Name) else limit
                numbers = [part.value for part in ast.walk(value) if isinstance(part, ast.Constant)]
                if numbers and all(isinstance(n, int | float) and n < _LONG_AGO for n in numbers):
                    yield (
                        f"{name} counts from 1970 and is never as small as in {quote(node)}: "
                        "subtract the time of the start, which __init__ stores."
                    )


def _covered_limits(function: Function) -> Iterator[str]:
    """Yield a sentence for each condition that is never true after a wider one."""
    for node in ast.walk(function):
        block = getattr(node, "body", None)
        conditions: list[ast.Compare] = []
        for statement in block if isinstance(block, list) else []:
            match statement:
                case ast.If(test=ast.Compare(ops=[_], comparators=[_]) as test):
                    wider = [condition for condition in conditions if _is_wider(condition, test)]
                    if wider:
                        yield (
                            f"{quote(test)} is never true here, because {quote(wider[0])} before "
                            "it already returns for these numbers: put the narrower condition "
                            "first."
                        )
                    if isinstance(statement.body[-1], ast.Return | ast.Raise | ast.Continue):
                        conditions.append(test)
                case ast.If() | ast.Expr():
                    pass
                case _:
                    conditions = []


def _is_wider(wider: ast.Compare, other: ast.Compare) -> bool:
    """Return whether one comparison with a number is true whenever another one is."""
    limits = [comparison.comparators[0] for comparison in (wider, other)]
    if ast.unparse(wider.left) != ast.unparse(other.left) or not all(
        isinstance(limit, ast.Constant) and type(limit.value) in (int, float) for limit in limits
    ):
        return False
    first, second = (limit.value for limit in limits if isinstance(limit, ast.Constant))
    match wider.ops[0], other.ops[0]:
        case (ast.Lt(), ast.Lt()) | (ast.LtE(), ast.Lt() | ast.LtE()):
            return bool(first >= second)  # type: ignore[operator]  # both are numbers
        case (ast.Gt(), ast.Gt()) | (ast.GtE(), ast.Gt() | ast.GtE()):
            return bool(first <= second)  # type: ignore[operator]  # both are numbers
    return False


def _item_products(function: Function) -> Iterator[str]:
    """Yield a sentence for each product or sum of a matrix that is computed element by element."""
    matrices = [
        ast.unparse(node.targets[0])
        for node in ast.walk(function)
        if isinstance(node, ast.Assign) and ast.unparse(node.value).startswith("np.eye(")
    ]
    for node in ast.walk(function):
        match node:
            case ast.BinOp(left=ast.Name(id=name), op=ast.Mult(), right=ast.Call()) if name in matrices:
                yield f"{quote(node)} multiplies item by item: @ multiplies matrices."
            case ast.Call(func=ast.Attribute(attr="multiply"), args=[ast.Name(id=name), other]) if (
                name in matrices
            ):
                yield f"np.multiply multiplies item by item: write {name} @ {ast.unparse(other)}."
            case ast.AugAssign(
                target=ast.Name(id=name), op=ast.Add() | ast.Mult(), value=ast.BinOp(op=ast.MatMult())
            ) if name in matrices:
                product = f"{name} = {name} @ …"
                yield f"{quote(node)} combines item by item: transforms are multiplied, {product}."


def _odd_conditions(function: Function) -> Iterator[str]:
    """Yield a sentence for each condition that is true, or false, for all values, and for odd operators."""
    for node in ast.walk(function):
        match node:
            case ast.BinOp(left=ast.Constant(value=1), op=ast.FloorDiv()):
                yield f"{quote(node)} is 0 for every number above 1: / divides, // leaves out the fraction."
            case ast.Compare(
                ops=[ast.Is() | ast.IsNot() as operator], comparators=[ast.Constant(value=value)]
            ) if isinstance(value, str | int | float) and not isinstance(value, bool):
                sign = "==" if isinstance(operator, ast.Is) else "!="
                yield f"{quote(node)} tests whether both are the same object: compare values with {sign}."
            case ast.BoolOp(op=ast.Or(), values=[ast.Compare() as first, *others]) if fixed := [
                operand for operand in others if isinstance(operand, ast.Constant) and operand.value
            ]:
                other = ast.unparse(fixed[0])
                yield (
                    f"{quote(node)} is always true, because {other} alone is true: compare it as "
                    f"well, {ast.unparse(first.left)} == {other}."
                )
            case ast.BoolOp(op=joined, values=[ast.Compare() as first, ast.Compare() as second]):
                limits = _limits(first), _limits(second)
                if None in limits or ast.unparse(first.left) != ast.unparse(second.left):
                    continue
                (low, high), (other_low, other_high) = limits  # type: ignore[misc]  # None was excluded
                if isinstance(joined, ast.And) and max(low, other_low) > min(high, other_high):
                    subject = ast.unparse(first.left)
                    yield f'{quote(node)} is never true: {subject} cannot be both. Do you mean "or"?'
                if (
                    isinstance(joined, ast.Or)
                    and min(low, other_low) == -math.inf
                    and (max(high, other_high) == math.inf and max(low, other_low) <= min(high, other_high))
                ):
                    yield f'{quote(node)} is true for every number. Do you mean "and"?'
            case ast.Compare(
                left=low, ops=[ast.Lt() | ast.LtE(), ast.Lt() | ast.LtE()], comparators=[_, high]
            ) if _number(low) > _number(high):
                yield (
                    f"{quote(node)} is never true, because {ast.unparse(low)} is more than "
                    f"{ast.unparse(high)}: write the smaller limit first."
                )


def _odd_selections(function: Function) -> Iterator[str]:
    """Yield a sentence for each choice by an index or by whole numbers, and of a rotation only."""
    pairs: dict[str, list[str]] = {}
    indices: dict[str, str] = {}
    for node in ast.walk(function):
        match node:
            case ast.Assign(
                targets=[ast.Name(id=items)],
                value=ast.ListComp(
                    elt=ast.Tuple(elts=parts),
                    generators=[
                        ast.comprehension(
                            target=ast.Tuple(elts=[ast.Name(id=index), *_]),
                            iter=ast.Call(func=ast.Name(id="enumerate")),
                        )
                    ],
                ),
            ):
                pairs[items], indices[items] = [ast.unparse(part) for part in parts], index
            case ast.Compare(
                left=left,
                ops=[ast.In() | ast.NotIn()],
                comparators=[limits],
            ) if ast.unparse(left).endswith(".value") and ast.unparse(limits).startswith("range("):
                yield (
                    f"{quote(node)}: a range has whole numbers only, and not its end. Compare "
                    "with <= and both limits."
                )
            case ast.BinOp(
                left=ast.Subscript(value=matrix) as block,
                op=ast.MatMult(),
            ) if ast.unparse(block).endswith("[:3, :3]") and "[:3, 3]" not in ast.unparse(function):
                name = ast.unparse(matrix)
                yield (
                    f"{ast.unparse(block)} is only the rotation: add the translation, {name}[:3, "
                    f"3], or multiply the whole {name} by the point with a 1 below it."
                )
    for node in ast.walk(function):
        match node:
            case ast.Call(
                func=ast.Name(id="min" | "max" | "sorted"),
                args=[ast.Name(id=items)],
                keywords=[
                    ast.keyword(
                        value=ast.Lambda(body=ast.Subscript(slice=ast.Constant(value=int(place)))),
                        arg="key",
                    )
                ],
            ) if pairs.get(items, [])[place : place + 1] == [indices.get(items)]:
                yield (
                    f"{quote(node)} compares {indices[items]}, the index in the list, and not the "
                    "other value of each pair."
                )


def _limits(node: ast.Compare) -> tuple[float, float] | None:
    """Return the lowest and the highest value for which a comparison with a number is true, or None."""
    if len(node.ops) != 1 or math.isnan(value := _number(node.comparators[0])):
        return None
    match node.ops[0]:
        case ast.Lt() | ast.LtE():
            return -math.inf, value
        case ast.Gt() | ast.GtE():
            return value, math.inf
        case ast.Eq():
            return value, value
    return None


def _number(node: ast.expr) -> float:
    """Return the value of a number with its sign, or NaN."""
    match node:
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() | float() as value)):
            return -float(value)
    return math.nan
