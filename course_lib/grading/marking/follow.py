"""Reports, index and gradebook that follow the marks of persons."""

import asyncio
import os
import sys
from contextlib import suppress
from pathlib import Path

from course_lib.errors import CourseError, counted
from course_lib.grading.marks.mark import Result, need_results, read_result
from course_lib.grading.records import Course, catalog_of, result_path, sole_use, this_course, writing
from course_lib.grading.reports.report import has_page, report
from course_lib.grading.reports.table import printable
from course_lib.grading.reports.tables import write_tables

PAUSE = 3.0  # [s] in which more marks may come, before reports are written
GENTLE = 10  # niceness of the process that writes them
Place = tuple[str, str]  # student and exercise


def stale(out: Path) -> list[Place]:
    """Return the students and exercises whose reports lack marks of persons."""
    return [place for place in _marked(out) if not has_page(_result(out, place), out)]


def follow_marks(out: Path, course: Course | None = None) -> str:
    """Write the tables, and each report that lacks marks of persons; return a line for the terminal.

    Args:
        out: The folder that `course grade` wrote.
        course: Where the tasks are; default: this checkout.

    Raises:
        OutError: The folder can't be written.
        CourseError: It is in use, or a file in it is damaged.
    """
    need_results(out)
    course = course or this_course()
    with sole_use(out), writing(out):
        places, catalog = stale(out), catalog_of(course)
        write_tables(out, catalog.course.zone)  # first: they matter more than pages
        for place in places:
            report(_result(out, place), out, catalog)
    return f"Wrote {counted(len(places), 'report')}, {out / 'reports/index.html'} and {out / 'gradebook.csv'}"


def _marked(out: Path) -> list[Place]:
    files = sorted((out / "marks").glob("[!.]*/[!.]*.json"))
    places = ((path.parent.name, path.stem) for path in files)
    return [place for place in places if result_path(out, *place).is_file()]


def _result(out: Path, place: Place) -> Result:
    return Result.from_plain(read_result(result_path(out, *place)))


class Follower:
    """A process beside the server that calls `follow_marks`, soon after marks were saved.

    Pages draw scenes, which takes seconds, and time limits, which only a main thread has.
    """

    def __init__(self, out: Path, course: Course) -> None:
        self._words = tuple(map(str, (out, course.exercises, course.solutions)))
        self._due = asyncio.Event()
        self.state = ""

    def marked(self) -> None:
        """Remember that reports have to follow."""
        self.state = "Reports and gradebook follow soon."
        self._due.set()

    async def run(self) -> None:
        """Follow for ever; a folder in use is tried again."""
        while True:
            await self._due.wait()
            await asyncio.sleep(PAUSE)
            self._due.clear()
            if said := await self._follow():
                self.state = f"Reports and gradebook wait: {said}"
                self._due.set()
            elif not self._due.is_set():
                self.state = "Reports and gradebook are up to date."

    async def _follow(self) -> str:
        """Return why it could not be done, or ""."""
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", __name__, *self._words),
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
            start_new_session=True,  # Ctrl+C is for the server, which waits for it
        )
        try:
            _, said = await process.communicate()
        except asyncio.CancelledError:
            await process.wait()
            raise
        lines = said.decode("utf-8", "replace").strip().splitlines()
        return "" if process.returncode == 0 else printable(lines[-1] if lines else "it was ended")


def main() -> None:
    """Follow once, as a program: the folder of records, then those of exercises and solutions."""
    out, exercises, solutions = map(Path, sys.argv[1:])
    with suppress(OSError):
        os.nice(GENTLE)
    try:
        follow_marks(out, Course(exercises, solutions))
    except CourseError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
