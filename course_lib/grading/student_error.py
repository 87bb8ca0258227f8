"""A student's exception in one sentence, with the line of the student's own code."""

import linecache
import sys
import sysconfig
from pathlib import Path
from traceback import extract_tb

import course_lib
from course_lib.errors import CourseError
from course_lib.ros.hints import hint

MAX_LENGTH = 500  # characters
OTHERS = (str(Path(course_lib.__file__).parent), *sysconfig.get_paths().values())


def describe(error: BaseException) -> str:
    """Return what was raised, where, and the hint for a common mistake.

    For example "ZeroDivisionError: division by zero (cell In[3], line 2: 1 / 0)".
    """
    where = _place(error)
    what = _what(error)[:MAX_LENGTH]
    place, is_raise, _ = where.partition(": raise ")
    if is_raise:  # that line says nothing that the text does not say
        where = place
    found = hint(error)
    said = f"{what}{where and f' ({where})'}{found and f'; hint: {found}'}"
    return said.encode("utf-8", "replace").decode()  # half of a surrogate pair can't leave the process


def _what(error: BaseException) -> str:
    try:
        text = error.msg if isinstance(error, SyntaxError) else str(error)
    except (Exception, SystemExit):  # str() is the student's own code here, and may raise anything
        text = "(its text can't be made)"
    if isinstance(error, CourseError):
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _place(error: BaseException) -> str:
    if isinstance(error, SyntaxError) and error.lineno:
        return _line(error.filename or "", error.lineno)
    frames = [(frame.filename, frame.lineno) for frame in extract_tb(error.__traceback__)]
    own = [(name, line) for name, line in frames if line and not _is_others(name)]
    return _line(*own[-1]) if own else ""


def _is_others(filename: str) -> bool:
    return filename.startswith(("<frozen", *OTHERS))


def _line(filename: str, line: int) -> str:
    code = linecache.getline(filename, line).strip()
    return f"{_cell(filename)}line {line}{code and f': {code}'}"


def _cell(filename: str) -> str:
    """The cell's name where IPython knows it, else the file's."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    named = shell.compile.format_code_name(filename) if shell is not None else None
    if named is not None:
        return f"{named[0].lower()} {named[1]}, "
    return f"{Path(filename).name}, " if filename and not filename.startswith("<") else ""
