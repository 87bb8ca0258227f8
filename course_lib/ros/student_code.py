"""The student's code at an error: the frame and the line that raised it, and the objects in reach."""

import builtins
import linecache
import sys
import sysconfig
from pathlib import Path
from traceback import walk_tb
from types import CodeType, FrameType
from typing import Any

# The kit's folder. Its files, Python and its libraries are not the student's code.
KIT = str(Path(__file__).resolve().parent.parent)
_OTHERS = ("<frozen", KIT, *sysconfig.get_paths().values())
_HEAP_TYPE = 1 << 9  # Python's flag of classes that are not static in C


def is_student_file(filename: str) -> bool:
    """Return whether a file or a cell belongs to the student, not to the kit, Python or a library."""
    return not filename.startswith(_OTHERS)


def frame_of(error: BaseException) -> FrameType | None:
    """Return the frame that raised an exception."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return trace.tb_frame if trace is not None else None


def step_of_student(error: BaseException) -> tuple[FrameType, int] | None:
    """Return the innermost frame, and its line, outside the kit, Python and its libraries."""
    own = [step for step in walk_tb(error.__traceback__) if is_student_file(step[0].f_code.co_filename)]
    return own[-1] if own else None


def line_of_student(error: BaseException) -> str:
    """Return the text of the line of `step_of_student`, or ""."""
    step = step_of_student(error)
    return linecache.getline(step[0].f_code.co_filename, step[1]) if step is not None else ""


def is_native(kind: type) -> bool:
    """Return whether a class is implemented in C, like Python's built-in classes."""
    return not kind.__flags__ & _HEAP_TYPE


def is_student_class(kind: type) -> bool:
    """Return whether a class is defined in a notebook, or in a program next to it."""
    module = sys.modules.get(kind.__module__)
    # Modules of messages have no file.
    place = getattr(module, "__file__", None)
    # In a notebook, the file of __main__ is the program that runs its kernel.
    if kind.__module__ == "__main__":
        return True
    # Cells that are executed without a module define classes of "builtins".
    if kind.__module__ == "builtins":
        return getattr(builtins, kind.__name__, None) is None and not is_native(kind)
    return place is not None and is_student_file(place)


def reachable_object(frame: FrameType, name: str) -> Any:
    """Return the object of a name: a variable, or a method of self or of an object in scope."""
    instance = frame.f_locals.get("self")
    for names in (frame.f_locals, frame.f_globals, vars(builtins)):
        if name in names:
            return names[name]
    holders = [
        instance,
        *frame.f_locals.values(),
        *getattr(instance, "__dict__", {}).values(),
        *frame.f_globals.values(),
    ]
    methods = (getattr(type(holder), name, None) for holder in holders if holder is not None)
    return next((method for method in methods if callable(method)), None)


def is_of_library(function: object) -> bool:
    """Return whether a function is written in Python, and not by the student."""
    code = getattr(function, "__code__", None)
    return isinstance(code, CodeType) and not is_student_file(code.co_filename)


def public_attributes(value: object) -> list[str]:
    """Return the public attributes of an object, or [] if its own `__dir__` raises an exception."""
    try:
        return [name for name in dir(value) if not name.startswith("_")] if value is not None else []
    except (Exception, SystemExit):
        return []


def is_launch_file(frame: FrameType) -> bool:
    """Return whether a frame is in a launch file."""
    return "generate_launch_description" in (*frame.f_globals, frame.f_code.co_name)
