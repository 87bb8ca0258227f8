"""Execution of xacro in this process, so that its `$(find …)` finds the packages of the kit."""

import os
import re
import sys
from collections.abc import Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import IO

from course_lib.errors import CourseError
from course_lib.ros.programs.packages import packages, source
from course_lib.third_party import check_regular, read_text

# The message is from xacro's substitution_args.py.
_UNDEFINED = re.compile(r"Undefined substitution argument (\w+)")
# Parts of xacro's messages that quote a file, and patterns of the quotation in the file.
_QUOTES = (
    (r"when evaluating expression '(.+)'", r"\$\{{[^}}]*{}"),
    (r"unknown macro name: (\S+)", r"<{}\b"),
    (r"when instantiating macro: (\S+)", r"<xacro:{}\b"),
    (r'Xacro conditional "(.+?)"', "{}"),
    (r"No such file or directory: \S*?([^/\s']+)(?:\s|$)", "{}"),
    (r"Undefined substitution argument (\w+)", r"\$\(arg {}\)"),
    (r"package '([\w-]+)' not found", r"\$\(find {}\)"),
)


@dataclass(frozen=True)
class ProgramResult:
    """The result of a program: its output, its error output and its exit code."""

    output: str
    errors: str
    code: int


def run_xacro(arguments: Sequence[str]) -> ProgramResult:
    """Run xacro with these command-line arguments, given without "xacro" itself."""
    # xacro uses this module without importing it.
    import xml.parsers.expat  # noqa: F401  # it becomes an attribute of xml

    import xacro

    # The function replaces the builtin one for the file and all included files.
    vars(xacro)["open"] = _open_regular
    # Warnings about the workspace are written here, not among the errors of xacro.
    packages()
    output, errors, code, saved_arguments = StringIO(), StringIO(), 0, sys.argv
    sys.argv = ["xacro", *arguments]
    try:
        with redirect_stdout(output), redirect_stderr(errors):
            xacro.main()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    finally:
        sys.argv = saved_arguments
    return ProgramResult(output.getvalue(), errors.getvalue(), code)


def _open_regular(path: str, mode: str = "r") -> IO[str]:
    if mode == "r":
        check_regular(Path(path))
    return open(path, mode)


def expand_xacro(path: Path, arguments: Mapping[str, object]) -> str:
    """Expand a xacro file and return the robot description.

    `$(find …)` also finds the packages of the file's own workspace.

    Args:
        path: The file.
        arguments: Values of its `xacro:arg` elements by name; all others have their defaults.

    Raises:
        CourseError: xacro fails; the message contains its output.
    """
    # xacro writes booleans as YAML does.
    xacro_arguments = [
        f"{name}:={str(value).lower() if isinstance(value, bool) else value}"
        for name, value in arguments.items()
    ]
    environment = dict(os.environ)
    try:
        source(path)
        result = run_xacro([str(path), *xacro_arguments])
    finally:
        os.environ.clear()
        os.environ.update(environment)
    if result.code:
        # A macro that calls itself has the same line hundreds of times.
        errors = re.sub(r"(?m)^(.*\n)\1+", r"\1", f"{result.errors.strip()}\n").strip()
        # xacro writes the text of another program's exception twice, after its class.
        errors = re.sub(r"(?m)<class '[\w.]+'>: (.+) \1$", r"\1", errors)
        text = f"xacro cannot expand {path}{_place_of_error(path, errors)}: {errors}"
        if undefined := _UNDEFINED.search(result.errors):
            text += (
                f"\nThe file needs a value for its argument '{undefined[1]}': load_robot({str(path)!r}, "
                f"{undefined[1]}=…), or on the command line {undefined[1]}:=VALUE."
            )
        raise CourseError(text)
    return result.output


def _place_of_error(path: Path, errors: str) -> str:
    """Return " (common.xacro, line 12)" for the line of a file that xacro's message quotes, or ""."""
    match = re.search(r"(?:processing|in) file: (.+)", errors)
    file = Path(match[1].strip()) if match else path
    try:
        lines = read_text(file, errors="replace").splitlines()
    except OSError:
        # The file name in xacro's message does not exist on disk, such as "<stdin>".
        return ""
    for pattern, form in _QUOTES:
        if quoted_match := re.search(pattern, errors):
            quoted = re.compile(form.format(re.escape(quoted_match[1])))
            number = next((number for number, line in enumerate(lines, start=1) if quoted.search(line)), 0)
            return f" ({file.name}, line {number})" if number else ""
    return ""


def is_xacro(text: str) -> bool:
    """Return whether a robot description contains xacro elements, regardless of its file name."""
    return "xmlns:xacro" in text and re.search(r"<xacro:|\$[{(]", text) is not None
