"""Suggestions for misspelled names: the closest name that the failing line could have used.

Python itself suggests such names below a traceback, but IPython prints tracebacks without them, and
Python cannot suggest names that are not imported yet or, before 3.12, `self.name`.
"""

import ast
import builtins
import dis
import importlib
import inspect
import keyword
import linecache
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from pkgutil import iter_modules
from traceback import walk_tb
from types import CodeType, FrameType, FunctionType, MethodType, ModuleType

from course_lib.errors import join_words
from course_lib.ros import shadowing_hints, syntax_hints
from course_lib.ros.messages.definitions import definition, type_names
from course_lib.ros.student_code import (
    KIT,
    frame_of,
    is_launch_file,
    is_student_class,
    is_student_file,
    line_of_student,
    public_attributes,
    reachable_object,
)

# Names other than messages that ROS programs import. In a launch file, its own names take
# precedence.
IMPORTS = {
    "Node": "from rclpy.node import Node",
    "rclpy": "import rclpy",
    "Duration": "from rclpy.duration import Duration",
    "Time": "from rclpy.time import Time",
    "QoSProfile": "from rclpy.qos import QoSProfile",
    "ReliabilityPolicy": "from rclpy.qos import ReliabilityPolicy",
    "DurabilityPolicy": "from rclpy.qos import DurabilityPolicy",
    "qos_profile_sensor_data": "from rclpy.qos import qos_profile_sensor_data",
    "Parameter": "from rclpy.parameter import Parameter",
    "Buffer": "from tf2_ros import Buffer",
    "TransformListener": "from tf2_ros import TransformListener",
    "TransformBroadcaster": "from tf2_ros import TransformBroadcaster",
    "StaticTransformBroadcaster": "from tf2_ros import StaticTransformBroadcaster",
    "TransformException": "from tf2_ros import TransformException",
    "LookupException": "from tf2_ros import LookupException",
    "ConnectivityException": "from tf2_ros import ConnectivityException",
    "ExtrapolationException": "from tf2_ros import ExtrapolationException",
    "MultiThreadedExecutor": "from rclpy.executors import MultiThreadedExecutor",
    "SingleThreadedExecutor": "from rclpy.executors import SingleThreadedExecutor",
    "ExternalShutdownException": "from rclpy.executors import ExternalShutdownException",
    "ReentrantCallbackGroup": "from rclpy.callback_groups import ReentrantCallbackGroup",
    "ActionClient": "from rclpy.action import ActionClient",
    "ActionServer": "from rclpy.action import ActionServer",
    "CvBridge": "from cv_bridge import CvBridge",
    "tf_transformations": "import tf_transformations",
    "quaternion_from_euler": "from tf_transformations import quaternion_from_euler",
    "euler_from_quaternion": "from tf_transformations import euler_from_quaternion",
    "math": "import math",
    "pi": "from math import pi",
    "np": "import numpy as np",
    "numpy": "import numpy",
    "Path": "from pathlib import Path",
}
LAUNCH_IMPORTS = {
    "Node": "from launch_ros.actions import Node",
    "LaunchDescription": "from launch import LaunchDescription",
    "DeclareLaunchArgument": "from launch.actions import DeclareLaunchArgument",
    "IncludeLaunchDescription": "from launch.actions import IncludeLaunchDescription",
    "LaunchConfiguration": "from launch.substitutions import LaunchConfiguration",
    "PathJoinSubstitution": "from launch.substitutions import PathJoinSubstitution",
    "FindPackageShare": "from launch_ros.substitutions import FindPackageShare",
}
# Names that are suggested in launch files only, by the module that has them.
_NAMES_OF_LAUNCH = {
    "launch.actions": (
        *("ExecuteProcess", "GroupAction", "LogInfo", "OpaqueFunction", "RegisterEventHandler", "Shutdown"),
        *("AppendEnvironmentVariable", "SetEnvironmentVariable", "SetLaunchConfiguration", "TimerAction"),
    ),
    "launch.conditions": ("IfCondition", "UnlessCondition"),
    "launch.event_handlers": ("OnProcessExit", "OnProcessStart", "OnShutdown"),
    "launch.launch_description_sources": (
        *("AnyLaunchDescriptionSource", "FrontendLaunchDescriptionSource", "PythonLaunchDescriptionSource"),
    ),
    "launch.substitutions": (
        *("Command", "EnvironmentVariable", "FindExecutable", "PythonExpression", "TextSubstitution"),
        *("ThisLaunchFileDir", "EqualsSubstitution", "IfElseSubstitution", "NotEqualsSubstitution"),
    ),
    "launch_ros.actions": (
        *("ComposableNodeContainer", "LifecycleNode", "LoadComposableNodes", "PushRosNamespace"),
        *("SetParameter", "SetParametersFromFile", "SetRemap", "SetUseSimTime"),
    ),
    "launch_ros.descriptions": ("ComposableNode",),
    "launch_ros.parameter_descriptions": ("ParameterFile", "ParameterValue"),
    "ament_index_python.packages": ("get_package_share_directory", "get_package_share_path"),
}
IN_LAUNCH_FILES = LAUNCH_IMPORTS | {
    name: f"from {module} import {name}" for module, names in _NAMES_OF_LAUNCH.items() for name in names
}
_KIT = ("course_lib", "course_lib.robots", "course_lib.displays", "course_lib.sensors")
# Methods of a Buffer of tf2.
OF_BUFFER = ("can_transform", "lookup_transform", "lookup_transform_async", "transform", "set_transform")
# Modules that students use without having imported them. Other names, like `time`, also occur in
# rclpy.
_STDLIB = ("time", "os", "sys", "random", "json", "copy", "re", "datetime", "threading", "itertools")
# Fields by their everyday names, and by their names in other libraries.
_SYNONYMS = {
    "size": ("scale", "dimensions"),
    "scale": ("size",),
    "dimensions": ("size", "scale"),
    "red": ("r",),
    "green": ("g",),
    "blue": ("b",),
    "alpha": ("a",),
    "opacity": ("a",),
    "transparency": ("a",),
    "rotation": ("orientation",),
    "orientation": ("rotation",),
    "translation": ("position",),
    "pose": ("transform", "center"),
    "transform": ("pose",),
    "position": ("translation", "center"),
    "label": ("class_id", "text", "name"),
    "class_name": ("class_id",),
    "confidence": ("score",),
    "probability": ("score",),
    "frame": ("frame_id",),
    "parent": ("header.frame_id",),
    "child": ("child_frame_id",),
    "time": ("stamp", "time_from_start"),
    "timestamp": ("stamp",),
    "secs": ("sec",),
    "nanoseconds": ("nanosec",),
    "nsec": ("nanosec",),
    "nsecs": ("nanosec",),
    "namespace": ("ns",),
    "duration": ("lifetime", "time_from_start"),
    "vertices": ("points",),
    "names": ("joint_names",),
    "joints": ("joint_names", "name"),
    "angles": ("positions", "position"),
    "distances": ("ranges",),
    "speed": ("velocity", "linear"),
    "battery": ("percentage",),
    "charge": ("percentage",),
    "msg": ("data",),
    "value": ("data",),
}
# Angles, which students expect in a quaternion.
ANGLES = ("yaw", "roll", "pitch", "angle", "heading", "theta")
# Packages whose messages are meant if others have some of the same name, the likeliest one first.
COMMON = ("std_msgs", "geometry_msgs", "visualization_msgs", "sensor_msgs", "nav_msgs", "builtin_interfaces")
# Words of other languages, with the names for them in Python.
_OTHER_LANGUAGES = {
    **dict.fromkeys(("null", "nullptr", "NULL", "Null", "nil", "undefined"), "None"),
    "this": "self",
    **dict.fromkeys(("printf", "fprintf", "println", "cout", "console", "System", "disp", "puts"), "print"),
    **dict.fromkeys(("length", "numel", "strlen", "sizeof"), "len"),
    **dict.fromkeys(("String", "string", "char"), "str"),
    **dict.fromkeys(("boolean", "Boolean"), "bool"),
    "double": "float",
}
_ENDS = {"end", "endif", "endfor", "endwhile", "endfunction", "fi", "done"}
# Modules of ROS 1, with their replacements in ROS 2.
ROS_1 = {
    "rospy": "its library for Python is `import rclpy`",
    "roslib": "its library for Python is `import rclpy`",
    "roscpp": "its library for Python is `import rclpy`",
    "actionlib": "actions are in `from rclpy.action import ActionClient`",
    "tf": "write `import tf2_ros`, and for angles `import tf_transformations`",
    "tf2": "write `import tf2_ros`",
    "rosbag": "bags are read by `import rosbag2_py`",
    "rospkg": "packages are found by `from ament_index_python.packages import get_package_share_directory`",
    "roslaunch": "launch files use `from launch import LaunchDescription`",
    "dynamic_reconfigure": "every node has parameters: `self.declare_parameter('speed', 1.0)`",
    "rviz": "here the view is `from course_lib import Viewer`",
    "rviz2": "here the view is `from course_lib import Viewer`",
    "ros2": "its library for Python is `import rclpy`",
    "ros": "its library for Python is `import rclpy`",
}


def sort_by_likelihood(types: Iterable[str]) -> list[str]:
    """Sort message types: of types with the same name, like Point, common packages come first."""
    ranks = {package: rank for rank, package in enumerate(COMMON)}
    return sorted(types, key=lambda name: ranks.get(name.partition("/")[0], len(COMMON)))


def nearest(missing: str, names: Iterable[str], cutoff: float = 0.75) -> str:
    """Return the name that differs only in case and underscores, otherwise the most similar name, or ""."""
    candidates = [name for name in dict.fromkeys(names) if name != missing and not name.startswith("_")]
    plain = missing.lower().replace("_", "")
    same = [name for name in candidates if name.lower().replace("_", "") == plain]
    return next(iter([*same, *get_close_matches(missing, candidates, 1, cutoff)]), "")


def name_hint(error: NameError) -> str:
    """Return the hint for a name that is undefined or has no value yet, or "" if no name is similar."""
    match = re.search(r"(?:name|variable) '(\w+)'", str(error))
    frame = frame_of(error)
    if match is None or frame is None:
        return ""
    missing = match[1]
    line = line_of_student(error)
    if found := _line_hint(missing, line, frame):
        return found
    owner = public_attributes(frame.f_locals.get("self"))
    if missing in owner and not (isinstance(error, UnboundLocalError) and _is_set_before(error, missing)):
        return f"did you mean `self.{missing}`?"
    if isinstance(error, UnboundLocalError):
        if callable(frame.f_globals.get(missing)) or isinstance(frame.f_globals.get(missing), ModuleType):
            return f"{missing} = … in this function hides the {missing} defined above: choose another name."
        if missing in frame.f_globals:
            return (
                f"a function that assigns {missing} has a {missing} of its own. Keep the value in "
                f"the node, as `self.{missing}`, or write `global {missing}` first."
            )
        if re.match(rf"\s*{missing}\s*=.*\b{missing}[.(]", line):
            own = f"{missing} on the right is the variable of this line, which has no value yet"
            return f"{own}. If a module or a function {missing} is meant, choose another name on the left."
        return _unset_variable_hint(missing, frame)
    # One letter too many, like Points, is more likely than a class of the kit that no cell imports.
    singular = missing.removesuffix("s")
    if singular != missing and singular in frame.f_globals and missing not in IMPORTS:
        return f"did you mean `{singular}`?"
    if re.fullmatch(r"week\d\d", missing):
        return 'the name of a task is in quotes, as in check("week01.red_cube", RedCubeNode).'
    importable = _importable(frame)
    if missing in ROS_1:
        return f"there is no {missing} in ROS 2: {ROS_1[missing]}."
    if found := _other_function_hint(missing, frame):
        return found
    # A launch file is a separate program, which cannot use the cells of a notebook.
    again = "." if is_launch_file(frame) else "; in a notebook run the first cells again."
    if missing in importable:
        return f"import it: `{importable[missing]}`{again}"
    if missing in interfaces() or (missing in known_packages() and "_" in missing):
        module = f"{missing}.{next(iter(interfaces()[missing]))}" if missing in interfaces() else missing
        return f"import it: `import {module}`{again}"
    return _similar_name(error, missing, frame, owner, importable)


def _unset_variable_hint(missing: str, frame: FrameType) -> str:
    """Return the hint for a variable without a value, which an `except` may have skipped."""
    try:
        tree = ast.parse("".join(linecache.getlines(frame.f_code.co_filename)))
    except SyntaxError:  # a cell with a magic
        tree = ast.Module([], [])
    for node in ast.walk(tree):
        targets = list(ast.walk(node.target)) if isinstance(node, ast.For) else []
        names = [part.id for part in targets if isinstance(part, ast.Name)]
        if missing in names and getattr(node, "lineno", 0) > frame.f_lineno:
            return f"{missing} gets its values in the for loop below: move this line into the loop."
        body = node.body if isinstance(node, ast.Try) else []
        stored = [name for part in body for name in ast.walk(part) if isinstance(name, ast.Name)]
        if not any(name.id == missing and isinstance(name.ctx, ast.Store) for name in stored):
            continue
        for handler in getattr(node, "handlers", []):
            if not isinstance(handler.body[-1], ast.Return | ast.Raise | ast.Continue | ast.Break):
                head = ast.unparse(handler).splitlines()[0]
                return (
                    f'the line that sets {missing} raised an error, and after "{head}" the '
                    "function goes on without a value: end the except with return."
                )
    return f"give {missing} a value before this line, on every path that leads here."


def _line_hint(missing: str, line: str, frame: FrameType) -> str:
    """Return the hint for an undefined name whose spelling or line shows the mistake, or ""."""
    if found := syntax_hints.foreign_letter(missing):
        return f"{found}: type the name again."
    for name, value in frame.f_globals.items():
        if isinstance(value, ModuleType) and value.__name__ == missing:
            return f"the module {missing} is imported as {name}: write {name} in place of {missing}."
    if missing == "main":
        return "main is not defined: write `def main()` with the lines to run, or call your own function."
    # The cells with checks are given, so the name is right unless it was edited.
    is_given = re.match(rf'\s*check\("[\w.]+", {missing}\)', line)
    if is_given and not nearest(missing, frame.f_globals, 0.9):
        return f"run the cell that defines {missing} first. Did it end with an error?"
    if missing.startswith("create_") and "__qualname__" in frame.f_locals:
        return f"write self.{missing}(…) in def __init__: it is a method of a node."
    if re.match(rf"\s*{missing}\s*==", line):
        return f"== compares. To set a value, write a single =, as in {missing} = 1.0."
    if re.search(rf"[{{,]\s*{missing}\s*:", line) and "lambda" not in line:
        return f"a key of a dictionary is a string, in quotes: {missing!r}."
    if missing in _ENDS and line.strip().rstrip(";") == missing:
        return f"a block ends where its lines are no longer indented: delete {missing}."
    return ""


def _similar_name(
    error: NameError,
    missing: str,
    frame: FrameType,
    owner: Sequence[str],
    importable: Mapping[str, str],
) -> str:
    """Return the hint for a name that no import defines, with the most similar name that exists."""
    for name, module in frame.f_globals.items():
        if (
            isinstance(module, ModuleType)
            and name in ("math", "np", "numpy", "rclpy")
            and not isinstance(getattr(module, missing, module), ModuleType)
        ):
            return f"did you mean `{name}.{missing}`?"
    if found_constant := _constant_of(missing, frame.f_globals):
        return f"did you mean `{found_constant}`?"
    line = line_of_student(error)
    if found := _call_hint(missing, line, frame):
        return found
    if holder := holder_of_field(missing, frame):
        return f"did you mean `{holder}.{missing}`?"
    if found := _similar_variable(missing, frame):
        return found
    # The cell above has not run, or it stopped with an error.
    if re.search(rf"\b(?:check\(\s*['\"][\w.]+['\"],\s*|run_live\(|spin_for\([\d.]+,\s*){missing}\b", line):
        return f"run the cell above that defines {missing} first, and see whether it ends with an error."
    if re.search(rf"//\s*{missing}\s*$", line):
        return f"if {missing} is a comment, begin it with #: // divides."
    if missing in _OTHER_LANGUAGES:
        return f"Python's name for it is `{_OTHER_LANGUAGES[missing]}`."
    if similar := _find_abbreviation(missing, frame):
        return f"did you mean `{similar}`?"
    own_names = getattr(frame.f_locals.get("self"), "__dict__", {})
    # A method of rclpy has to be more similar than a name that the student chose.
    if similar := nearest(missing, own_names) or nearest(missing, owner, 0.85):
        return f"did you mean `self.{similar}`?"
    # A slip is rarely in the first letter: wall does not mean all.
    words = [name for name in (*vars(builtins), *keyword.kwlist) if name[0].lower() == missing[0].lower()]
    if similar := nearest(missing, words, 0.8):
        return f"did you mean `{similar}`?"
    return _import_hint(missing, importable, line) or _origin_hint(missing, frame)


def holder_of_field(name: str, frame: FrameType) -> str:
    """Return the only local variable, a message, that has a field of this name, or ""."""
    fields: dict[str, Mapping[str, str]] = {
        key: getattr(type(value), "get_fields_and_field_types", dict)()
        for key, value in frame.f_locals.items()
        if key != "self" and key.isidentifier() and frame.f_code.co_name.isidentifier()
    }
    holders = [key for key, names in fields.items() if name in names]
    return holders[0] if len(holders) == 1 else ""


def _origin_hint(missing: str, frame: FrameType) -> str:
    """Return a hint that asks where a name without a similar one is defined, or ""."""
    if is_launch_file(frame):
        return f"no line of the launch file defines {missing}. Strings need quotes."
    code = frame.f_code
    names = [name for name in code.co_varnames[: code.co_argcount] if name != "self"]
    # The code outside of functions has a name like <module>.
    if names and code.co_name.isidentifier():
        # A program is a file, and a cell has a name that IPython makes up.
        is_program = os.path.isfile(code.co_filename)
        where = "defined outside of it" if is_program else "that cells of this notebook define"
        return f"{code.co_name} can use {join_words(names)}, and names {where}. Where is {missing} from?"
    return ""


def _import_hint(missing: str, importable: Mapping[str, str], line: str) -> str:
    """Return the hint for a name that resembles one of an import, or ""."""
    # Names of two letters, like re, are similar to any name of three, and a module is followed by
    # a dot, so that `len(times)` does not mean time.
    is_module = re.search(rf"\b{missing}\.\w", line) is not None
    names = [name for name in importable if len(name) > 2 and (is_module or name not in _STDLIB)]
    similar = nearest(missing, names, 0.8)
    return f"did you mean {similar}? Then import it: `{importable[similar]}`." if similar else ""


def _similar_variable(missing: str, frame: FrameType) -> str:
    """Return a hint for the variable or class whose name is closest to an undefined one, or ""."""
    # A function's own name, like confidence_color, often resembles the name of its parameter.
    names = [name for name in (*frame.f_locals, *frame.f_globals) if name != frame.f_code.co_name]
    similar = nearest(missing, names)
    kind = frame.f_globals.get(similar)
    if similar.lower() == missing and isinstance(kind, type) and hasattr(kind, "get_fields_and_field_types"):
        return f"create it first: `{missing} = {similar}()`."
    return f"did you mean `{similar}`?" if similar else ""


def _call_hint(missing: str, line: str, frame: FrameType) -> str:
    """Return the hint for an undefined name that is passed to a function, or ""."""
    if match := re.search(rf"\bkey\s*=\s*({missing}\b[\w.\[\]]*)", line):
        return f"key is a function of an item: write key=lambda {missing}: {match[1]}."
    if not re.search(rf"[(\[,]\s*{missing}\s*[)\],]", line):
        return ""
    # A string in the running function, or in another method of its class, may be meant.
    methods = vars(type(frame.f_locals.get("self"))).values()
    codes = [frame.f_code, *(m.__code__ for m in methods if isinstance(m, FunctionType))]
    if not any(isinstance(c, str) and c == missing for code in codes for c in code.co_consts):
        return ""
    if frame.f_code.co_name.isidentifier() and (similar := nearest(missing, frame.f_locals)):
        return f'did you mean the variable {similar}, or the string "{missing}" with quotes?'
    return f'it is a name in quotes: write "{missing}".'


def _find_abbreviation(wanted: str, frame: FrameType) -> str:
    """Return the only local variable that `wanted` abbreviates or spells out, or "".

    For example, msg abbreviates message.
    """

    def abbreviates(short: str, long: str) -> bool:
        letters = iter(long)
        return short[:1] == long[:1] and len(short) < len(long) and all(c in letters for c in short)

    own = [name for name in frame.f_locals if name != "self" and frame.f_code.co_name.isidentifier()]
    near = [name for name in own if abbreviates(wanted, name) or abbreviates(name, wanted)]
    return near[0] if len(near) == 1 else ""


def _other_function_hint(name: str, frame: FrameType) -> str:
    """Return the hint for a name that is a local variable of another function, or "".

    It is nested in the failing code, another method of the node, or defined by another cell.
    """
    code = frame.f_code
    kind = type(frame.f_locals.get("self"))
    methods = [value for value in vars(kind).values() if isinstance(value, FunctionType)]
    # A slip in a name of the running method is more likely than a variable of another one.
    is_slip = bool(nearest(name, frame.f_locals, 0.85))
    for method in methods if is_student_class(kind) and not is_slip else ():
        other = method.__code__
        if other is not code and name in other.co_varnames:
            is_parameter = name in other.co_varnames[: other.co_argcount]
            what = "parameter" if is_parameter else "local variable"
            return (
                f"{name} is a {what} of {other.co_name}, and exists only there: keep it in the "
                f"node, self.{name} = … in {other.co_name}, and read self.{name} here."
            )
    nested = [part for part in code.co_consts if isinstance(part, CodeType) and part.co_name.isidentifier()]
    if code.co_name == "<module>":
        values = [value for value in frame.f_globals.values() if isinstance(value, FunctionType)]
        nested += [value.__code__ for value in values if is_student_file(value.__code__.co_filename)]
    inner = next((one.co_name for one in nested if name in one.co_varnames[one.co_argcount :]), "")
    end = f"and exists only there: return it from {inner}."
    return f"{name} is set in the function {inner}, {end}" if inner else ""


def _is_set_before(error: BaseException, name: str) -> bool:
    """Return whether the function of the failing line sets a local variable on an earlier line."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return False
    stores = (i for i in dis.get_instructions(trace.tb_frame.f_code) if i.argval == name)
    return any("STORE" in i.opname and i.offset < trace.tb_lasti for i in stores)


def _constant_of(name: str, names: Mapping[str, object]) -> str:
    """Return a constant of a message class that is in scope, like "Marker.CUBE", or ""."""
    if not name.isupper():
        return ""
    kinds = {key: cls for key, cls in names.items() if isinstance(cls, type)}
    classes = ((key, cls) for key, cls in kinds.items() if hasattr(cls, "get_fields_and_field_types"))
    return next((f"{key}.{name}" for key, cls in classes if isinstance(getattr(cls, name, None), int)), "")


def parameter_hint(error: BaseException) -> str:
    """Return a question with the declared parameter closest to a missing one, or ""."""
    match = re.search(r"undeclared parameter\(s\): (\w+)$", str(error))
    holders = (frame.f_locals.get("self") for frame, _ in walk_tb(error.__traceback__))
    node = next((holder for holder in holders if hasattr(holder, "get_parameters_by_prefix")), None)
    similar = nearest(match[1], node.get_parameters_by_prefix("")) if match and node is not None else ""
    return f"did you mean {similar!r}? It is declared." if similar else ""


def key_hint(error: BaseException) -> str:
    """Return a question with the closest key, or how to set an environment variable, or "".

    The exception does not contain its dictionary, so the dictionaries in scope of the line are
    searched.
    """
    frame = frame_of(error)
    missing_key = error.args[0] if isinstance(error, KeyError) and error.args else None
    if frame is None or not isinstance(missing_key, str | int | float):
        return ""
    if frame.f_locals.get("self") is os.environ:
        return (
            f"the environment variable {missing_key} is not set. Set it before: export "
            f"{missing_key}=VALUE in a terminal, or %env {missing_key}=VALUE in a notebook."
        )
    attributes = getattr(frame.f_locals.get("self"), "__dict__", {})
    reached = [*frame.f_locals.values(), *attributes.values(), *frame.f_globals.values()]
    all_keys = [key for value in reached if type(value) is dict for key in value]
    if isinstance(missing_key, str) and ".format(" in line_of_student(error):
        return f"format( ) gets no value with the name {missing_key}: write {missing_key}=… in its ( )."
    for key in all_keys:
        # A bool is an int, too.
        if {type(key), type(missing_key)} == {str, int} and str(key) == str(missing_key):
            kind = "a string" if isinstance(key, str) else "a number"
            return f"the key is {kind}, {key!r}, and not {missing_key!r}."
    if found := _wrong_argument_hint(missing_key, error):
        return found
    keys = [key for key in all_keys if isinstance(key, str)]
    if isinstance(missing_key, str) and (similar := nearest(missing_key, keys)):
        return f"did you mean {similar!r}?"
    read = re.findall(r"([A-Za-z_]\w*)\[", line_of_student(error))
    tables = {name: {**attributes, **frame.f_globals, **frame.f_locals}.get(name) for name in read}
    dicts = {name: table for name, table in tables.items() if type(table) is dict}
    lacking = [name for name, table in dicts.items() if missing_key not in table]
    if len(lacking) != 1 or len(dicts[lacking[0]]) > 8:
        return ""
    own = [f"{key!r:.20}" for key in dicts[lacking[0]]]
    noun = "keys" if len(own) > 1 else "its key"
    only = f"has only {join_words(own)} as {noun}" if own else "is empty"
    return f"{lacking[0]} {only}. Test first whether the key is there: if … in {lacking[0]}."


def _wrong_argument_hint(missing_key: object, error: BaseException) -> str:
    """Return the hint for a key that the caller of the failing function has passed, or ""."""
    all_steps = walk_tb(error.__traceback__)
    steps = [step for step in all_steps if is_student_file(step[0].f_code.co_filename)]
    if len(steps) < 2:
        return ""
    (outer, number), (inner, _) = steps[-2:]
    parameters = inner.f_code.co_varnames[: inner.f_code.co_argcount]
    found = [name for name in parameters if inner.f_locals.get(name) is missing_key]
    line = linecache.getline(outer.f_code.co_filename, number).strip()
    function = inner.f_code.co_name
    if len(found) != 1 or f"{function}(" not in line:
        return ""
    value = f"{found[0]} = {missing_key!r}"
    return f"{function}(…) gets {value} in line {number}: are its values right, and in order?"


def attribute_hint(error: AttributeError) -> str:
    """Return a question with the attribute closest to a missing one, or ""."""
    if error.name is None or error.obj is None:
        return ""
    frame = frame_of(error)
    if isinstance(error.obj, ModuleType) and (found := shadowing_hints.hiding_file_hint(error.obj.__name__)):
        return found
    if isinstance(error.obj, ModuleType) and (found := _module_attribute_hint(error.obj, error.name, frame)):
        return found
    if frame is not None and error.obj is frame.f_locals.get("self") and error.name in frame.f_locals:
        return f"{error.name} is a variable of this method: write `{error.name}` without self."
    cls = type(error.obj)
    if is_student_class(cls) and (found := _misplaced_hint(error.name, cls, error)):
        return found
    own_classes = [base for base in cls.__mro__ if is_student_class(base)]
    if own_classes:
        # For a student's own node class, its own attributes and ROS's methods are suggested. ROS's
        # properties, like `publishers`, are too similar to names that students choose.
        attributes = [
            *getattr(error.obj, "__dict__", ()),
            *(name for base in own_classes for name in vars(base)),
        ]
        methods = [name for name in public_attributes(cls) if callable(getattr(cls, name, None))]
        if error.name in ("clock", "logger") and f"get_{error.name}" in methods:
            return f"did you mean `self.get_{error.name}()`?"
        names = [name for name in [*attributes, *methods] if not name.startswith("_")]
    else:
        names = public_attributes(error.obj)
    similar = nearest(error.name, names)
    if own_classes:
        # `self.publish` resembles `publisher` more than the name that is probably meant.
        # A method of the class that differs by a letter is meant before `values` of a dictionary.
        is_method = callable(getattr(cls, similar, None))
        is_near = is_method and nearest(error.name, [similar], 0.85) != ""
        if not is_near and (holder := _holder_of(error.name, error.obj)):
            return f"did you mean `self.{holder}.{error.name}`?"
        own_names = list(dict.fromkeys(name for name in names if name in attributes))
        in_init = frame is not None and frame.f_code.co_name == "__init__"
        if not similar and own_names and in_init and hasattr(cls, "create_timer"):
            known = join_words(own_names[:6])
            return f"{cls.__name__} has {known}. Which of them do you mean, or is one missing?"
    if not similar and isinstance(error.obj, ModuleType) and error.obj.__name__ in interfaces():
        similar = nearest(error.name, interfaces()[error.obj.__name__], 0.6)
    longer = [name for name in names if name.startswith(f"{error.name}_")]
    if own_classes and not longer and len(error.name) > 2:
        longer = _abbreviated_attributes(error, [name for name in names if name in attributes])
    if not similar and 1 < len(longer) <= 3:
        return f"did you mean {' or '.join(f'`{name}`' for name in longer)}?"
    similar = similar or (longer[0] if len(longer) == 1 else "")
    return f"did you mean `{similar}`?" if similar else ""


def _abbreviated_attributes(error: AttributeError, own_names: Iterable[str]) -> list[str]:
    """Return the own names that an attribute abbreviates: `publisher` for `self.pub`."""
    begin = str(error.name)
    found = list(dict.fromkeys(name for name in own_names if name.startswith(begin)))
    # With publisher and publish_marker, `self.pub.publish(…)` means the one that has publish.
    used = re.search(rf"\b{begin}\.(\w+)", line_of_student(error))
    if used and len(found) > 1:
        return [name for name in found if hasattr(getattr(error.obj, name), used[1])] or found
    return found


def _holder_of(name: str, instance: object) -> str:
    """Return the first attribute whose value has a method or a message's field of this name, or ""."""
    for key, value in getattr(instance, "__dict__", {}).items():
        fields = getattr(type(value), "get_fields_and_field_types", None)
        has_method = callable(getattr(type(value), name, None))
        if not key.startswith("_") and (has_method or (callable(fields) and name in fields())):
            return str(key)
    return ""


def _module_attribute_hint(module: ModuleType, name: str, frame: FrameType | None) -> str:
    """Return the hint for a name that is in a module of a package and not in the package, or ""."""
    package = module.__name__
    line = import_of_interface(name, package) if package in interfaces() else ""
    if line.startswith(f"from {package}."):
        return f"write `{line}`."
    # math.cosine and np.rad: a name is longer or shorter in other languages.
    functions = (one for one in public_attributes(module) if callable(getattr(module, one)))
    names = [one for one in functions if len(one) > 2]
    if len(name) > 2 and not nearest(name, names):
        begin = [one for one in names if name.startswith(one)]
        begin = begin or [one for one in names if one.startswith(name)]
        if 0 < len(begin) <= 3:
            return f"did you mean {' or '.join(f'`{one}`' for one in begin)}?"
    if "." in package or not hasattr(module, "__path__"):
        return ""
    # A library may lack an import itself, as xacro does.
    file = frame.f_code.co_filename if frame is not None else ""
    if not file.startswith(KIT) and not is_student_file(file):
        return ""
    if any(inner.name == name for inner in iter_modules(module.__path__)):
        return f"a module of a package is imported by its whole name: `import {package}.{name}`."
    return ""


def _misplaced_hint(name: str, cls: type, error: BaseException) -> str:
    """Return the hint for a name that a class lacks, because it is defined elsewhere, or "".

    A method may be after its class or inside another method, and an attribute may be a variable
    that a method sets without self.
    """
    codes = {key: method.__code__ for key, method in vars(cls).items() if isinstance(method, FunctionType)}
    for outer, code in codes.items():
        if any(isinstance(part, CodeType) and part.co_name == name for part in code.co_consts):
            return f"def {name} is inside of {outer}: indent it as far as def {outer}."
    methods = [method for method in vars(cls).values() if isinstance(method, FunctionType)]
    function = methods[0].__globals__.get(name) if methods else None
    if isinstance(function, FunctionType) and function.__code__.co_varnames[:1] == ("self",):
        first = methods[0].__name__
        return f"def {name} is outside of the class {cls.__name__}: indent it as far as def {first}."
    running = {frame.f_code: number for frame, number in walk_tb(error.__traceback__)}
    for key, code in codes.items():
        for step in dis.get_instructions(code):
            if step.opname != "STORE_ATTR" or step.argval != name:
                continue
            number = (step.positions.lineno if step.positions else None) or 0
            if key == "__init__" and number > running.get(code, number):
                line = f"self.{name} is set later, in line {number}"
                return f"{line}: move that line up, before this one."
            if key != "__init__" and code not in running:
                return (
                    f"self.{name} is set in {key}, which has not run yet: write self.{name} = None "
                    f"in __init__, and `if self.{name} is None: return` before this line."
                )
    for key, code in codes.items():
        if name in code.co_varnames[code.co_argcount :]:
            return f"{name} = … in {key} is a variable that ends with it: write self.{name} = … there."
    return ""


# Short or old names of arguments.
_OTHER_KEYWORDS = {
    "args": "arguments",
    "exec": "executable",
    "node_executable": "executable",
    "node_name": "name",
    "node_namespace": "namespace",
    "node_type": "executable",
    "ns": "namespace",
    "params": "parameters",
    "pkg": "package",
    "remap": "remappings",
    "type": "executable",
}


def keyword_hint(error: BaseException) -> str:
    """Return a question with the argument closest to one that a function does not have, or ""."""
    match = re.match(
        r"(?:\w+\.)*?(\w+)(?:\.__init__)?\(\) got an unexpected keyword argument '([\w ]+)'", str(error)
    )
    frame = frame_of(error)
    if match is None or frame is None:
        return ""
    # The kit's base class that rejects the argument is not the class that the student called.
    instance = frame.f_locals.get("self")
    is_in_kit = instance is not None and frame.f_code.co_filename.startswith(KIT)
    function = (
        type(instance) if is_in_kit and ".__init__()" in str(error) else reachable_object(frame, match[1])
    )
    # Actions of launch files check their options in a function of their own.
    for caller, _ in walk_tb(error.__traceback__):
        if type(caller.f_locals.get("self")).__name__ == match[1]:
            function = type(caller.f_locals["self"])
    if not isinstance(function, FunctionType | MethodType | type):
        return ""
    try:
        parameters = inspect.signature(function).parameters
    except (TypeError, ValueError):
        return ""
    names = [name for name in parameters if name != "self" and not name.startswith("_")]
    if match[1] == "Node" and match[2] in ("package", "executable", "pkg", "exec") and "node_name" in names:
        return "this is rclpy's Node. In a launch file, write `from launch_ros.actions import Node`."
    if (other := _OTHER_KEYWORDS.get(match[2], "")) in names:
        return f"did you mean `{other}`?"
    # A property's label, like "Fixed Frame", is written in small letters with underscores.
    label = match[2].lower().replace(" ", "_")
    similar = (
        label
        if label in names
        else nearest(label, names, 0.6) or next((n for n in names if n.startswith(match[2])), "")
    )
    if match[2] == "queue_size" and "qos_profile" in names:
        return "queue_size is from ROS 1: write the number alone, like 10, as the last argument."
    if similar:
        return f"did you mean `{similar}`?"
    return f"{match[1]} takes {join_words(names)}." if 0 < len(names) <= 8 else ""


def near_field(missing: str, names: Sequence[str]) -> str:
    """Return the field or constant of a message that a name probably means, or "".

    The candidates are names that differ in case only, everyday words for a field, similar names,
    and names that contain the word.
    """
    plain = missing.lower().replace("_", "")
    same = [name for name in names if name.lower().replace("_", "") == plain and name != missing]
    meant = [name for name in _SYNONYMS.get(missing.lower(), ()) if name in names]
    close = get_close_matches(missing, names)
    longer = [name for name in names if len(missing) > 2 and missing.lower() in name.lower().split("_")]
    return next(iter([*same, *meant, *close, *longer]), "")


def synonyms(name: str) -> tuple[str, ...]:
    """Return the field names that an everyday word may mean."""
    return _SYNONYMS.get(name.lower(), ())


@cache
def interfaces() -> Mapping[str, Mapping[str, Sequence[str]]]:
    """Return the names of interfaces by package and kind: ["std_srvs"]["srv"] has "Trigger"."""
    names_by_package: dict[str, dict[str, list[str]]] = {}
    for type_name in type_names():
        package, kind, name = type_name.split("/")
        # The types of a service or an action begin with its name: Trigger_Request.
        base_name = name if kind == "msg" else name.partition("_")[0]
        names = names_by_package.setdefault(package, {}).setdefault(kind, [])
        if base_name not in names:
            names.append(base_name)
    return names_by_package


def import_of_interface(name: str, package: str) -> str:
    """Return the import of an interface with exactly this name, preferably from a given package, or ""."""
    places = [(p, kind) for p, kinds in interfaces().items() for kind in kinds if name in kinds[kind]]
    places.sort(key=lambda place: (place[0] != package, place[0] not in COMMON))
    return next((f"from {p}.{kind} import {name}" for p, kind in places), "")


def call_with_fields(name: str) -> str:
    """Return a call of a message class with its first fields, like "ColorRGBA(r=1.0, g=1.0)".

    The result is "" if no type has this name. Of several types, one of a common package is chosen.
    """
    types = [type_name for type_name in type_names() if type_name.endswith(f"/msg/{name}")]
    if not types:
        return ""
    common = [type_name for type_name in types if type_name.partition("/")[0] in COMMON]
    samples = {"float64": "1.0", "float32": "1.0", "string": "'text'", "bool": "True"}
    fields = definition((common or types)[0]).fields[:4]
    lists = [field for field in fields if field.container != "scalar"]
    # A header is usually set afterwards.
    if len(lists) == 1 and {field.name for field in fields} <= {lists[0].name, "header"}:
        return f"{name}({lists[0].name}=[])"
    simple = [f for f in fields if f.container == "scalar" and not f.is_message]
    if len(simple) < len(fields):
        # A nested message needs its own object, which the empty message already has.
        return f"{name}()"
    return f"{name}({', '.join(f'{field.name}={samples.get(field.base, 1)}' for field in fields)})"


def _importable(frame: FrameType) -> dict[str, str]:
    """Return the import of each well-known name.

    In a launch file, names of launch take precedence.
    """
    messages = {
        name.rpartition("/")[2]: "from {}.{} import {}".format(*name.split("/"))
        for name in reversed(sort_by_likelihood(type_names()))
    }
    own_imports = {**LAUNCH_IMPORTS, **IMPORTS, **(IN_LAUNCH_FILES if is_launch_file(frame) else {})}
    modules = {name: f"import {name}" for name in _STDLIB}
    return {**_kit_names(), **messages, **modules, **own_imports}


@cache
def _kit_names() -> dict[str, str]:
    # Functions of displays and sensors are left out, because names like `text` and `box` are common
    # variables.
    return {
        name: f"from {module} import {name}"
        for module in reversed(_KIT)
        for name in public_attributes(importlib.import_module(module))
        if name[0].isupper() or module in _KIT[:2]
    }


@cache
def known_packages() -> list[str]:
    """Return the packages of interfaces and of the stand-in, and the libraries of the course."""
    standins = Path(__file__).with_name("standin")
    interface_packages = [name.partition("/")[0] for name in type_names()]
    standin_packages = [path.name for path in standins.iterdir() if path.is_dir()]
    return [*interface_packages, *standin_packages, "numpy", "matplotlib", "course_lib"]
