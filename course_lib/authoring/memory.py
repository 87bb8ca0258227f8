"""The weeks that were verified as they are, and the refusal to release any other."""

import hashlib
import json
from collections.abc import Iterable
from contextlib import suppress

from course_lib.authoring.verify import EXTRAS, WeekReport, lines, page_flaws, verify, weeks_of
from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.grading.records import Course, kit_digest

MEMORY = ".verified.json"  # beside exercises/; the digests of weeks without flaws
MOST_SHOWN = 10  # lines in a refusal


def remember(course: Course, reports: Iterable[WeekReport]) -> None:
    """Keep the digests of the weeks that nothing is wrong with."""
    sound = [digest_of_week(course, report.week) for report in reports if not report.flaws]
    known = [digest for digest in _known(course) if digest not in sound]
    text = json.dumps([*known, *sound][-200:], indent=0)
    write_whole(course.exercises.parent / MEMORY, text.encode())


def refuse_broken(course: Course) -> None:
    """Verify the weeks that have changed since they were verified last.

    Raises:
        CourseError: Something is wrong with one of them.
    """
    known = _known(course)
    changed = [week for week in weeks_of(course) if digest_of_week(course, week) not in known]
    reports = list(verify(course, changed)) if changed else []
    remember(course, reports)
    reports.append(WeekReport(EXTRAS, tuple(page_flaws(EXTRAS, course))))
    broken = [report for report in reports if report.flaws]
    if broken:
        said = lines(broken, course)
        shown = " | ".join(said[:MOST_SHOWN])
        raise CourseError(f"nothing is released. {shown} … To see all of it: course verify")


def digest_of_week(course: Course, week: str) -> str:
    """Return the digest of all that verifying a week depends on: also the lessons of earlier weeks."""
    lessons = [path for path in course.lessons.glob("week*") if path.name[:6] <= week]
    own = [path for top in (course.exercises, course.solutions) for path in top.rglob(f"{week}*")]
    shared = [course.exercises / "course.toml", course.solutions / "answers" / "mutants.toml"]
    total = hashlib.sha256(f"{kit_digest()} {week}".encode())
    for path in sorted({*lessons, *own, *shared}):
        if path.is_file() and path.suffix != ".pyc":
            total.update(path.name.encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return total.hexdigest()


def _known(course: Course) -> list[str]:
    with suppress(OSError, ValueError):
        stored = read_json((course.exercises.parent / MEMORY).read_text(encoding="utf-8"))
        return [one for one in stored if isinstance(one, str)] if isinstance(stored, list) else []
    return []
