"""A student's exception in one sentence, with the line of the student's own code."""

from course_lib.errors import CourseError
from course_lib.ros.hints import hint
from course_lib.ros.tracebacks import line_of_traceback, name_line

MAX_LENGTH = 500  # characters


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
        return name_line(error.filename or "", error.lineno)
    return line_of_traceback(error.__traceback__)
