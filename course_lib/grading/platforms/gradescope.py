"""`course gradescope WEEK`: write an autograder.zip that grades a week's exercise on Gradescope."""

import io
import json
import re
import shlex
import shutil
import tempfile
import time
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import metadata
from pathlib import Path
from typing import Any, Literal, get_args
from urllib.parse import urlsplit
from urllib.request import url2pathname
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from course_lib.course.course_file import read_course_file
from course_lib.course.exercise import normalise
from course_lib.course.material import DISTRIBUTION, checkout_root, course_package
from course_lib.errors import CourseError, format_count
from course_lib.files import write_atomically
from course_lib.grading.grade import grade
from course_lib.grading.jail.filters import Need
from course_lib.grading.judge import HIDDEN_ERROR
from course_lib.grading.marks import MarkedResult, stored_result
from course_lib.grading.records import MISMATCH, TaskResult
from course_lib.grading.reports.rendering import print_line, replace_controls, rows
from course_lib.grading.store import Course, catalog_of, this_course
from course_lib.grading.submissions.choice import ANY
from course_lib.grading.submissions.collect import PlatformTime, collect, write_receipts
from course_lib.grading.submissions.readers import FOLDERS
from course_lib.grading.submissions.roster import read_class_list
from course_lib.grading.submissions.submission import find_submissions
from course_lib.grading.task import Catalog
from course_lib.grading.vocabulary.markers import is_personal
from course_lib.third_party import read_json

PROJECT = ("pyproject.toml", "README.md", "LICENSE")
PACKAGE = "course_lib"
MATERIAL = (PACKAGE, "notebooks", "exercises")  # needed for building the kit; all of it is public
FOLDER = "kit"  # folder next to the course in the zip


@dataclass(frozen=True)
class KitSource:
    """The source from which setup.sh installs the kit.

    Args:
        pip_arguments: Arguments of `pip install` in shell syntax; `$root` is the folder of the autograder.
        name: A description for people.
        files: The kit's files in the zip, by name.
    """

    pip_arguments: str
    name: str
    files: Mapping[str, bytes] = field(default_factory=dict)


def kit_source(distribution: metadata.Distribution | None = None) -> KitSource:
    """Return the source of the installed kit: a checkout, a wheel, a repository, or the package index.

    Args:
        distribution: The distribution; default: the installed one.

    Raises:
        CourseError: It was installed from files that no longer exist.
    """
    installed_kit = distribution or metadata.distribution(DISTRIBUTION)
    text = installed_kit.read_text("direct_url.json")  # PEP 610; missing if installed from an index
    if text is None:
        requirement = f"{DISTRIBUTION}=={installed_kit.version}"
        return KitSource(requirement, f"{requirement} of the package index")
    direct: dict[str, Any] = read_json(text)
    url = str(direct["url"])
    if "vcs_info" in direct:
        version = direct["vcs_info"]
        return _from_url(f"{version['vcs']}+{url}@{version['commit_id']}")
    parts = urlsplit(url)
    if parts.scheme != "file":
        return _from_url(url)
    path = Path(url2pathname(parts.path))
    if (path / PACKAGE).is_dir():
        files = {f"{FOLDER}/{name}": data for name, data in kit_files(path).items()}
        return KitSource(f'-e "$root/source/{FOLDER}"', f"the kit's {len(files)} files", files)
    if path.is_file():
        name = f"{FOLDER}/{path.name}"
        return KitSource(f'"$root/source/{name}"', path.name, {name: path.read_bytes()})
    raise CourseError(
        f"the kit was installed from {url}, which no longer exists. Install it again, from a "
        "checkout, a wheel or the package index, then build the autograder"
    )


def kit_files(root: Path) -> dict[str, bytes]:
    """Return the files of the kit in a checkout, by relative path."""
    paths = [root / name for name in PROJECT if (root / name).is_file()]
    material = (path for top in MATERIAL for path in (root / top).rglob("*"))
    paths += sorted(path for path in material if is_source_file(path.relative_to(root)))
    return {path.relative_to(root).as_posix(): path.read_bytes() for path in paths if path.is_file()}


def is_source_file(path: Path) -> bool:
    """Return whether a file of a project is a source file, not a by-product of running it."""
    return not any(part in ("__pycache__", "_course") or part.startswith(".") for part in path.parts)


def _from_url(url: str) -> KitSource:
    requirement = f"{DISTRIBUTION} @ {url}"
    return KitSource(shlex.quote(requirement), requirement)


ROSTER = "roster.csv"  # in solutions/, which no submission may read
METADATA = "submission_metadata.json"
UNKNOWN = "gradescope"  # replaces the student ID if there is no metadata
MAX_METADATA = 10_000_000  # [B]; it contains the results of all earlier submissions
MOST_NAMED = 10  # limit on the files that a line lists
MAX_TEXT = 20_000  # limit on the characters of a text in the results
NOT_IN_ROSTER = (
    "Your address on Gradescope ({}) is not in the class list of this course, so your ID is unknown. "
)
WITHHELD = (
    "Checks of your personal values give no points until it is added: {:g} points are pending in "
    "{}. All other checks count. Ask your instructor to add the address and to regrade."
)
NOTHING_WITHHELD = "This exercise has no personal values: all points count."
NEEDS_ID = "counts once your address is in the class list: it needs your personal value"
OTHER_STUDENT = (
    "No points: {}. Submit your own file; if it is yours, write your own ID into it, or ask your instructor."
)


@dataclass(frozen=True)
class Upload:
    """The student and the time of an upload, from Gradescope's metadata.

    Args:
        student: The ID in the roster, else Gradescope's number.
        is_named: Whether the student is in the roster.
        time: The time of the upload as Gradescope writes it, or "".
        stranger: The address that is not in the roster, or "".
    """

    student: str
    is_named: bool
    time: str
    unknown_address: str = ""


def grade_upload(
    week: str,
    root: Path,
    *,
    hidden: str,
    need: Need,
    show_total: bool = False,
    course: Course | None = None,
) -> Path:
    """Grade ROOT/submission and write ROOT/results/results.json.

    Args:
        week: "week01".
        root: Gradescope's /autograder.
        hidden: When students see the results of hidden checks, in Gradescope's terms.
        need: The weakest isolation that is accepted.
        show_total: Show the total after the upload, which reveals whether hidden checks passed.
        course: The course; default: the installed one.

    Raises:
        CourseError: An error that is not the student's. Without results.json, Gradescope shows an
            error of the autograder and no mark.
    """
    begin, course = time.monotonic(), course or this_course()
    target = root / "results" / "results.json"
    target.parent.mkdir(exist_ok=True)
    target.unlink(missing_ok=True)
    upload, exercise = _read_upload(root / METADATA, course), f"{week}_exercise"
    with tempfile.TemporaryDirectory(prefix="course_") as work:
        top, out = Path(work, "in"), Path(work, "out")
        if exercise in _collect(root / "submission", upload, Path(work), course):
            only = f"{upload.student}/{exercise}"
            grade(top, out, jobs=1, only=only, need=need, course=course)
            result = stored_result(out, upload.student, exercise)
            note = ""
            if upload.unknown_address:
                result, note = _without_personal_points(result, upload.unknown_address, catalog_of(course))
            report = results_of(result, hidden, show_total=show_total, note=note)
        else:
            submission = root / "submission"
            there = sorted(path.name for path in submission.iterdir())
            names = ", ".join(map(replace_controls, there[:MOST_NAMED])) or "nothing"
            report = _ungraded_results(
                f"{exercise}.ipynb is missing, or the zip that `course submit` writes. "
                f"You submitted: {names}."
            )
    report["execution_time"] = round(time.monotonic() - begin, 1)
    write_atomically(target, json.dumps(report, indent=1).encode())
    return target


def _read_upload(path: Path, course: Course) -> Upload:
    """Read the metadata of a submission; without the file, student and time are unknown."""
    roster = course.solutions / ROSTER
    members = read_class_list(roster) if roster.is_file() else ()
    if not path.is_file():
        return Upload(UNKNOWN, False, "", "no address" if members else "")
    try:
        with path.open("rb") as file:
            content = read_json(file.read(MAX_METADATA))
        users = [user for user in content["users"] if isinstance(user, dict)]
        created, number = str(content["created_at"]), str(users[0]["id"])
        emails = [str(user.get("email") or "").casefold() for user in users]
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise CourseError(
            f"{path} can't be read: {error!r}. Expected the file that Gradescope writes at an upload"
        ) from error
    student = next((m.id for email in emails for m in members if email and m.email == email), "")
    unknown_address = ", ".join(filter(None, emails)) or "no address" if members and not student else ""
    return Upload(student or normalise(f"{UNKNOWN}{number}"), bool(student), created, unknown_address)


def _collect(submission: Path, upload: Upload, work: Path, course: Course) -> set[str]:
    """Sort a submission's files into WORK/in, with their time, and return their exercises."""
    if not submission.is_dir():
        raise CourseError(f"{submission} is missing: Gradescope puts the student's files there")
    top, zone = work / "in", catalog_of(course).course.zone
    try:
        shutil.copytree(submission, work / "class" / upload.student, symlinks=True)
    except shutil.Error as error:
        # All other files have been copied.
        for name, _, why in error.args[0]:
            print_line(f"rejected: {name}: {why}")
    try:
        collection = collect(work / "class", top, zone, exercise=ANY, layout=FOLDERS)
    except CourseError:
        # The submission is empty.
        return set()
    for line in collection.rejected_lines:
        print_line(line)
    if not collection.count:
        return set()
    write_receipts(top, {upload.student: PlatformTime(upload.time, METADATA, upload.is_named)})
    return {submission.exercise for submission in find_submissions(top, zone=zone)}


def _without_personal_points(
    marked_result: MarkedResult, address: str, catalog: Catalog
) -> tuple[MarkedResult, str]:
    """Return the result of a student with an unknown ID, and a line that explains the points.

    The file was run with the personal values of the ID in it, which may not be the sender's.
    Therefore checks that compare something with a personal value give no points; the other
    requirements are the same for all students.
    """
    result = marked_result.result
    if result.judgement is None:
        return marked_result, NOT_IN_ROSTER.format(address)
    tasks, waiting = [], dict[str, float]()
    for task in result.judgement.tasks:
        declared = catalog.task(task.task)
        scenarios = (*declared.scenarios, *catalog.hidden.get(task.task, ()))
        # A check whose call is not recorded may use a personal value.
        id_needs = [
            declared.personal and (check.origin is None or is_personal(check.origin.arguments))
            for scenario in scenarios
            for check in scenario.checks
        ]
        checks = [
            replace(check, score=0.0, message=NEEDS_ID, mistake=NEEDS_ID) if needs_id else check
            for check, needs_id in zip(task.checks, id_needs, strict=True)
        ]
        total_weight = sum(check.weight for check in checks)
        withheld = sum(check.weight for check, needs_id in zip(checks, id_needs, strict=True) if needs_id)
        if withheld:
            waiting[task.title] = task.points * withheld / total_weight
        tasks.append(replace(task, checks=tuple(checks)))
    reduced = replace(result, judgement=replace(result.judgement, tasks=tuple(tasks)))
    about = (
        WITHHELD.format(round(sum(waiting.values()), 2), ", ".join(waiting)) if waiting else NOTHING_WITHHELD
    )
    return MarkedResult(reduced), NOT_IN_ROSTER.format(address) + about


def _ungraded_results(text: str) -> dict[str, Any]:
    """Return the results of a submission that is not graded, with the reason."""
    return {"score": 0.0, "output": _text([text]), "output_format": "text", "tests": []}


def results_of(
    marked_result: MarkedResult, hidden: str, *, show_total: bool = False, note: str = ""
) -> dict[str, Any]:
    """Return Gradescope's results for a result.

    The top of the page is visible immediately, so that by default it contains nothing that depends
    on hidden checks: no count of full marks, no points, and no limit that a hidden scenario may
    have reached. Gradescope itself withholds the total as long as a test is hidden.

    Args:
        marked_result: The result.
        hidden: When students see the results of hidden checks.
        show_total: Show the total, the count of full marks and the penalty in points as well.
        note: A line about the sender; default: the note on the ID in the file.

    Raises:
        CourseError: The kit failed, and no student may get zero points for that.
    """
    result, row = marked_result.result, marked_result.row
    if result.status == "grader_error":
        raise CourseError(
            f"the grader failed, which is not the student's fault: {result.reason} {result.message}"
        )
    judgement, mark, note = result.judgement, result.mark, note or result.submission.id_note
    if judgement is None or mark is None:
        lines = [note, row.reason, row.message]
        return {**_ungraded_results("\n".join(lines)), "extra_data": {"status": row.status, "isolation": ""}}
    is_other = result.submission.id_flag == MISMATCH
    lines = [OTHER_STUDENT.format(note) if is_other else note, result.remark]
    if mark.days_late:
        lines.append(f"{format_count(mark.days_late, 'started day')} late")
    if show_total and not is_other:
        lines += [row.reason, row.message]
        lines.append(
            f"Total: {mark.score:g} - {mark.penalty:g} = {mark.final:g} of {mark.max_score:g} points"
        )
    lines += [*judgement.cell_errors, f"Ran with isolation: {judgement.isolation}."]
    tests = [] if is_other else [test for task in judgement.tasks for test in _tests(task, hidden)]
    return {
        "score": 0.0 if is_other else mark.final,
        "output": _text(lines),
        "output_format": "text",
        "stdout_visibility": "hidden",
        "tests": [{"number": str(number), **test} for number, test in enumerate(tests, 1)],
        "extra_data": {"status": row.status, "isolation": judgement.isolation},
    }


def _tests(task: TaskResult, hidden: str) -> Iterator[dict[str, Any]]:
    """Yield a task's public checks as one test and its hidden checks as another, which share its points."""
    total_weight = sum(check.weight for check in task.checks)
    if not total_weight:
        yield {"name": f"{task.title}: a person marks it", "output": "", "visibility": "visible"}
        return
    bonus = " (bonus)" if task.is_bonus else ""
    remaining_score, most_left = task.score, task.points
    public = [check for check in task.checks if not check.is_hidden]
    # An error of a hidden scenario would reveal after the upload that hidden checks fail.
    errors = {
        is_hidden: [e for e in task.errors if (e == HIDDEN_ERROR) is is_hidden] for is_hidden in (False, True)
    }
    parts = (("", public, "visible"), (", hidden checks", [c for c in task.checks if c.is_hidden], hidden))
    for suffix, checks, visibility in (part for part in parts if part[1]):
        is_last = len(checks) == len(task.checks) or checks is not public
        share = sum(check.weight * check.score for check in checks) / total_weight
        score = remaining_score if is_last else round(task.points * share, 2)
        max_score = (
            most_left if is_last else round(task.points * sum(c.weight for c in checks) / total_weight, 2)
        )
        remaining_score, most_left = round(remaining_score - score, 2), round(most_left - max_score, 2)
        lines = [f"{row.icon} {row.title}{row.reason and f': {row.reason}'}" for row in rows(checks)]
        yield {
            "name": f"{task.title}{suffix}{bonus}",
            "score": max(score, 0.0),
            "max_score": max_score,
            "status": "passed" if all(check.passed for check in checks) else "failed",
            "output": _text([*errors[checks is not public], *lines]),
            "output_format": "text",
            "visibility": visibility,
        }


def _text(lines: Sequence[str]) -> str:
    printable_lines = (replace_controls(part) for line in lines if line for part in line.splitlines())
    return "\n".join(printable_lines)[:MAX_TEXT]


Hidden = Literal["after_published", "after_due_date", "hidden", "visible"]
NEEDS = {"full": " --require-sandbox", "any": " --i-trust-these-submissions", "partial": ""}
YEAR = (2000, 1, 1, 0, 0, 0)  # timestamp of all files in the zip
EXECUTABLE, PLAIN = 0o755, 0o644
FILES = Path(__file__).with_name("files")


def write_autograder(
    week: str, out: Path, *, hidden: str, need: str, roster: Path | None, show_total: bool = False
) -> list[str]:
    """Write autograder.zip, and return lines for the terminal.

    Args:
        week: "week01".
        out: The path of the zip file.
        hidden: When students see the results of hidden checks, in Gradescope's terms.
        need: The weakest isolation that is accepted for running a submission.
        roster: roster.csv with the students' e-mail addresses, from which their IDs are found.
        show_total: Show the total after the upload, which reveals whether hidden checks passed.

    Raises:
        CourseError: The week does not exist, the roster is invalid, or `out` can't be written.
    """
    if hidden not in get_args(Hidden):
        raise CourseError(f"--hidden {hidden}: expected one of {', '.join(get_args(Hidden))}")
    root = checkout_root()
    run = _script("run_autograder.sh").replace("WEEK", week).replace("HIDDEN", hidden)
    script = run.replace(" NEED", NEEDS[need] + " --show-total" * show_total)
    kit = KitSource("", "the kit") if (root / PACKAGE).is_dir() else kit_source()
    setup = _script("setup.sh").replace("KIT ", f"{kit.pip_arguments} ".lstrip())
    files = {**dict(_course_files(root, week)), **kit.files}
    if roster is not None:
        if not any(member.email for member in read_class_list(roster)):
            raise CourseError(f"{roster} has no column 'email', which identifies Gradescope's students")
        files[f"course/solutions/{ROSTER}"] = roster.read_bytes()
    data = io.BytesIO()
    with ZipFile(data, "w") as archive:
        for name, text in (("setup.sh", setup), ("run_autograder", script)):
            _add_file(archive, name, text.encode(), EXECUTABLE)
        for name, content in files.items():
            _add_file(archive, name, content, PLAIN)
    try:
        write_atomically(out, data.getvalue())
    except OSError as error:
        raise CourseError(
            f"{out} can't be written: {error.strerror}. Choose another file: --out FILE"
        ) from error
    note = "" if roster else ". Without --roster, the ID in the file determines the personal values"
    return [
        f"Wrote {out}: the course, {kit.name}, and the solution and hidden checks of {week}{note}",
        "Upload it in Gradescope: the assignment's Configure Autograder, base image Ubuntu 22.04 or newer",
    ]


def _script(name: str) -> str:
    return (FILES / name).read_text(encoding="utf-8")


def _add_file(archive: ZipFile, name: str, content: bytes, mode: int) -> None:
    info = ZipInfo(name, YEAR)
    info.external_attr = mode << 16
    archive.writestr(info, content, ZIP_DEFLATED)


def _course_files(root: Path, week: str) -> Iterator[tuple[str, bytes]]:
    """Yield the name and content of each file of a course with a single week."""
    yield "course/exercises/course.toml", keep_one_week(root / "exercises" / "course.toml", week)
    solution = root / "solutions" / f"{week}_solution.ipynb"
    paths = [solution, root / "solutions" / "checks" / f"{week}.py"]
    if missing := [path for path in paths if not path.is_file()]:
        raise CourseError(
            f"{missing[0]} is missing: an autograder needs the solution and hidden checks. "
            "Run the command in the instructors' checkout"
        )
    paths += [root / name for name in PROJECT if (root / name).is_file()]
    paths += sorted((root / "notebooks").glob(f"{week}*"))
    for top in (course_package().name, "exercises"):
        paths += sorted(path for path in (root / top).rglob("*") if is_source_file(path.relative_to(root)))
    for path in paths:
        if path.is_file() and path != root / "exercises" / "course.toml":
            yield f"course/{path.relative_to(root).as_posix()}", path.read_bytes()


def keep_one_week(path: Path, week: str) -> bytes:
    """Return course.toml without the tables of other weeks.

    Raises:
        CourseError: The week has no points or is invalid, or other weeks are not written as tables.
    """
    course = read_course_file(path)
    course.require_valid(week)
    weeks = course.weeks
    if week not in weeks or not weeks[week].points:
        known_weeks = ", ".join(name for name, settings in weeks.items() if settings.points)
        raise CourseError(f"there is no exercise of {week!r}; weeks with an exercise: {known_weeks}")
    other_weeks = re.compile(rf"^\[weeks\.(?!{week}[\].])[^\n]*.*?(?=^\[|\Z)", re.MULTILINE | re.DOTALL)
    text = other_weeks.sub("", path.read_text(encoding="utf-8"))
    if list(tomllib.loads(text)["weeks"]) != [week]:
        raise CourseError(f"{path}: write each week as a table: [weeks.{week}]")
    return text.encode()
