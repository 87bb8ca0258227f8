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
from xml.parsers.expat.errors import codes as xml_codes

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.notices import print_to_stderr
from course_lib.ros.programs.packages import packages, source
from course_lib.third_party import check_regular, explain_xml_error, read_text

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
        elif advice := _advise(path, errors):
            text += f"\n{advice}"
        raise CourseError(text)
    _report_calls_without_prefix(path)
    return result.output


# xacro's errors, with advice. {1} is the first group.
_ADVICE = (
    (
        r"Undefined parameters \[(.+)\]",
        'The call lacks a value: add {1}="…" to it, or give {1} a default in the macro, params="{1}:=0.1".',
    ),
    (r"Unknown substitution command \[([^]]+)\]", "A property is read as ${{1}}; $( ) is for find and arg."),
    ('evaluated to "(.*)"', 'Write value="true" or "false", or a comparison like ${x > 0}.'),
    (
        "Not enough blocks",
        "The macro has a *block: put one tag between <xacro:… > and </xacro:…> of the call.",
    ),
    ("can only concatenate str", "${ } computes with numbers. Texts are joined outside of it: ${name}_1."),
    ("No such file or directory: (.+?) ", "An included path is relative to this file, or $(find PACKAGE)/…"),
    (
        "(?:closed|invalid syntax|unexpected EOF)",
        "In ${ } stands one Python expression, whose brackets are closed.",
    ),
)


def _advise(path: Path, errors: str) -> str:
    """Return advice for a file that xacro cannot expand, or ""."""
    text = read_text(_file_of_error(path, errors), errors="replace")
    if found := re.search(r"XML parsing error: (.+): line (\d+), column (\d+)", errors):
        code = xml_codes.get(found[1])
        return explain_xml_error(text, code, int(found[2]), int(found[3])) if code else ""
    macros = dict(re.findall(r"<xacro:macro\s+name=[\"']([\w:.-]+)[\"'](?:\s+params=[\"']([^\"']*))?", text))
    if found := re.search(r"name '(\w+)' is not defined", errors):
        names = re.findall(r"<xacro:property\s+name=[\"'](\w+)", text)
        if found[1] in names:
            return f'The property {found[1]} has no value above this line: write value="0.1".'
        meant = did_you_mean(found[1], names).removeprefix(". ")
        return meant or f'Set it above: <xacro:property name="{found[1]}" value="0.1"/>.'
    if found := re.search(r"unknown macro name: xacro:(\S+)", errors):
        if found[1] in macros:
            return f"The macro {found[1]} is defined below this line: move its definition above the call."
        meant = did_you_mean(found[1], macros).removeprefix(". ")
        return meant or f"Define the macro {found[1]} above, or include its file."
    if found := re.search(r'Invalid parameter "(\S+)"(?:\s+when instantiating macro: (\w+))?', errors):
        params = macros.get(found[2] or "", "")
        if "," in params:
            return f'The names in params="{params}" are separated by spaces, without commas.'
        return f"The macro {found[2]} has the parameters {params or 'none'}." if found[2] in macros else ""
    for pattern, advice in _ADVICE:
        if found := re.search(pattern, errors):
            return advice.replace("{1}", found[1]) if found.groups() else advice
    return ""


_URDF_TAGS = {
    *("link", "joint", "visual", "collision", "inertial", "origin", "geometry", "material", "color", "mass"),
    *("inertia", "box", "cylinder", "sphere", "mesh", "axis", "limit", "parent", "child", "gazebo", "sensor"),
    *("mimic", "dynamics", "texture", "transmission", "actuator", "plugin", "hardware", "ros2_control"),
}


def _report_calls_without_prefix(path: Path) -> None:
    """Print a hint about the first call of a macro without xacro:, which xacro copies as it is."""
    text = read_text(path, errors="replace")
    for macro in re.findall(r"<xacro:macro\s+name=[\"'](\w+)", text):
        # A macro may have the name of a tag of URDF, like box.
        if macro not in _URDF_TAGS and (call := re.search(rf"<{macro}[\s/>]", text)):
            line = text.count("\n", 0, call.start()) + 1
            print_to_stderr(
                f"hint: {path.name}, line {line}: <{macro}> is copied and not expanded. "
                f"Call the macro as <xacro:{macro} …/>."
            )


def _file_of_error(path: Path, errors: str) -> Path:
    """Return the file to which xacro's error message refers, such as an included file."""
    match = re.search(r"(?:processing|in) file: (.+)", errors)
    file = Path(match[1].strip()) if match else path
    return file if file.is_file() else path


def _place_of_error(path: Path, errors: str) -> str:
    """Return " (common.xacro, line 12)" for the line of a file that xacro's message quotes, or ""."""
    file = _file_of_error(path, errors)
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
