"""Hints for names that hide others: variables named like functions or modules, and methods."""

import builtins
import re
import sys
from traceback import walk_tb
from types import ModuleType

from course_lib.ros.near_names import frame_of, line_of_student

# Modules by the names under which students import them.
_MODULES = {"math": "math", "time": "time", "random": "random", "np": "numpy", "copy": "copy", "os": "os"}


def shadowed_hint(error: BaseException, text: str) -> str:
    """Return the hint for a function, method or class that a student's variable hides, or ""."""
    frame, match = frame_of(error), re.match(r"'(\w+)' object is not callable", text)
    if frame is None or match is None or not isinstance(error, TypeError):
        return ""
    variables = {**frame.f_globals, **frame.f_locals}
    # A comprehension reads the variables of its function as free variables.
    code = frame.f_code
    for name in (*code.co_varnames, *code.co_freevars, *code.co_names):
        is_hidden = hasattr(builtins, name) and name in variables
        if is_hidden and type(variables[name]).__name__ == match[1]:
            return (
                f"{name} is a variable here, {name} = …, and hides Python's {name}(): choose "
                f"another name for it. In a notebook, del {name} gives back Python's own."
            )
        is_called = re.search(rf"(?<![.\w]){name}\(", line_of_student(error)) is not None
        value = frame.f_locals.get(name)
        is_value = value is not None and not callable(value)
        if is_called and is_value and callable(frame.f_globals.get(name)):
            return f"{name} = … is a variable here and hides the function {name}: rename it."
        if name == match[1] and type(variables.get(name)).__name__ == name:
            return (
                f"{name} is an object here, {name} = …, and hides the class {name}: choose another "
                "name for the object, and import the class again."
            )
    owner = frame.f_locals.get("self")
    for name in re.findall(r"\bself\.(\w+)\(", line_of_student(error)):
        value = getattr(owner, "__dict__", {}).get(name)
        if type(value).__name__ == match[1] and callable(getattr(type(owner), name, None)):
            return f"self.{name} = … hides the method {name}: choose another name for the attribute."
    return ""


def hidden_module_hint(error: BaseException) -> str:
    """Return the hint for a variable with the name of a module that the failing line uses, or ""."""
    if not isinstance(error, AttributeError) or isinstance(error.obj, ModuleType | None):
        return ""
    for frame, _ in walk_tb(error.__traceback__):
        for name in (*frame.f_locals, *frame.f_globals):
            is_module = name in _MODULES and hasattr(sys.modules.get(_MODULES[name]), str(error.name))
            if is_module and {**frame.f_globals, **frame.f_locals}[name] is error.obj:
                return (
                    f"{name} is a variable here, {name} = …, and hides the module {name}: choose "
                    "another name for it, and import the module again."
                )
    return ""


def hidden_property_hint(error: BaseException) -> str:
    """Return the hint for a method with the name of a property of a node that rclpy reads, or ""."""
    frame = frame_of(error)
    if frame is not None and frame.f_code.co_name == "__name_in_events":
        return (
            "rclpy itself calls get_name() and get_namespace() of a node, which return strings: "
            "choose another name for your method."
        )
    if frame is None or frame.f_code.co_name != "_reject_hidden_properties":
        return ""
    name = frame.f_locals["name"]
    return f"rclpy itself reads {name} of a node: choose another name for your method {name}."
