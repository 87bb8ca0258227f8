"""Hints: one line that helps with a common mistake, below the text of ROS or Python.

A hint is keyed by the type of the exception, its text, and the mistake with which the raising code marks it
where the text alone does not tell.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches

from course_lib.ros.messages.definitions import FieldDefinition, definition, type_names
from course_lib.ros.mistakes import Mistake, mistake_of
from course_lib.ros.not_offered import not_offered

MAX_TEXT = 2000  # characters of an error's text


@dataclass(frozen=True)
class Hint:
    """The hint for exceptions whose text matches, and that are marked with `mistake` if there is one."""

    text: str
    hint: str  # may name the text's groups: {1}
    mistake: Mistake | None = None


_NAMED = "super().__init__('a_name'), in def __init__ with two underscores on each side"
_HINTS: Mapping[str, tuple[Hint, ...]] = {
    "AttributeError": (
        Hint(
            r"'(\w+)' object has no attribute '_(Node__handle|default_callback_group|logger|parameter)",
            "call super().__init__('a_name') first in {1}.__init__().",
        ),
        Hint("'NoneType' .* 'level'", "end the task's function with: return stat.", Mistake.NO_STATUS),
        Hint("'Viewer' object .* '(show|display|render)'", "write viewer alone as the last line."),
        Hint("'Time' .* 'nanoseconds'", "write Time.from_msg(stamp), with rclpy's Time.", Mistake.STAMP),
        Hint("'str' has no attribute '_TYPE_SUPPORT'", "give the class: from std_msgs.msg import String."),
        Hint("'Future' object has no attribute", "it comes later: await it, or add_done_callback(f)."),
        Hint(
            "'NoneType' .* 'successful'",
            "end the callback with: return SetParametersResult(successful=True).",
        ),
        Hint("'NoneType' .* 'to_label'", "end the callback with: return TransitionCallbackReturn.SUCCESS."),
        Hint("^'(list|tuple)' object", "it holds several: take one, like [0], or go through it with for."),
        Hint(r"property 'enabled' of '\w+' object has no setter", 'write display["Enabled"] = False.'),
    ),
    "RecursionError": (Hint("", "a function calls itself without an end, or two call each other."),),
    "NameError": (
        Hint("name 'self' is not", "write self as the method's first parameter: def heard(self, msg)."),
        Hint(
            r"name '(\w+)' is not defined",
            "define or import {1} first; in a notebook run the cells above, from the first one on.",
        ),
    ),
    "TypeError": (
        Hint(r"Node.__init__\(\) missing .* 'node_name'", f"name the node: {_NAMED}."),
        Hint(
            "'NoneType' object is not callable",
            "give the function itself, without (): self.tick, not self.tick().",
            Mistake.NO_CALLBACK,
        ),
        Hint(
            r"Expected <class '(?:std_msgs|example_interfaces)\..*\.(\w+)'>, got <class '(?:str|int|float)'>",
            "put it into a message: {1}(data=...).",
        ),
        Hint(
            r"Expected <class '.*\.(\w+)'>, got <class '(?:str|int|float|bool|list|NoneType)'>",
            "publish a message: make one with {1}(), and fill in its fields.",
        ),
        Hint(r"Expected <class '.*\.(\w+)'>, got <class 'type'>", "make an object: {1}(), with ()."),
        Hint(r"Expected <class '.*\.(\w+)'>, got", "publish a {1}, or make a publisher for the other type."),
        Hint(
            "rclpy_resolve_name",
            "the type first, then the name in quotes: create_publisher(Marker, '/a_topic', 10).",
        ),
        Hint("missing .* 'qos_profile'", "say how many messages are kept, like 10, as the last argument."),
        Hint("Expected QoSProfile or int", "say how many messages are kept, like 10."),
        Hint("'Parameter' and", "ask for its value: get_parameter('a_name').value."),
        Hint("one of the allowed types", "bool, int, float, str, or lists."),
        Hint("^$", "give a request, with (): AddTwoInts.Request(a=1, b=2).", Mistake.REQUEST),
        Hint("^$", "end the service's callback with: return response.", Mistake.RESPONSE),
        Hint("^$", "give a goal, with (): Fibonacci.Goal(order=5).", Mistake.GOAL),
        Hint("positional arg", "write def answer(self, request, response).", Mistake.SERVICE_CALLBACK),
        Hint("missing", "a timer gives no argument: write def tick(self).", Mistake.TIMER_CALLBACK),
        Hint(
            "must be a string or a real number",
            "first the period in seconds, then the function: create_timer(1.0, self.tick).",
            Mistake.PERIOD,
        ),
        Hint("requires a 'super' object", "write super().__init__('a_name'), with () after super."),
        Hint("'Viewer' object does not support item assignment", 'write viewer.fixed_frame = "map".'),
        Hint("spin.* missing .* 'node'", "say which node: rclpy.spin(node)."),
        Hint("rclpy_logging_rcutils_log", "write one f-string: info(f'speed: {{speed}}')."),
        Hint(r"RcutilsLogger.\w+\(\) takes 2", "write one f-string: info(f'speed: {{speed}}')."),
        Hint("with different clock types", "write Time(clock_type=ClockType.ROS_TIME)."),
        Hint("instances of 'Time' and", "compare with a Time or a Duration: Duration(seconds=5.0)."),
        Hint("-: 'Time' and 'Time'", "messages cannot be subtracted: Time.from_msg(stamp) can."),
        Hint("'Time' and", "add or subtract a Duration: Duration(seconds=1.0)."),
        Hint(r"(\w+).__init__.* takes 1 pos", "name what you give: {1}(data=...).", Mistake.UNNAMED_FIELD),
        Hint(r"(Duration|Time).__init__\(\) takes 1 positional", "name what you give: {1}(seconds=1.0)."),
        Hint(r"\w\.(\w+)\(\) takes 0 positional", "write self first: def {1}(self)."),
        Hint(r"\w\.(\w+)\(\) takes (\d+) positional arguments? but", "is self first in def {1}(self, ...)?"),
    ),
    "RuntimeError": (
        Hint("Task got bad yield: <rclpy", "in a cell: rclpy.spin_until_future_complete(node, future)."),
        Hint(
            r"Subscription.__init__\(\): callback",
            "write def heard(self, msg), and give self.heard, without ().",
        ),
        Hint("init.. must only be called once", "one rclpy.init() per program; rclpy.ok() says if it was."),
        Hint("must be initialized before it can be shutdown", "rclpy.try_shutdown() never complains."),
        Hint("The (message|service|action) type provided", "they are in .msg, .srv and .action."),
    ),
    "RCLError": (
        Hint("timer period must be non-negative", "give the period in seconds, like 0.1 for 10 Hz."),
        Hint("rcl_shutdown already called", "rclpy.try_shutdown() never complains."),
    ),
    "ValueError": (
        Hint("statically typed parameter", "give a default value, or a type: Parameter.Type.DOUBLE."),
        Hint("generator already executing", "a callback must not spin: use await, or add_done_callback."),
        Hint("could not convert string to float", "give the period in seconds, as a number.", Mistake.PERIOD),
        Hint("severity cannot be changed between calls", "write one line for each severity."),
    ),
    "AssertionError": (
        Hint(
            "'([rgba])' field must be of type 'float'",
            "colours go from 0.0 to 1.0: write 1.0, not 1.",
        ),
        Hint("field must be of type 'float'", "write the number with a point: 1.0, or float(x)."),
        Hint("'(type|action)' field must be of type 'int'", "give a constant, like Marker.CUBE."),
        Hint("field must be of type 'int'", "write int(x), or round(x)."),
        Hint("'frame_id' field must be of type 'str'", 'write the name of the frame in quotes: "map".'),
        Hint("field must be of type 'str'", "write str(x), or an f-string."),
        Hint("'level' field must be of type 'bytes'", "write DiagnosticStatus.OK, WARN, ERROR or STALE."),
        Hint("sub message of type '.*_Result'", "end the callback with return MyAction.Result()."),
        Hint(
            "sub message of type 'Time'",
            "write self.get_clock().now().to_msg(), where self is the node.",
        ),
        Hint(
            "sub message of type 'Duration'", "write Duration(seconds=1.0).to_msg(), with rclpy's Duration."
        ),
        Hint("sub message of type 'Quaternion'", "Quaternion(z=sin(yaw / 2), w=cos(yaw / 2))."),
        Hint(r"sub message of type '(\w+)'", "make one, with names: {1}(x=1.0, ...)."),
        Hint("each value of type 'float'", "write floats into the list: 0.0 instead of 0."),
        Hint("each value of type '(int|str|bool|bytes)'", "give a list of {1}s."),
        Hint(r"each value of type '(\w+)'", "give a list of them: [{1}(x=1.0, ...)]."),
        Hint("Invalid arguments passed to constructor: dict_keys", "it takes depth, reliability, ..."),
        Hint(
            "Invalid arguments passed to constructor",
            "the message has no such field: %ros2 interface show lists them.",
        ),
    ),
    "FileNotFoundError": (
        Hint(r"'[^']*\.rviz'", "save the layout there first: viewer.save_rviz('a_name.rviz'), or Ctrl+S."),
    ),
    "NotImplementedError": (Hint("Service classes can not", "make its request: AddTwoInts.Request(a=1)."),),
    "InvalidArgumentException": (
        Hint("cannot start with a '/'", "write the frame's name without the slash."),
        Hint("cannot be empty", "fill in header.frame_id."),
    ),
    "ExtrapolationException": (
        Hint("into the future", "ask for the latest one, Time(), or give a timeout."),
    ),
    "TypeException": (
        Hint("is not loaded or supported", "import tf2_geometry_msgs: it knows points and poses."),
    ),
    "ImportError": (
        Hint(
            "cannot import name 'WString'", "the kit has no wide strings; String holds all characters, too."
        ),
        Hint(
            r"cannot import name '(\w+)' from '(\w+_(msgs|srvs|interfaces))'",
            "write from {2}.msg import {1}, or .srv, or .action.",
        ),
        Hint(
            r"cannot import name '\w+' from '(\w+).(msg|srv|action)'",
            "%ros2 interface package {1} lists its types.",
        ),
    ),
    "ModuleNotFoundError": (
        Hint(r"No module named '(\w+)_msgs'", "put the folder {1}_msgs with its msg beside the program."),
    ),
}
_WORDS = "use letters, digits and underscores"
_OF_TYPE: Mapping[str, str] = {  # with any text
    "InvalidTopicNameException": f"{_WORDS}, and begin with a letter, like robot/front_camera.",
    "InvalidServiceNameException": f"{_WORDS}, and begin with a letter, like robot/reset.",
    "InvalidNodeNameException": f"{_WORDS}, like front_camera; the rest is for namespace=.",
    "InvalidNamespaceException": f"{_WORDS}, and begin with a letter, like /robot_1.",
    "InvalidHandle": "it was destroyed before; make a new one, or destroy it later.",
    "NotInitializedException": "call rclpy.init() first.",
    "ParameterAlreadyDeclaredException": "declare it once, in __init__; set_parameters changes it.",
    "ParameterNotDeclaredException": "declare it first: self.declare_parameter('a_name', 1.0).",
    "ParameterUninitializedException": "declare it with a default value, or set it before.",
    "LookupException": "is the frame published, spelt so? %ros2 run tf2_tools view_frames.",
    "ConnectivityException": "a transform between two trees is missing: %ros2 run tf2_tools view_frames.",
    "InvalidQoSProfileException": "say how many messages are kept: depth=10.",
}


def add_hint(error: BaseException) -> None:
    """Add a line "hint: ..." to an error that is a common mistake, once."""
    found = hint(error)
    if found and not getattr(error, "__notes__", None):
        error.add_note(f"hint: {found}")


def hint(error: BaseException) -> str:
    """Return the hint for an exception; "" if there is none."""
    mistake = mistake_of(error)
    text = _text(error)
    types = _types_named(text) if isinstance(error, NameError) else []
    if types:
        package, kind, name = types[0].split("/")
        return f"import it: from {package}.{kind} import {name}; in a notebook run the first cells again."
    if isinstance(error, ModuleNotFoundError) and (reason := not_offered((error.name or "").split(".")[0])):
        return reason
    for one in _HINTS.get(type(error).__name__, ()):
        match = re.search(one.text, text)
        if match and one.mistake in (None, mistake):
            return one.hint.format(match[0], *match.groups())
    if type(error).__name__ in _OF_TYPE:
        return _OF_TYPE[type(error).__name__]
    if types := _types_named(text):
        return f"{_meant(text, types)}%ros2 interface show {' or '.join(types)} lists its fields."
    return _of_own_class(error, text)


def _text(error: BaseException) -> str:
    """Return the text of an error; an error of the student's own class may raise another one here."""
    try:
        return str(error)[:MAX_TEXT]
    except (Exception, SystemExit):
        return ""


def _types_named(text: str) -> list[str]:
    """Return the types of messages that have the name of which an error complains."""
    named = re.match(
        r"(?:type object )?'(\w+)' (?:object )?has no attribute|name '(\w+)' is not defined", text
    )
    return [name for name in type_names() if named and name.endswith(f"/{named[1] or named[2]}")]


def _meant(text: str, types: list[str]) -> str:
    """Return a question for the field or constant nearest to the one that is not there, or ""."""
    wanted = text.rpartition("attribute '")[2].partition("'")[0]
    found = [definition(name) for name in types]
    inner = [f"{field.name}.{wanted}" for one in found for field in one.fields if _has(field, wanted)]
    names = [name for one in found for name in (*one.constants, *(field.name for field in one.fields))]
    close = inner or get_close_matches(wanted, names)
    return f"did you mean {close[0]}? " if close else ""


def _has(field: FieldDefinition, wanted: str) -> bool:
    """Return whether a field is a message with a field of this name."""
    scalar = field.is_message and field.container == "scalar"
    return scalar and any(inner.name == wanted for inner in definition(field.base).fields)


def _of_own_class(error: BaseException, text: str) -> str:
    """Return the hint for an attribute that an object of the program's own class has not."""
    named = re.match(r"'(\w+)' object has no attribute '(\w+)'$", text)
    own = named and getattr(type(getattr(error, "obj", None)), "__module__", "") == "__main__"
    return f"set self.{named[2]} in {named[1]}.__init__, spelled the same." if named and own else ""
