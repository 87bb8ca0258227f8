"""Hints: one line of help for a common mistake, printed below the error of ROS or Python.

A hint is found by the type of the exception, by a pattern of its text and, where the text is
ambiguous, by the mistake with which the raising code has marked the exception.
"""

import dis
import linecache
import re
import tomllib
from collections import Counter
from collections.abc import Awaitable, Sequence
from dataclasses import dataclass
from enum import EnumType
from pathlib import Path
from traceback import walk_tb
from types import FunctionType, ModuleType

from course_lib.errors import join_words
from course_lib.ros import import_hints, near_names, shadowing_hints, syntax_hints, value_hints
from course_lib.ros.messages.definitions import definition, type_names
from course_lib.ros.mistakes import Mistake, mistake_of
from course_lib.ros.programs.packages import unavailable_reason
from course_lib.ros.student_code import (
    frame_of,
    is_native,
    is_of_library,
    is_student_class,
    is_student_file,
    line_of_student,
    reachable_object,
)
from course_lib.ros.tf2 import BufferCore

# Limit on the characters of an error's text, and of the failing line, that are examined.
MAX_TEXT = 2000


@dataclass(frozen=True)
class Hint:
    """A hint for exceptions whose text matches and that are marked with `mistake`, if it is set."""

    text: str
    # The hint's text, which may refer to groups of the match, such as {1}.
    hint: str
    mistake: Mistake | None = None


# By exception type. They are read on import, because a program may later use up all file handles.
_HINTS = {
    kind: [Hint(text, line, *(Mistake[name] for name in mistake)) for text, line, *mistake in rows]
    for kind, rows in tomllib.loads(Path(__file__).with_name("hints.toml").read_text("utf-8")).items()
}


# A function that calls itself more often than this repeats itself in the traceback of a
# RecursionError.
_FEW_CALLS = 20
# The number of frames of a buffer that a hint names.
_MOST_FRAMES = 8
# The table of attributes that rclpy lacks, whose patterns match "rclpy.time.Time.now", and the
# table of patterns that match the failing line and the error.
_OF_RCLPY, _OF_LINES = "OfRclpy", "OfLines"


def add_hint(error: BaseException) -> None:
    """Add a line "hint: ..." to an exception that is a common mistake, at most once."""
    text = hint(error)
    if text and not getattr(error, "__notes__", None):
        error.add_note(f"hint: {text}")


def hint(error: BaseException) -> str:
    """Return the hint for an exception, or ""."""
    try:
        return _find_hint(error)
    except (Exception, SystemExit):
        # Attributes of a student's object may be code, like a __getattr__ that raises an exception.
        return ""


def _find_hint(error: BaseException) -> str:
    text = _text(error)
    if isinstance(error, SyntaxError):
        return syntax_hints.syntax_hint(error)
    if isinstance(error, NameError) and (
        found := _missing_self_hint(error, text) or near_names.name_hint(error)
    ):
        return found
    if isinstance(error, ModuleNotFoundError):
        found = unavailable_reason((error.name or "").split(".")[0]) or import_hints.module_hint(error)
        if found:
            return found
    if (
        found := _recursion_hint(error)
        or shadowing_hints.outdated_hint(error)
        or _foreign_letter_hint(error, text)
        or shadowing_hints.hidden_property_hint(error)
        or shadowing_hints.hidden_module_hint(error)
        or near_names.key_hint(error)
        or _decimal_comma_hint(error, text)
        or _rclpy_attribute_hint(error)
        or near_names.parameter_hint(error)
        or near_names.keyword_hint(error)
        or _enum_hint(error)
        or _line_hint(error, text)
        or _task_argument_hint(error, text)
        or value_hints.extra_argument_hint(error)
        or value_hints.keyword_argument_hint(error)
        or value_hints.constructor_hint(error)
        or value_hints.unnamed_field_hint(error)
        or _unbound_hint(error, text)
        or _tf_hint(error, text)
        or _callback_hint(error)
        or _parameter_callback_hint(error, text)
        or shadowing_hints.shadowed_hint(error, text)
        or _loop_hint(error, text)
        or _order_hint(error, text)
        or _executor_hint(error, text)
        or _operand_hint(error, text)
        or _request_hint(error)
        or _future_hint(error)
        or _base_class_hint(error)
        or value_hints.list_hint(error, text)
        or value_hints.unpacked_string_hint(error, text)
        or value_hints.index_hint(error)
        or value_hints.none_hint(error, text)
        or value_hints.number_loop_hint(error)
        or value_hints.pair_hint(error, text)
        or value_hints.value_hint(error, text)
        or import_hints.skipped_interfaces_hint(error)
        or _file_hint(error)
        or _table_hint(error, text)
        or _missing_value_hint(error, text)
    ):
        return found
    if isinstance(error, ModuleNotFoundError) and (
        interface_package := import_hints.imported_interfaces(error)
    ):
        package, kind = interface_package
        return f"put the folder {package} with its {kind} beside the program, or into the workspace's src."
    if isinstance(error, ImportError):
        return import_hints.import_hint(error)
    # The object is unknown, or a message: rclpy also has a class Time.
    is_of_message = (
        not isinstance(error, AttributeError)
        or error.obj is None
        or hasattr(error.obj, "get_fields_and_field_types")
    )
    if is_of_message and (types := _types_of(error, text)):
        missing = text.rpartition("attribute '")[2].partition("'")[0]
        return _field_hint(types, missing, line_of_student(error))
    if isinstance(error, AttributeError):
        frame = frame_of(error)
        outer = frame.f_globals.get(error.name or "") if frame is not None else None
        is_student_object = is_student_class(type(error.obj))
        has_parameter = getattr(error.obj, "has_parameter", None) if is_student_object else None
        if error.name and callable(has_parameter) and has_parameter(error.name) is True:
            return f"{error.name} is a parameter: read it with `self.get_parameter('{error.name}').value`."
        # A function with self is a method with too little indentation, which has a hint of its own.
        is_function = isinstance(outer, FunctionType) and outer.__code__.co_varnames[:1] != ("self",)
        if is_student_object and is_function:
            return f"{error.name} is a function outside of the class: call it without `self.`"
        if similar := near_names.attribute_hint(error):
            return similar
        attribute = re.match(r"'(\w+)' object has no attribute '(\w+)'$", text)
        if attribute and is_student_object:
            return _unset_attribute_hint(error, attribute[1], attribute[2])
    return ""


def _unset_attribute_hint(error: AttributeError, owner: str, name: str) -> str:
    """Return the hint for an attribute that the student's object does not have at this line."""
    frame, cls = frame_of(error), type(error.obj)
    of_node = ("create_", "get_", "declare_", "destroy_")
    if not hasattr(cls, "create_timer") and name.startswith(of_node):
        return f"write (Node) after the name of the class, class {owner}(Node): then it has {name}."
    if re.search(rf"\bself\.{name}\(", line_of_student(error)):
        return f"{owner} has no method {name}: write its `def {name}(self)` into the class."
    if frame is not None and (holder := near_names.holder_of_field(name, frame)):
        return f"did you mean `{holder}.{name}`? It is a field of the message."
    return f"set `self.{name}` in {owner}.__init__, spelled the same."


def _foreign_letter_hint(error: BaseException, text: str) -> str:
    """Return the hint for a name of ROS or an attribute with a foreign letter, or ""."""
    is_name = isinstance(error, AttributeError) or text.startswith(
        ("Invalid topic name", "Invalid node name")
    )
    found = syntax_hints.foreign_letter(text) if is_name else ""
    return f"{found}: type the name again." if found else ""


def _field_hint(types: Sequence[str], attribute: str, line: str) -> str:
    """Return the hint for a field or a constant that a message does not have, in a student's line."""
    definitions = [definition(name) for name in types]
    names = [n for type_ in definitions for n in (*type_.constants, *(f.name for f in type_.fields))]
    # The fields of a service or an action are shown under its name: Trigger for Trigger_Request.
    shown = re.sub(r"(/(?:srv|action)/[^_]+)_\w+$", r"\1", types[0])
    show = f"`%ros2 interface show {shown}` lists its fields."
    if attribute.lower() in near_names.ANGLES and {"x", "y", "z", "w"} <= set(names):
        turn = "`Quaternion(z=sin(yaw / 2), w=cos(yaw / 2))`"
        back = "the inverse is `yaw = 2 * atan2(q.z, q.w)`"
        return f"a quaternion does not contain an angle: a rotation by yaw about z is {turn}, and {back}."
    lists = [f.name for type_ in definitions for f in type_.fields if f.container != "scalar"]
    if attribute in dir(list) and len(lists) == 1:
        return f"did you mean `{lists[0]}.{attribute}`? {show}"
    if attribute in ("copy", "deepcopy", "clone"):
        return "a message has no method for this: `import copy`, then copy.deepcopy(message)."
    if attribute == "publish":
        return "this is a message: a publisher sends it, `self.publisher.publish(message)`."
    called = re.search(rf"\b(self\.\w+)\.{attribute}\(", line)
    if called and attribute in near_names.OF_BUFFER:
        return f"{called[1]} is a message here and not a Buffer: look where it is set a second time."
    if attribute == "to_msg":
        return f"this is a message already: leave out .to_msg(). {show}"
    constants = [name for type_ in definitions for name in type_.constants]
    if attribute.isupper() and (similar := near_names.near_field(attribute, constants)):
        return f"did you mean `{similar}`? {show}"
    direct = [name for name in near_names.synonyms(attribute) if name in names]
    inner = [
        path
        for word in (attribute, *near_names.synonyms(attribute))
        for name in types
        for path in _paths_to(name, word)
    ]
    exact = [path for path in inner if path.endswith(f".{attribute}")]
    similar = next(iter([*exact, *direct, *inner]), "") or near_names.near_field(attribute, names)
    # An array of messages has one list, whatever a student calls it.
    if not similar and len(lists) == 1 and attribute.endswith("s"):
        similar = lists[0]
    # In `pose.position`, where pose is a PoseStamped, the path `pose.position` does not help.
    owners = re.findall(rf"([\w.\[\]]+)\.{attribute}\b", line)
    # With several owners in a line, as in `a.header.stamp = b.stamp`, it may be any of them.
    if "." in similar and len(owners) == 1 and owners[0].split(".")[-1] == similar.split(".")[0]:
        similar = f"{owners[0]}.{similar}"
    return f"did you mean `{similar}`? {show}" if similar else show


def _decimal_comma_hint(error: BaseException, text: str) -> str:
    """Return the hint for a failing line in which a decimal comma splits a number, or ""."""
    surplus = (
        r"takes (exactly one|1 positional) argument.*2 (were )?given|attribute 'add_entity'|'tuple'"
        "|too many values to unpack|is not a node"
    )
    if re.search(surplus, text):
        return syntax_hints.decimal_comma_hint(line_of_student(error))
    if "must be real number, not tuple" in text:
        # The tuple is usually a variable, which a line above has set.
        found = map(syntax_hints.decimal_comma_hint, value_hints.lines_above(error))
        return next(filter(None, found), "")
    return ""


def _rclpy_attribute_hint(error: BaseException) -> str:
    """Return the hint for an attribute that rclpy, or one of its classes, does not have, or "".

    Typical names are from ROS 1 and from C++.
    """
    if not isinstance(error, AttributeError) or error.obj is None or error.name is None:
        return ""
    thing, name = error.obj, error.name
    if isinstance(thing, ModuleType):
        owners = [thing.__name__]
        line = near_names.IMPORTS.get(name, "")
        if line.startswith(f"from {thing.__name__}."):
            return f"import it: `{line}`."
    else:
        kinds = type.mro(thing) if isinstance(thing, type) else type(thing).__mro__
        owners = [f"{kind.__module__}.{kind.__qualname__}" for kind in kinds]
        # A student's node may have a publisher of its own, which is more likely to be meant.
        if near_names.attribute_hint(error).startswith("did you mean `self."):
            return ""
    for owner in owners:
        for row in _HINTS[_OF_RCLPY] if owner.startswith("rclpy") else ():
            if re.search(row.text, f"{owner}.{name}"):
                return row.hint
    return ""


def _line_hint(error: BaseException, text: str) -> str:
    """Return the first hint of the table whose pattern matches the student's line and the error, or ""."""
    line = line_of_student(error).rstrip()[:MAX_TEXT]
    both = f"{line}\n{type(error).__name__}: {text}"
    found = ((row, re.search(row.text, both)) for row in _HINTS[_OF_LINES])
    return next((row.hint.format(match[0], *match.groups()) for row, match in found if match), "")


def _table_hint(error: BaseException, text: str) -> str:
    """Return the first matching hint of the table, or "".

    A group ending in "()" becomes a call with the message's fields.
    """
    for row in _HINTS.get(type(error).__name__, ()):
        match = re.search(row.text, text)
        if match and row.mistake in (None, mistake_of(error)):
            groups = (match[0], *match.groups())
            calls = [near_names.call_with_fields(group or "") or f"{group}()" for group in groups]
            # The name of the callback that rclpy rejects, or an example of one.
            steps = [step.f_locals for step, _ in walk_tb(error.__traceback__)]
            callback = next((names["callback"] for names in steps[::-1] if "callback" in names), None)
            name = getattr(callback, "__name__", "")
            method = name if isinstance(name, str) and name.isidentifier() else "on_message"
            return row.hint.format(*groups, call=calls[-1], method=method)
    return ""


def _enum_hint(error: BaseException) -> str:
    """Return the hint for a member that an enumeration of ROS does not have, or ""."""
    if not isinstance(error, AttributeError) or not isinstance(error.obj, EnumType):
        return ""
    kind = error.obj
    if near_names.nearest(error.name or "", kind.__members__):
        return ""
    return f"{kind.__name__.removesuffix('Type')} has {join_words(list(kind.__members__)[:_MOST_FRAMES])}."


def _task_argument_hint(error: BaseException, text: str) -> str:
    """Return the hint for a callback of a future or an action that lacks its parameter, or ""."""
    frame = frame_of(error)
    match = re.match(r"(?:.*\.)?(\w+|<lambda>)\(\) takes \d+ positional arguments? but", text)
    arguments = frame.f_locals.get("args") if frame is not None else None
    if match is None or not isinstance(arguments, tuple) or not isinstance(error, TypeError):
        return ""
    kinds = {
        "Future": ("a future gets the future", "future", "The response is future.result()."),
        "ServerGoalHandle": (
            "an action server gets the goal handle",
            "goal_handle",
            "The goal is goal_handle.request.",
        ),
    }
    for argument in arguments:
        if found := kinds.get(type(argument).__name__):
            rule, name, use = found
            first = "self, " if "." in text.partition("(")[0].rpartition("<locals>.")[2] else ""
            is_lambda = match[1] == "<lambda>"
            code = f"lambda {name}: {name}" if is_lambda else f"def {match[1]}({first}{name})"
            return f"the callback of {rule}: write `{code}`. {use}"
    return ""


def _unbound_hint(error: BaseException, text: str) -> str:
    """Return the hint for a callback that is a method of the class and not of its object, or ""."""
    frame = frame_of(error)
    match = re.match(r"(\w+)\.(\w+)\(\) missing \d required positional arguments?: .*'self'", text)
    if match and mistake_of(error) is Mistake.TIMER_CALLBACK:
        return f"pass the method of the object, self.{match[2]}. A @staticmethod has no self."
    if frame is None or frame.f_code.co_varnames[:1] != ("self",):
        return ""
    owner = type(frame.f_locals.get("self"))
    if isinstance(error, AttributeError) and hasattr(owner, "get_fields_and_field_types"):
        name = frame.f_code.co_name
        return f"self is the {owner.__name__} here: pass the method of the object, self.{name}."
    return ""


def _tf_hint(error: BaseException, text: str) -> str:
    """Return the hint for wrong arguments of a Buffer or a transformation, or ""."""
    frames = [frame for frame, _ in walk_tb(error.__traceback__)]
    if isinstance(error, AttributeError) and any(
        frame.f_code.co_name.startswith("do_transform_") for frame in frames
    ):
        return (
            "the first argument is a message with a header, the second one the transform: "
            "`tf2_geometry_msgs.do_transform_point(point, transform)`."
        )
    is_node = any(hasattr(frame.f_locals.get("cache_time"), "create_publisher") for frame in frames)
    if text.startswith("duration must have") and is_node:
        return (
            "a buffer takes no node: `Buffer()`. The listener does, `TransformListener(self.buffer, self)`."
        )
    callers = {frame.f_code.co_name for frame in frames}
    if re.search("'Time' and '(float|int)'", text) and {"lookup_transform", "can_transform"} & callers:
        return "the timeout is a Duration and not a number: `Duration(seconds=1.0)`."
    if type(error).__name__ == "LookupException" and (found := _frames_hint(error, text)):
        return found
    return ""


def _frames_hint(error: BaseException, text: str) -> str:
    """Return the hint for a frame that a buffer does not contain, with the frames that it contains."""
    missing = re.match(r'"([^"]+)" passed to', text)
    owners = (frame.f_locals.get("self") for frame, _ in walk_tb(error.__traceback__))
    buffer = next((owner for owner in owners if isinstance(owner, BufferCore)), None)
    if missing is None or buffer is None:
        return ""
    known = sorted(buffer.frames())
    catch = "A node that can continue without the frame catches TransformException."
    if not known:
        return (
            "the buffer is still empty. A listener fills it while its node is spun, so the first lookups "
            f"of a node fail. {catch}"
        )
    # Two exchanged letters of a short name, as in mpa, make it less similar than other mistakes.
    exchanged = (name for name in known if sorted(name) == sorted(missing[1]))
    if similar := near_names.nearest(missing[1], known) or next(exchanged, ""):
        return f"did you mean {similar!r}? The buffer contains it."
    more = "" if len(known) <= _MOST_FRAMES else " and others"
    return f"the buffer contains {join_words(known[:_MOST_FRAMES])}{more}, but not {missing[1]}. {catch}"


def _missing_value_hint(error: BaseException, text: str) -> str:
    """Return the hint for a call that passes too few values, or ""."""
    pattern = r"(\w+\.)?(\w+)\(\) missing (\d+) required positional arguments?: (.*)"
    match = re.match(pattern, text)
    if match is None or not isinstance(error, TypeError):
        return ""
    owner, name, count, values = match.groups()
    if owner and count != "1":
        return ""
    # After deleting the cell of a check, a student writes it again.
    if name == "check" and "'task_id'" in values:
        return 'pass the name of the task and your object, as in check("week01.red_cube", RedCubeNode).'
    start = f"the call passes no value for {values.replace(chr(39), '')}"
    line = line_of_student(error)
    # In create_timer(1.0, self.tick()) and key=score_of(), the function itself is meant.
    is_argument = re.search(rf"[(,=]\s*(?:self\.)?{name}\(\s*\)", line)
    if re.search(rf"\b{name}\(", line) and not re.search(r"\bdef\b", line) and not is_argument:
        return f"{start}: put it in ( )."
    if owner:
        return (
            f"{start}: put it in ( ). To pass the method itself, for ROS to call it, write "
            f"`self.{name}` without ()."
        )
    if is_argument:
        return f"{start}: put it in ( ). To pass the function itself, write {name} without ()."
    frame = frame_of(error)
    if frame is not None and is_of_library(reachable_object(frame, name)):
        return f"{start}: put it in ( )."
    return f"{start}. If check(…) makes the call, the function must take the arguments that the task names."


def _callback_hint(error: BaseException) -> str:
    """Return the hint for a callback that is given as a string, or as another value, or ""."""
    frame = frame_of(error)
    # The error may come from a function that create_subscription calls.
    steps = [step.f_locals for step, _ in walk_tb(error.__traceback__)]
    callback = next((names["callback"] for names in steps[::-1] if "callback" in names), None)
    is_called = re.match(r"'\w+' object is not callable", _text(error))
    if frame is not None and callback is None and is_called:
        # A timer accepts anything, and calls it when it is due.
        callback = getattr(frame.f_locals.get("entity"), "callback", None)
    if not isinstance(error, RuntimeError | TypeError):
        return ""
    if isinstance(callback, str) and (isinstance(error, RuntimeError) or is_called):
        return f"the callback is a function and not its name: write self.{callback}, without quotes."
    if is_called and callback is not None and not callable(callback):
        value = f"{callback!r:.40}, " if is_native(type(callback)) else ""
        return (
            f"the callback is {value}of type {type(callback).__name__}: is it an "
            "attribute with the name of a method, or is the callback another argument of the call?"
        )
    return ""


# The module of rclpy's stand-in that calls parameter callbacks.
_PARAMETER_FILE = "parameter_store.py"


def _parameter_callback_hint(error: BaseException, text: str) -> str:
    """Return the hint for a parameter callback with a wrong signature, or ""."""
    frame = frame_of(error)
    line = line_of_student(error)
    callers = [caller.f_code.co_filename for caller, _ in walk_tb(error.__traceback__)]
    is_callback = any(caller.endswith(_PARAMETER_FILE) for caller in callers)
    if is_callback and not callers[-1].endswith(_PARAMETER_FILE) and re.match(r"\s*raise\b", line):
        return (
            "an exception in this callback ends the node. To reject the value, write "
            "`return SetParametersResult(successful=False, reason='too large')`."
        )
    match = re.match(r"(?:\w+\.)*(\w+)\(\) (?:missing|takes) .*positional argument", text)
    if frame is None or match is None or not isinstance(error, TypeError):
        return ""
    if frame.f_code.co_filename.endswith(_PARAMETER_FILE):
        return f"the callback gets a list of parameters: write `def {match[1]}(self, parameters)`."
    return ""


def _recursion_hint(error: BaseException) -> str:
    """Return the hint for a function that calls itself endlessly, with its name, or ""."""
    if not isinstance(error, RecursionError):
        return ""
    frames = [frame for frame, _ in walk_tb(error.__traceback__)]
    if "set_parameters" in (frame.f_code.co_name for frame in frames):
        return (
            "set_parameters calls this callback again: leave it out. The parameter has its new "
            "value when the callback has returned `SetParametersResult(successful=True)`."
        )
    counts = Counter(frame.f_code for frame in frames if is_student_file(frame.f_code.co_filename))
    repeated = [code for code, count in counts.items() if count > _FEW_CALLS]
    if not repeated:
        return ""
    code, name = repeated[0], repeated[0].co_name
    if len(repeated) > 1:
        others = join_words(list(dict.fromkeys(other.co_name for other in repeated[1:])))
        return f"{name} calls {others}, which calls {name} again, endlessly: leave one of these calls out."
    if name == "__init__":
        return "__init__ creates or calls its own class again: begin it with super().__init__('a_name')."
    if name == "__getattr__":
        return "__getattr__ reads an attribute that is missing, and so calls itself: leave __getattr__ out."
    owner = next(frame.f_locals.get("self") for frame in frames if frame.f_code is code)
    for kind in type(owner).__mro__:
        own = vars(kind).get(name)
        if isinstance(own, property) and code in (
            getattr(method, "__code__", None) for method in (own.fget, own.fset)
        ):
            return f"self.{name} in the property {name} calls it again: keep the value in self._{name}."
    return f"{name} calls itself endlessly: leave this call out, or return before it in one case."


def _future_hint(error: BaseException) -> str:
    """Return the hint for the fields of a result that has not arrived yet, or ""."""
    if not isinstance(error, AttributeError):
        return ""
    for frame, number in walk_tb(error.__traceback__):
        above = linecache.getline(frame.f_code.co_filename, number)
        if called := re.search(r"\.add_done_callback\(\s*([\w.]+)\(", above):
            return f"add_done_callback gets the function itself, without ( ): add_done_callback({called[1]})."
    if isinstance(error.obj, Awaitable) and getattr(error.obj, "done", bool)() is True:
        return f"this future is done: the field is in its result, future.result().{error.name}."
    if error.obj is None and re.search(r"\.result\(\)\.\w", line_of_student(error)):
        return "the response has not arrived yet: `await future`, or `future.add_done_callback(f)`."
    return ""


def _base_class_hint(error: BaseException) -> str:
    """Return the hint for a class whose base is an object, because a variable has its name, or ""."""
    line = line_of_student(error)
    frame = frame_of(error)
    match = re.match(r"\s*class \w+\((\w+)\)", line)
    if match is None or frame is None or not isinstance(error, TypeError):
        return ""
    base = {**frame.f_globals, **frame.f_locals}.get(match[1])
    if base is None or isinstance(base, type | ModuleType):
        return ""
    return (
        f"{match[1]} is a variable here, {match[1]} = …, and hides the class {match[1]}: choose "
        "another name for it, and import the class again."
    )


def _file_hint(error: BaseException) -> str:
    """Return a question with the file name closest to a missing file's name, or ""."""
    missing = error.filename if isinstance(error, FileNotFoundError) else None
    if not isinstance(missing, str | Path) or len(str(missing)) > MAX_TEXT:
        return ""
    path = Path(missing)
    try:
        files = [one.name for one in path.parent.iterdir()]
    except OSError:
        return ""
    similar = near_names.nearest(path.name, files)
    return f"did you mean {str(path.with_name(similar))!r}? That file exists." if similar else ""


def _loop_hint(error: BaseException, text: str) -> str:
    """Return the hint for a message that is used as a list, or ""."""
    match = re.match(
        r"'(\w+)' object is not iterable|cannot unpack non-iterable ((?!Transform)\w+) object", text
    )
    name = (match[1] or match[2]) if match else ""
    # rclpy's own classes of these names are not messages.
    if not name or not isinstance(error, TypeError) or name in ("Time", "Duration", "Parameter"):
        return ""
    # A callback returned it to rclpy, which has a hint of its own.
    if name == "SetParametersResult" and not line_of_student(error):
        return ""
    frame, trace = frame_of(error), error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is not None and frame is not None:
        code = (step for step in dis.get_instructions(frame.f_code) if step.offset == trace.tb_lasti)
        if any(step.opname.startswith(("BINARY_OP", "INPLACE_ADD")) for step in code):
            return "+= adds all items of a list. `items.append(item)` adds a single item."
    types = _types_in_error(f"'{name}' object has no attribute")
    lists = [f.name for name in types[:1] for f in definition(name).fields if f.container != "scalar"]
    if types and len(lists) == 1:
        return f"a {name} is not a list, but has one: loop over its field {lists[0]}."
    return f"a {name} is a single object: read its fields by their names." if types else ""


# The parameters of Node's methods, in their order.
_CREATE_CALLS = {
    "create_service": "self.create_service(AddTwoInts, '/a_service', self.answer)",
    "create_client": "self.create_client(AddTwoInts, '/a_service')",
    "create_publisher": "self.create_publisher(Marker, '/a_topic', 10)",
    "create_subscription": "self.create_subscription(Marker, '/a_topic', self.on_message, 10)",
    "ActionServer": "ActionServer(self, Fibonacci, '/an_action', self.execute)",
    "ActionClient": "ActionClient(self, Fibonacci, '/an_action')",
}


def _order_hint(error: BaseException, text: str) -> str:
    """Return the hint for a call that passes the type or the name of a topic in the wrong position, or ""."""
    frame = frame_of(error)
    if "isinstance() arg 2" in text and frame is not None and frame.f_code.co_name == "publish":
        # rclpy accepts a message in place of its class until `publish` is called.
        return _type_hint(getattr(frame.f_locals.get("self"), "msg_type", None))
    texts = "rclpy_resolve_name|incompatible constructor arguments|no attribute '_TYPE_SUPPORT'"
    if not re.search(texts, text):
        return ""
    for caller, _ in walk_tb(error.__traceback__):
        # The method of a node that the frame runs, or the class of an action's end.
        call, variables = caller.f_code.co_name, caller.f_locals
        call = type(variables.get("self")).__name__ if call == "__init__" else call
        if call in _CREATE_CALLS:
            break
    else:
        return ""
    kind = variables.get("srv_type", variables.get("msg_type", variables.get("action_type")))
    name = variables.get("srv_name", variables.get("topic", variables.get("action_name")))
    # If the name is a string, the type is wrong: it is a string too, or an instance.
    if isinstance(name, str):
        return _type_hint(kind)
    position = "after the node, the type comes" if "Action" in call else "pass the type"
    return f"{position} first, then the name in quotes: `{_CREATE_CALLS[call]}`."


def _type_hint(kind: object) -> str:
    """Return the hint for a type of a topic or a service that is not a class, or ""."""
    if isinstance(kind, str) and (match := re.fullmatch(r"(\w+)/(?:(msg|srv|action)/)?(\w+)", kind)):
        line = f"from {match[1]}.{match[2] or 'msg'} import {match[3]}"
        return f"pass the class and not its name in quotes: `{line}`, then {match[3]}."
    if isinstance(kind, ModuleType):
        return f"{kind.__name__} is a module: pass the class of the messages, like Marker."
    if isinstance(kind, str) and kind.isidentifier():
        return f"pass the class and not its name: {kind}, without quotes."
    if hasattr(kind, "get_fields_and_field_types") and not isinstance(kind, type):
        name = type(kind).__name__
        return f"pass the class and not an object of it: {name}, without ( )."
    if isinstance(kind, type) and not hasattr(kind, "get_fields_and_field_types"):
        name = kind.__name__
        line = near_names.import_of_interface(name, "")
        return f"this {name} is of {kind.__module__}: import the message, `{line}`." if line else ""
    return ""


def _executor_hint(error: BaseException, text: str) -> str:
    """Return the hint for spin with several nodes, or with a node instead of a number, or ""."""
    frame = frame_of(error)
    callers = {caller.f_code.co_name for caller, _ in walk_tb(error.__traceback__)}
    if re.match(r"unhashable type: '(list|set)'", text) and {"spin", "spin_once", "add_node"} & callers:
        return (
            "one node is needed here, and this is a list. An executor runs several: call "
            "`executor.add_node(node)` for each of them, and then executor.spin()."
        )
    if frame is None or not hasattr(frame.f_locals.get("num_threads"), "create_publisher"):
        return ""
    return "the argument is the number of threads. Add the node: `executor.add_node(node)`."


# Python's messages about an operand or argument that must be a number or a string.
_OPERANDS = (
    r"unsupported operand type\(s\) for [^:]+: '(\w+)' and '(\w+)'",
    r"not supported between instances of '(\w+)' and '(\w+)'",
    r'can only concatenate str \(not "(\w+)"',
    r"must be (?:a string or a )?real number, not '?(\w+)",
    r"argument must be a string.*, not '(\w+)'",
    r"bad operand type for .*: '(\w+)'",
)
# Classes with hints of their own, in the table.
_OTHER_OPERANDS = {"Time", "Duration", "Parameter", "Point", "Vector3", "Quaternion"}


def _operand_hint(error: BaseException, text: str) -> str:
    """Return the hint for a message with which a program computes, or ""."""
    if not isinstance(error, TypeError):
        return ""
    match = next((found for pattern in _OPERANDS if (found := re.search(pattern, text))), None)
    # Two objects of one type that are compared have a hint of their own, in the table.
    names = match.groups() if match else ()
    for name in names if len(set(names)) == len(names) else ():
        types = [] if name in _OTHER_OPERANDS else _types_in_error(f"'{name}' object has no attribute")
        fields = [field.name for field in definition(types[0]).fields] if types else []
        if name == "ParameterValue":
            return (
                "a ParameterValue can hold any type. The value itself is `self.get_parameter('known').value`."
            )
        if len(fields) == 1:
            return f"one side is a message, {name}: use its field {fields[0]}."
        if fields and "between instances" not in text:
            return f"one side is a message, {name}: use its fields {join_words(fields)}."
    return ""


def _request_hint(error: BaseException) -> str:
    """Return the hint for a service client that is called with a value other than a request, or ""."""
    frame = frame_of(error)
    service = getattr(frame.f_locals.get("self"), "srv_type", None) if frame is not None else None
    if mistake_of(error) is not Mistake.REQUEST or service is None:
        return ""
    fields = service.Request.get_fields_and_field_types()
    samples = {"boolean": "True", "string": "'text'", "float": "1.0", "double": "1.0"}
    simple = [
        f"{name}={samples.get(kind, 1)}"
        for name, kind in fields.items()
        if "/" not in kind and "<" not in kind
    ]
    arguments = ", ".join(simple) if len(simple) == len(fields) else ""
    return f"pass a request, with (): `{service.__name__}.Request({arguments})`."


def _missing_self_hint(error: NameError, text: str) -> str:
    """Return the hint for a method that uses `self` but does not have it as its first parameter."""
    frame = frame_of(error)
    if frame is None or "name 'self' is not" not in text:
        return ""
    code = frame.f_code
    if "__qualname__" in frame.f_locals:
        return "only methods have self: move this line into `def __init__(self)` of the class."
    if not code.co_name.isidentifier():
        return "only methods have self: outside of the class use the name of your node."
    parameters = code.co_varnames[: code.co_argcount]
    remaining_parameters = (
        parameters[1:] if parameters and parameters[0] in ("this", "node", "robot") else parameters
    )
    return (
        "write self as the method's first parameter: `def "
        f"{code.co_name}({', '.join(('self', *remaining_parameters))})`."
    )


def _text(error: BaseException) -> str:
    """Return the text of an error, or "".

    The `__str__` of a student's exception class may itself raise.
    """
    try:
        return str(error)[:MAX_TEXT]
    except (Exception, SystemExit):
        return ""


def _types_of(error: BaseException, text: str) -> list[str]:
    """Return the message types with the class name in an attribute error, the error's own type first."""
    owner = error.obj if isinstance(error, AttributeError) else None
    kind = owner if isinstance(owner, type) else type(owner)
    # Python keeps the object of an attribute that is read, but not of one that is set.
    frame = frame_of(error)
    values = {**frame.f_globals, **frame.f_locals}.values() if frame is not None else ()
    for candidate in (kind, *(type(value) for value in values if owner is None)):
        if hasattr(candidate, "_TYPE_NAME") and f"'{candidate.__name__}'" in text:
            return [candidate._TYPE_NAME]
    package = kind.__module__.partition(".")[0]
    return sorted(_types_in_error(text), key=lambda name: name.partition("/")[0] != package)


def _types_in_error(text: str) -> list[str]:
    """Return the message types with the class name in an attribute error."""
    match = re.match(r"(?:type object )?'(\w+)' (?:object )?has no attribute", text)
    types = [name for name in type_names() if match and name.endswith(f"/{match[1]}")]
    # example_interfaces repeats the types of std_msgs, which are more likely to be meant.
    return near_names.sort_by_likelihood(types)


def _paths_to(name: str, attribute: str) -> list[str]:
    """Return the paths to a field inside of a message's fields, like "results[0].hypothesis.score".

    The shortest paths come first. Fields of the header are no candidates deep inside.
    """
    paths, level = list[str](), [("", name)]
    # Messages in messages are rarely deeper; a path would not help a beginner then.
    for _ in range(3):
        inside = [
            (f"{path}{field.name}{'' if field.container == 'scalar' else '[0]'}.", field)
            for path, type_name in level
            for field in definition(type_name).fields
            if field.is_message
        ]
        level = [(path, field.base) for path, field in inside]
        paths += [
            f"{path}{attribute}"
            for path, type_name in level
            if any(field.name == attribute for field in definition(type_name).fields)
        ]
    return paths
