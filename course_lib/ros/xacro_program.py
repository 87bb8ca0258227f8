"""xacro, run in this process: its `$(find …)` sees the packages that the kit sees."""

import sys
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from course_lib.errors import CourseError


@dataclass(frozen=True)
class Finished:
    """The end of a program: the text of both streams, and the exit code."""

    output: str
    errors: str
    code: int


def run_xacro(words: Sequence[str]) -> Finished:
    """Run xacro with the words of its command line, without "xacro" itself."""
    import xacro

    output, errors, code, own = StringIO(), StringIO(), 0, sys.argv
    sys.argv = ["xacro", *words]
    try:
        with redirect_stdout(output), redirect_stderr(errors):
            xacro.main()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    finally:
        sys.argv = own
    return Finished(output.getvalue(), errors.getvalue(), code)


def expanded(path: Path) -> str:
    """Return the robot description that a xacro file stands for, with the defaults of its arguments.

    Raises:
        CourseError: With what xacro says, if it fails.
    """
    done = run_xacro([str(path)])
    if done.code:
        raise CourseError(f"xacro cannot expand {path}: {done.errors.strip()}")
    return done.output
