"""Hints for names that stand for something else than the student expects.

A variable or a method may have the name of a function, module or property, a result may have the name
of its function, and an object may be older than the present class.
"""

import builtins
import linecache
import re
import sys
from importlib.machinery import PathFinder
from pathlib import Path
from traceback import walk_tb
from types import FrameType, FunctionType, ModuleType

from course_lib.ros.student_code import frame_of, is_student_class, is_student_file, line_of_student

# Modules by the names under which students import them.
_MODULES = {
    "math": "math",
    "time": "time",
    "random": "random",
    "np": "numpy",
    "copy": "copy",
    "os": "os",
}


def outdated_hint(error: BaseException) -> str:
    """Return the hint for an object whose class a cell has redefined since then, or "".

    The missing attribute is in the new class, so that the student's code is right.
    """
    if not isinstance(error, AttributeError) or not is_student_class(type(error.obj)):
        return ""
    old, name = type(error.obj), error.name or ""
    for frame, _ in walk_tb(error.__traceback__):
        new = frame.f_globals.get(old.__name__)
        if not isinstance(new, type) or new is old or new.__qualname__ != old.__qualname__:
            continue
        methods = (method for method in vars(new).values() if isinstance(method, FunctionType))
        if hasattr(new, name) or any(name in method.__code__.co_names for method in methods):
            return (
                f"this {old.__name__} was created before the cell of the class was run again: run "
                f"the cell that creates it, with {old.__name__}(…), again."
            )
    return ""


def _replaced_function_hint(name: str, frame: FrameType, line: str) -> str:
    """Return the hint for a call of a variable that has replaced the function of its name, or ""."""
    value = frame.f_globals[name]
    # IPython keeps the source of all cells.
    cells = [cell for cell in frame.f_globals.get("In", ()) if isinstance(cell, str)]
    source = "\n".join([*cells, *linecache.getlines(frame.f_code.co_filename)])
    if callable(value) or not re.search(rf"(?m)^def {name}\(", source):
        return ""
    if not re.search(rf"(?<![.\w]){name}\(", line):
        return ""
    return (
        f"{name} = … has replaced the function {name}, which is now {value!r:.30}: choose another "
        f"name for the result, and run the cell with def {name} again."
    )


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
        is_global = name in frame.f_globals and not hasattr(builtins, name)
        if is_global and (found := _replaced_function_hint(name, frame, line_of_student(error))):
            return found
        is_called = re.search(rf"(?<![.\w]){name}\(", line_of_student(error)) is not None
        value = frame.f_locals.get(name)
        is_value = value is not None and not callable(value)
        if is_called and is_value and callable(frame.f_globals.get(name)):
            kind = "class" if isinstance(frame.f_globals[name], type) else "function"
            return f"{name} = … is a variable here and hides the {kind} {name}: rename it."
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
                is_class = isinstance(error.obj, type)
                what = f"the class {error.obj.__name__}" if is_class else f"a variable here, {name} = …,"
                return (
                    f"{name} is {what} and hides the module {name}: choose another name for it, and "
                    "import the module again."
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
    if frame is None or frame.f_code.co_name != "reject_hidden_properties":
        return ""
    name = frame.f_locals["name"]
    return f"rclpy itself reads {name} of a node: choose another name for your method {name}."


def hiding_file_hint(name: str) -> str:
    """Return the hint for an imported file or folder that has the name of a library's module, or ""."""
    file = getattr(sys.modules.get(name), "__file__", None)
    if file is None or "." in name or not is_student_file(file):
        return ""
    place = Path(file).resolve()
    if place.stem == "__init__":
        place = place.parent
    elsewhere = [entry for entry in sys.path if Path(entry).resolve() != place.parent]
    hidden = PathFinder.find_spec(name, elsewhere)
    # Python also finds the folder around a package of the workspace, without an origin.
    if hidden is None or hidden.origin is None or is_student_file(hidden.origin):
        return ""
    return f"your {place.name} hides the module {name} of Python or of a library: rename it."
