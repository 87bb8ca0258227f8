"""Hints for values of the wrong type in fields, lists, pairs and loops, and for arguments of calls.

The errors of ROS and Python state the type that is needed, but not the value. The value is in the
frame that raised the error.
"""

import ast
import inspect
import linecache
import re
from array import array
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from traceback import walk_tb
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType
from typing import Any

import numpy as np

from course_lib.errors import format_count, join_words
from course_lib.ros import near_names
from course_lib.ros.messages.definitions import FieldDefinition, definition, type_names
from course_lib.ros.mistakes import Mistake, mistake_of
from course_lib.ros.student_code import (
    frame_of,
    is_of_library,
    is_student_class,
    line_of_student,
    reachable_object,
    step_of_student,
)

# The hint for None in a field of text, and in another one.
_NONE_VALUE = (
    "this is None: is it a parameter without a value, or a function that returns nothing?",
    "this is None: does the function that created it return something?",
)
# The hint for a matrix.
_FLAT = "this is an array of {} dimensions, and the field takes one: `matrix.ravel()` is flat."
# Messages of a few numbers.
_NUMBERS_OF = {"Point": "xyz", "Vector3": "xyz", "Quaternion": "xyzw", "ColorRGBA": "rgba"}


def value_hint(error: BaseException, text: str) -> str:
    """Return the hint for a field that is set to a value of another type, or "".

    ROS's error text states the type that the field needs, but not the value.
    """
    frame = frame_of(error)
    match = re.search(r"field must be (?:of type|a sub message of type) '(\w+)'", text)
    if frame is None or match is None or "value" not in frame.f_locals:
        return ""
    value, kind = frame.f_locals["value"], match[1]
    name = type(value).__name__
    is_number = kind in ("float", "int")
    if value is None and (is_number or kind == "str" or kind in _NUMBERS_OF):
        return _NONE_VALUE[kind != "str"]
    if isinstance(value, Mapping) and (is_number or kind == "str"):
        return f"this is a dictionary: take one of its values, like [{next(iter(value), 'key')!r}]."
    if isinstance(value, type) and kind != "str":
        # The class of an action's result is Fibonacci_Result, which a program calls Fibonacci.Result.
        shown = value.__name__.replace("_", ".")
        return f"this is the class {shown}: create an object, with `{shown}()`."
    if found := _several_values_hint(value, kind, line_of_student(error)):
        return found
    if isinstance(value, bytes) and kind == "str":
        return "this is of type bytes, and the field takes a string: print it. Text in bytes has decode( )."
    if isinstance(value, list | tuple) and kind == "str":
        return f"this is a {name}, and the field takes one string: `', '.join(['a', 'b'])` joins strings."
    if isinstance(value, FunctionType | MethodType | BuiltinFunctionType):
        return f"this is the function {value.__name__}, which is not called: are its ( ) missing?"
    owners = [step.f_locals.get("self") for step, _ in walk_tb(error.__traceback__)]
    owner = type(next((one for one in owners[::-1] if hasattr(one, "get_fields_and_field_types")), None))
    if is_number and (found := _number_hint(value, kind, text, line_of_student(error), owner)):
        return found
    if name == "Parameter":
        return "this is a parameter: read its value, `self.get_parameter('a_name').value`."
    if name == "ParameterValue":
        return "a ParameterValue can hold any type. The value itself is `self.get_parameter('a_name').value`."
    if hasattr(type(value), "get_fields_and_field_types"):
        return _message_value_hint(value, kind)
    return _nested_message_hint(value, kind, re.match(r"The '(\w+)' field", text))


def _several_values_hint(value: object, kind: str, line: str) -> str:
    """Return the hint for a function's several values that are assigned to too few or exchanged names."""
    # In status.message, status.level = found, the names on the left may be exchanged.
    if re.match(r"\s*[\w.]+\s*,\s*[\w.]+\s*=[^=]", line) and kind != "bytes" and type(value) in (bytes, str):
        name = type(value).__name__
        return f"this is of type {name}: are the names on the left of = in the order of the values?"
    if isinstance(value, tuple) and kind == "bytes":
        return f"this is a tuple of {len(value)} values: write a name for each of them on the left of =."
    return ""


def _message_value_hint(value: Any, kind: str) -> str:
    """Return the hint for a field to which a message of another type is assigned, or ""."""
    name, is_number = type(value).__name__, kind in ("float", "int")
    fields = type(value).get_fields_and_field_types()
    wanted = "string" if kind == "str" else kind
    fitting = [one for one, of in fields.items() if of.rpartition("/")[2] == wanted]
    if fitting:
        return f"this is a {name}: take its field {fitting[0]}."
    holders = [field.name for field in _fields_of(kind) if field.base.endswith(f"/{name}")]
    if holders:
        return f"this is a {name}: set it as {holders[0]} of the {kind}, pose.{holders[0]} = …."
    if is_number and fields:
        return f"this is a {name}: take one of its fields, {join_words(list(fields))}."
    if {name, kind} == {"Transform", "Pose"}:
        return f"this is a {name}: copy x, y, z and the quaternion to the fields of the {kind}."
    if set(fields) == {"x", "y", "z"} and kind in ("Point", "Vector3"):
        copy = f"`{kind}(x=v.x, y=v.y, z=v.z)`"
        return f"this is a {name}: {copy} has its numbers, where v is the {name}."
    return ""


def _fields_of(kind: str) -> Sequence[FieldDefinition]:
    """Return the fields of the likeliest message type of this name, or []."""
    types = [name for name in type_names() if name.endswith(f"/msg/{kind}")]
    types = near_names.sort_by_likelihood(types)
    return definition(types[0]).fields if types else []


def _nested_message_hint(value: object, kind: str, field: re.Match[str] | None) -> str:
    """Return the hint for a field of a message type that is set to plain values, or "".

    The hint contains the student's values.
    """
    if kind == "Header" and isinstance(value, str):
        frame = value if re.fullmatch(r"[\w/]{1,40}", value) else "map"
        return f"a header has a stamp and a frame: `message.header.frame_id = {frame!r}`."
    if kind in ("Pose", "Transform") and not hasattr(value, "__dict__"):
        inner = [field.name for field in _fields_of(kind)]
        return f"a {kind} has {join_words(inner)}: set their numbers, like {inner[0]}.x = 1.0."
    items: Any = value.ravel() if isinstance(value, np.ndarray) else value
    numbers: list[Any] = list(items) if isinstance(items, list | tuple | np.ndarray) else [items]
    names = _NUMBERS_OF.get(kind, "")
    if len(numbers) == len(names) and isinstance(value, list | tuple | np.ndarray):
        items_of = ", ".join(f"{name}=numbers[{index}]" for index, name in enumerate(names))
        by_index = f"create one, with named fields: `{kind}({items_of})`, where numbers is the list."
    else:
        by_index = ""
    are_short = all(
        isinstance(one, int | float | np.integer | np.floating) and -1000 < one < 1000 for one in numbers
    )
    if not numbers or not are_short:
        return by_index
    if len(numbers) == 1 and kind in ("Vector3", "Point") and field is not None and field[1] != "scale":
        return f"a {kind} has three numbers. Set one of them: {field[1]}.x = {float(numbers[0])!r}."
    if len(numbers) == 1 and kind == "Vector3":
        numbers *= 3
    if kind == "ColorRGBA" and len(numbers) == 3:
        numbers.append(1.0)
    texts = [repr(float(one)) for one in numbers]
    # Computed values have many digits.
    if len(numbers) != len(names) or max(map(len, texts)) > len("-10.25"):
        return by_index
    arguments = ", ".join(f"{name}={text}" for name, text in zip(names, texts, strict=True))
    return f"create one, with named fields: `{kind}({arguments})`."


def _number_hint(value: object, kind: str, text: str, line: str, owner: type) -> str:
    """Return the hint for a number field that is set to a similar value, such as a string, or "".

    A line may round the value of a float field with // or int( ).
    """
    name = type(value).__name__
    if isinstance(value, tuple) and all(isinstance(one, int | float) for one in value):
        if len(value) == 1:
            return "remove the comma at the end of the line: it makes a tuple of one item."
        if len(value) > 2 or not all(isinstance(one, int) for one in value):
            return f"this is {len(value)} numbers, {value!r}, but the field takes one: select it, like [0]."
        return f"this is {len(value)} numbers, {value!r}: a decimal number has a point, 0.8, not a comma."
    if isinstance(value, np.generic):
        return f"this is numpy's {name}: convert it with {kind}(…)."
    if isinstance(value, str) and re.search("'(type|action)' field", text):
        # In a Marker, "sphere" is meant as its constant SPHERE.
        constant = value.strip().upper().replace(" ", "_")
        is_known = isinstance(getattr(owner, constant, None), int)
        return f"use the constant: `{owner.__name__}.{constant}`." if is_known else ""
    if isinstance(value, str):
        return f"this is the string {value!r}: remove the quotes, or convert it with {kind}(…)."
    # numpy cannot measure a list whose items differ in length.
    if isinstance(value, list | np.ndarray) and (len(value) if isinstance(value, list) else value.size) != 1:
        return f"this is a list of {len(value)} items, but the field takes one: select it, like [0]."
    if isinstance(value, list | np.ndarray | complex):
        return f"this is of type {name}, but the field takes one number: print it."
    if kind != "float" or not isinstance(value, int):
        return ""
    if "//" in line:
        return "// rounds down to a whole number: / divides with the fraction."
    if match := re.search(r"\b(int|round)\(", line):
        return f"{match[1]}( ) makes a whole number, without the fraction: leave it out."
    return ""


def list_hint(error: BaseException, text: str) -> str:
    """Return the hint for an array field that is set to a value of another type, or "".

    ROS's error text does not contain the passed value.
    """
    frame = frame_of(error)
    if frame is None or "value" not in frame.f_locals:
        return ""
    value = frame.f_locals["value"]
    if isinstance(value, np.ndarray) and value.ndim != 1 and "must have a size of" in text:
        return _FLAT.format(value.ndim)
    # A constructor converts the value to an array, whose error is the one of a single item.
    is_converted = frame.f_code.co_name == "pack" and "must be real number" in text
    if "must be a set or sequence" not in text and not is_converted:
        return ""
    if isinstance(value, Mapping):
        return "this is a dictionary, and the field takes a list: list its values in the right order."
    if value is None:
        return "this is None: append() and other methods that change a list return None."
    if isinstance(value, str | int | float):
        return f"this is one value, {value!r}, and the field takes several: put them into a list, in [ ]."
    point = re.search(r"each value of type '(Point|Vector3|Quaternion|ColorRGBA)'", text)
    if isinstance(value, np.ndarray) and value.ndim != 1 and not point:
        return _FLAT.format(value.ndim)
    if isinstance(value, Iterable) and not isinstance(value, Collection):
        return f"this is of type {type(value).__name__}, which is not a list: put it into list( )."
    item_type = "each value of type 'float'" if is_converted else text
    items = list(value) if isinstance(value, Sequence | np.ndarray) else []
    length = re.search(r"with length (\d+)", text)
    if length and len(items) != int(length[1]):
        return f"the field takes {length[1]} numbers, and this list has {len(items)}."
    return next(
        (hint for index, item in enumerate(items) if (hint := _item_hint(index, item, item_type))), ""
    )


def _item_hint(index: int, item: Any, text: str) -> str:
    """Return the hint for an item that does not belong in an array field, or "".

    The text of the error contains the type of the items.
    """
    plain_type = re.search(r"each value of type '(float|int|str|bool)'", text)
    if plain_type is None and isinstance(item, type):
        return f"item {index} is the class {item.__name__}: create an object, with `{item.__name__}()`."
    if plain_type is None and isinstance(item, FunctionType | MethodType | BuiltinFunctionType):
        return f"item {index} is the function {item.__name__}, which is not called: are its ( ) missing?"
    if plain_type is None and item is None:
        return f"item {index} is None: does the function that created it end with a return?"
    if plain_type is not None and plain_type[1] == "int":
        limits = re.search(r"in \[(-?\d+), (\d+)\]", text)
        if isinstance(item, int | np.integer):
            if limits and not int(limits[1]) <= item <= int(limits[2]):
                return f"item {index} of the list is {item}, outside of {limits[1]} to {limits[2]}."
            return ""
        if isinstance(item, float | np.floating):
            return f"item {index} of the list is {float(item)}, with a point: write int(…) or round(…)."
    if item is None or (isinstance(item, str) and "'str'" not in text):
        noun = "a message" if plain_type is None else "a text" if plain_type[1] == "str" else "a number"
        return f"item {index} of the list is {item!r}, not {noun}."
    if plain_type is not None and plain_type[1] == "str" and isinstance(item, int | float):
        return f"item {index} of the list is {item!r:.40}, not a string."
    kind = re.search(r"each value of type '(\w+)'", text)
    wanted = kind[1] if kind is not None and "'transforms'" not in text else ""
    name = type(item).__name__
    if wanted not in ("", name) and plain_type is None and hasattr(item, "get_fields_and_field_types"):
        return f"item {index} is of type {name}, and the list takes a {wanted} for each item."
    names = _NUMBERS_OF.get(wanted, "")
    if names and isinstance(item, list | tuple | np.ndarray) and len(item) == len(names):
        parts = ", ".join(f"{name}=item[{place}]" for place, name in enumerate(names))
        return f"item {index} is only numbers. Make a message of each: {wanted}({parts})."
    # Three numbers in place of a point are not a nested list.
    is_nested = isinstance(item, list | tuple | np.ndarray)
    if is_nested and plain_type is None and any(isinstance(one, str) for one in item):
        return ""
    if is_nested and (plain_type or not all(isinstance(one, int | float) for one in item)):
        return f"item {index} is a list in the list: does it have [ ] of its own, or is a * missing?"
    return ""


def index_hint(error: BaseException) -> str:
    """Return the hint for an index beyond the end of a list, with the numbers, or ""."""
    frame, line = frame_of(error), line_of_student(error)
    if frame is None or not isinstance(error, IndexError):
        return ""
    names = {**frame.f_globals, **frame.f_locals}
    for holder, index in re.findall(r"\b(\w+(?:\.\w+)*)\[([\w\s+-]+)\]", line):
        first, *attributes = holder.split(".")
        items = names.get(first)
        for attribute in attributes:
            is_message = hasattr(type(items), "get_fields_and_field_types")
            of_object = getattr(items, "__dict__", {})
            items = getattr(items, attribute, None) if is_message else of_object.get(attribute)
        value = _value_of(index, names)
        if not isinstance(items, list | tuple | str | np.ndarray | array) or value is None:
            continue
        count = len(items)
        # An empty field of numbers has a hint of its own.
        if -count <= value < count or (isinstance(items, array) and not count):
            continue
        if not count and "assignment" in str(error):
            return f"{holder} is empty here: {holder}.append(…) adds an item."
        if not count:
            return f"{holder} is empty here: test this first, with if len({holder}) == 0."
        number = index if index == str(value) else f"{index}, which is {value}"
        last = f"{format_count(count, 'item')}, from [0] to [{count - 1}]"
        return f"{holder} has {last}, so not [{number}]."
    return ""


def _value_of(index: str, names: Mapping[str, Any]) -> int | None:
    """Return the value of an index like "number + 1", or None if it is not a sum of numbers."""
    total = 0
    for sign, term in re.findall(r"([+-]?)\s*(\w+)", index):
        value = int(term) if term.isdecimal() else names.get(term)
        if not isinstance(value, int | np.integer):
            return None
        total += -int(value) if sign == "-" else int(value)
    return total


# Methods that change their object, and functions that only print. Both return None.
_WITHOUT_RESULT = r"\w+\.(?:append|extend|insert|remove|reverse|sort|update|add|shuffle)|print"


def unpacked_string_hint(error: BaseException, text: str) -> str:
    """Return the hint for a string whose letters are unpacked, as in `r, g, b = "gray"`, or ""."""
    found = re.match(
        r"\s*\w+(?:\s*,\s*[\w.]+)+\s*=\s*([\"'][^\"']*[\"']|\w+)\s*(?:#.*)?$",
        line_of_student(error),
    )
    frame = frame_of(error)
    if found is None or frame is None or "values to unpack" not in text:
        return ""
    value = found[1].strip("\"'")
    if value == found[1]:
        named = {**frame.f_globals, **frame.f_locals}.get(value)
        value = named if isinstance(named, str) else ""
    if not value:
        return ""
    return f"the right side is the string {value!r:.40}, of which each letter is a value: write numbers."


def number_loop_hint(error: BaseException) -> str:
    """Return the hint for a loop over a range that uses its numbers like the items, or ""."""
    if not isinstance(error, AttributeError) or not isinstance(error.obj, int):
        return ""
    for frame, _ in walk_tb(error.__traceback__):
        lines = "".join(linecache.getlines(frame.f_code.co_filename))
        for name, value in frame.f_locals.items():
            loop = re.search(rf"\bfor {name} in range\(len\(([\w.]+)\)\)", lines)
            if loop and value is error.obj:
                items = loop[1]
                return (
                    f"{name} is a number here: the item is {items}[{name}]. Or loop over the items "
                    f"themselves: for {name} in {items}."
                )
    return ""


def pair_hint(error: BaseException, text: str) -> str:
    """Return the hint for a loop over pairs or over the keys of a dictionary; "" for other loops."""
    frames = [frame for frame, _ in walk_tb(error.__traceback__)]
    if isinstance(error, AttributeError) and isinstance(error.obj, tuple):
        for frame in frames:
            lines = "".join(linecache.getlines(frame.f_code.co_filename))
            names = [name for name, value in frame.f_locals.items() if value is error.obj]
            if any(re.search(rf"\bfor {name} in enumerate\(", lines) for name in names):
                return "enumerate gives pairs: `for index, item in enumerate(items)`."
            if any(re.search(rf"\bfor {name} in [\w.]+\.items\(", lines) for name in names):
                return "items() gives pairs, a key and a value: write two names between for and in."
    line = line_of_student(error)
    if not isinstance(error, ValueError) or "values to unpack" not in text:
        return ""
    loop = re.search(r"\bfor [\w, ()]+ in (\w+(?:\.\w+)*)\s*(?:$|[:\])}]| if )", line)
    if loop is None:
        return ""
    first, *attributes = loop[1].split(".")
    for frame in reversed(frames):
        value = {**frame.f_globals, **frame.f_locals}.get(first)
        for attribute in attributes:
            value = getattr(value, "__dict__", {}).get(attribute)
        if isinstance(value, Mapping):
            items = loop[1]
            return f"{items} is a dictionary, whose loop gives only its keys: write {items}.items()."
    return ""


def none_hint(error: BaseException, text: str) -> str:
    """Return the hint for a variable that is None, or "".

    A callback has not set it yet, or it has the value of a function that returns nothing. That
    assignment may be above the failing line: `corners = corners.append(corner)`.
    """
    if found_hint := _waiting_hint(error, text):
        return found_hint
    frame = frame_of(error)
    if frame is None or "NoneType" not in text:
        return ""
    for line in lines_above(error):
        found = re.match(rf"\s*(\w+)\s*=\s*({_WITHOUT_RESULT})\(", line)
        if found and found[1] in frame.f_locals and frame.f_locals[found[1]] is None:
            name, call = found[1], found[2]
            if call == "print":
                return f"print(…) returns None: leave out print, as in {name} = 1.0."
            return f"{call}(…) changes its object and returns None: leave out {name} = before it."
    return ""


def _waiting_hint(error: BaseException, text: str) -> str:
    """Return the hint for a variable that is None until a callback has got a message, or ""."""
    step, inner = step_of_student(error), frame_of(error)
    is_of_field = "field must be" in text and inner is not None and inner.f_locals.get("value", "") is None
    if step is None or not (is_of_field or "NoneType" in text):
        return ""
    frame = step[0]
    lines = linecache.getlines(frame.f_code.co_filename)
    try:
        tree = ast.parse("".join(lines))
    except SyntaxError:  # a cell with a magic
        return ""
    # Python keeps self.__pose of a class Mover as _Mover__pose.
    class_name = frame.f_code.co_qualname.rpartition(".")[0].rpartition(".")[2].lstrip("_")
    attributes = getattr(frame.f_locals.get("self"), "__dict__", {})
    variables = {
        "self." + re.sub(rf"^_{class_name}(?=__)", "", name): value for name, value in attributes.items()
    }
    variables |= frame.f_globals | frame.f_locals
    names = set(re.findall(r"(?<![\w.])(?:self\.)?\w+", line_of_student(error))) & variables.keys()
    nothing = [name for name in names if variables[name] is None]
    if len(nothing) != 1:
        return ""
    name = nothing[0]
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef) and _keeps_message(function, name):
            text = f"{name} is None until {function.name} has run: write"
            return f"{text} `if {name} is None: return` before this line."
    # A typical mistake is self.marker = self.new_stripe(1) with a method that sets self.marker itself
    # and returns nothing.
    without_result = {
        part.name
        for part in ast.walk(tree)
        if isinstance(part, ast.FunctionDef)
        and not any(isinstance(inner, ast.Return) and inner.value for inner in ast.walk(part))
    }
    for outer, _ in walk_tb(error.__traceback__):
        cell = "".join(linecache.getlines(outer.f_code.co_filename))
        for method in re.findall(rf"{re.escape(name)} = self\.(\w+)\(", cell):
            if method in without_result:
                return f"{method} has no return, so {name} is None: write self.{method}(…) without {name} =."
    return ""


def _keeps_message(callback: ast.FunctionDef, name: str) -> bool:
    """Return whether a function sets a variable to its last parameter, or to a part of it."""
    parameters = [argument.arg for argument in callback.args.args if argument.arg != "self"]
    global_names = {one for node in ast.walk(callback) if isinstance(node, ast.Global) for one in node.names}
    if not parameters or callback.name == "__init__" or ("." not in name and name not in global_names):
        return False
    values = [
        ast.unparse(node.value)
        for node in ast.walk(callback)
        if isinstance(node, ast.Assign) and name in map(ast.unparse, node.targets)
    ]
    # Functions may return None, except functions of numpy and conversions.
    part = rf"(?:np\.\w+\(|float\(|list\()?{parameters[-1]}\b[\w.\[\]]*\)?"
    return any(re.fullmatch(part, value) for value in values)


def lines_above(error: BaseException) -> Iterator[str]:
    """Yield the lines of the student's failing function from the failing one upwards."""
    if step := step_of_student(error):
        frame, number = step
        lines = linecache.getlines(frame.f_code.co_filename)
        yield from reversed(lines[frame.f_code.co_firstlineno - 1 : number])


# The arguments of a QoSProfile.
_OF_PROFILE: tuple[str, ...] = ("history", "depth", "reliability", "durability", "lifespan", "deadline")
_OF_PROFILE += ("liveliness", "liveliness_lease_duration", "avoid_ros_namespace_conventions")


def constructor_hint(error: BaseException) -> str:
    """Return a question with the field closest to one that a message constructor rejects, or ""."""
    match = re.match(r"Invalid arguments passed to constructor: (\w[\w, ]*)", str(error))
    frame = frame_of(error)
    for name in re.findall(r"'(\w+)'", str(error)) if "dict_keys" in str(error) else ():
        if name not in _OF_PROFILE:
            similar = near_names.nearest(name, _OF_PROFILE)
            names = join_words(_OF_PROFILE)
            return f"did you mean `{similar}`?" if similar else f"a QoSProfile has {names}."
    instance = frame.f_locals.get("self", frame.f_locals.get("_self")) if frame is not None else None
    if match is None or instance is None or not hasattr(type(instance), "get_fields_and_field_types"):
        return ""
    fields = list(instance.get_fields_and_field_types())
    kind, unknown = type(instance).__name__, match[1].split(", ")
    found = [near_names.near_field(name, fields) for name in unknown]
    if len(unknown) > 1 and all(found):
        pairs = zip(found, unknown, strict=True)
        return f"did you mean {join_words([f'`{field}` for {name}' for field, name in pairs])}?"
    similar = found[0]
    return f"did you mean `{similar}`?" if similar else f"the fields of {kind} are {join_words(fields)}."


def unnamed_field_hint(error: BaseException) -> str:
    """Return the hint for values without names that are passed to the class of a message, or "".

    A message of numbers and strings only has an example in the table.
    """
    frame = frame_of(error)
    if mistake_of(error) is not Mistake.UNNAMED_FIELD or frame is None:
        return ""
    kind = type(frame.f_locals["self"])
    if kind._TYPE_NAME == "rcl_interfaces/msg/Parameter":
        return (
            "this is the message Parameter of rcl_interfaces. The class for nodes is another one: "
            "`from rclpy.parameter import Parameter`."
        )
    fields = definition(kind._TYPE_NAME).fields
    if not any(field.is_message for field in fields):
        return ""
    names: list[str] = []
    for value in frame.f_locals["positional"]:
        free = [field.name for field in fields if field.name not in names and _is_valid_value(value, field)]
        if not free and isinstance(value, str):
            return ""
        if not free:
            return f"{kind.__name__} takes its fields by name: {join_words([f.name for f in fields])}."
        names.append(free[0])
    return (
        f"pass each value with the name of its field: "
        f"{kind.__name__}({', '.join(f'{name}=…' for name in names)})."
    )


def _is_valid_value(value: object, field: FieldDefinition) -> bool:
    """Return whether a value may be meant for a field of a message."""
    if field.container != "scalar":
        return isinstance(value, list | tuple) or hasattr(value, "tolist")
    if field.is_message:
        return getattr(value, "_TYPE_NAME", None) == field.base
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return isinstance(value, str) if field.base in ("string", "wstring") else is_number


def extra_argument_hint(error: BaseException) -> str:
    """Return the hint for a method that receives more arguments than it accepts, although it has `self`."""
    match = re.match(
        r"(?:.*\.)?(\w+)\.(\w+)\(\) takes \d+ positional arguments? but (\d+) (?:was|were) given", str(error)
    )
    frame = frame_of(error)
    if match is None or frame is None:
        return ""
    cls, name = reachable_object(frame, match[1]), match[2]
    method = getattr(cls, name, None) if isinstance(cls, type) else reachable_object(frame, name)
    code = getattr(method, "__code__", None)
    if not isinstance(code, CodeType) or code.co_varnames[:1] != ("self",) or name == "__init__":
        return ""
    if match[1] == "RcutilsLogger":
        return f"write one f-string: `self.get_logger().{name}(f'speed: {{speed}}')`."
    names = list(code.co_varnames[1 : code.co_argcount])
    passed_text = f"the call passes {format_count(int(match[3]) - 1, 'value')}"
    owner = "self." if isinstance(cls, type) and isinstance(frame.f_locals.get("self"), cls) else ""
    call = f"{owner}{name}({', '.join(names)})"
    return f"{name} takes {join_words(names) or 'nothing'} besides self, and {passed_text}: write {call}."


def keyword_argument_hint(error: BaseException) -> str:
    """Return the hint for a call of the kit or of a library whose last values need names, or ""."""
    match = re.match(
        r"(?:\w+\.)*?(\w+)(?:\.__init__)?\(\) takes (?:from \d+ to )?(\d+) positional arguments? but (\d+)",
        str(error),
    )
    frame = frame_of(error)
    if match is None or frame is None or not isinstance(error, TypeError):
        return ""
    function = reachable_object(frame, match[1])
    if match[1] == "LaunchDescription":
        return "LaunchDescription takes one list: put all actions into it, LaunchDescription([…, …])."
    # The classes of rclpy have hints with examples.
    is_of_rclpy = str(getattr(function, "__module__", "")).startswith("rclpy")
    if is_of_rclpy or (
        is_student_class(function) if isinstance(function, type) else not is_of_library(function)
    ):
        return ""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return ""
    # Messages have hints of their own.
    if mistake_of(error) is Mistake.UNNAMED_FIELD:
        return ""
    named = [p.name for p in parameters if p.kind == inspect.Parameter.KEYWORD_ONLY]
    missing = int(match[3]) - int(match[2])
    if not named and isinstance(function, FunctionType) and match[2] == "0":
        return f"{match[1]} takes no values: write {match[1]}()."
    if len(named) < missing:
        return ""
    names = named[:3]
    more = "" if len(names) == len(named) else ", …"
    return f"{match[1]} takes the last values by name: {', '.join(f'{name}=…' for name in names)}{more}."
