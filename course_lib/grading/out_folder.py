"""The folder that grading writes into: one grader at a time, and one line when it can't be written."""

import os
import platform
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from course_lib.errors import CourseError

LOCK = ".lock"
KEPT = ("results", "evidence", "marks", "reports", "copies", "preflight")


class OutError(CourseError):
    """The folder can't be written: grading stops, and goes on with --resume."""


@contextmanager
def writing(out: Path) -> Iterator[None]:
    """What the system says of a full disk or a read-only folder, as one line.

    Raises:
        OutError: Something in it could not be written.
    """
    try:
        yield
    except OSError as error:
        raise OutError(
            f"{out} can't be written: {error.strerror or error}. Mend that, then type the command again, "
            "grade with --resume (nothing is lost); or name another folder"
        ) from error


@contextmanager
def sole_use(out: Path) -> Iterator[None]:
    """Keep others out; the system lets go of the lock with the process, however it ends.

    Raises:
        OutError: The folder can't be written.
        CourseError: Another process is at work in it.
    """
    import fcntl  # where there is none, nothing can be graded either

    with ExitStack() as stack:
        with writing(out):
            out.mkdir(parents=True, exist_ok=True)
            file = stack.enter_context((out / LOCK).open("a+"))
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                who = (out / LOCK).read_text() or "another process"
                raise CourseError(f"{out} is in use by {who}: wait for its end, then try again") from error
            file.truncate(0)
            file.write(f"process {os.getpid()} on {platform.node()}")
            file.flush()
            for draft in (path for kept in KEPT for path in (out / kept).rglob(".*") if path.is_file()):
                draft.unlink()  # what a killed grader was about to write
        yield
