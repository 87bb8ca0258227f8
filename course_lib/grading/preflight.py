"""A trial before grading: in the same jail, the solution gets full marks and the stub none."""

import os
import platform
import shutil
import sys
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

import course_lib
from course_lib.course.exercise import exercise_from, notebook_text, read_notebook
from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.handin.archives import working_files
from course_lib.grading.handin.notebook import parse_notebook
from course_lib.grading.judge import Judgement, TaskResult, judge
from course_lib.grading.records import Course, catalog_of, digest_of, kit_digest, writing
from course_lib.grading.run.job import Job, plan
from course_lib.grading.run.run import run, unpack

STUDENT = "preflight"  # whose personal values are tried
FOLDER = "preflight"  # in the folder of results
MOST_SHOWN = 3  # in a message


@dataclass(frozen=True, eq=False)
class Trial:
    """A solution or a stub, to be graded like a submission.

    Args:
        exercise: "week01_exercise".
        name: "solution" or "stub".
        path: The file that it comes from.
        job: What runs it.
    """

    exercise: str
    name: str
    path: Path
    job: Job

    def key(self, machine: str) -> str:
        """Return the name of its evidence: the same for the same inputs on the same machine."""
        return f"{self.job.key}-{digest_of([machine, self.job.need])[:16]}"


def try_out(
    exercises: Iterable[str], course: Course, out: Path, away: Executor, here: Executor, *, may_run: bool
) -> list[str]:
    """Run and judge solution and stub of each exercise, as submissions are; use earlier evidence again.

    Args:
        exercises: "week01_exercise", … that are about to be graded.
        course: Where tasks, solutions and hidden checks are.
        out: The folder of results, which keeps the evidence.
        away: Runs submissions.
        here: Judges them.
        may_run: Whether what has no evidence yet is run, or left out.

    Returns:
        Lines for the terminal: what was tried, what could not be tried, and why.

    Raises:
        CourseError: A solution has not full marks, a stub has points, or the kit elsewhere is another one.
    """
    names = sorted(exercises)
    solutions = {name: course.solutions / f"{name.split('_')[0]}_solution.ipynb" for name in names}
    found = {name: path for name, path in solutions.items() if path.is_file()}
    notes = [
        f"Not tried out: {name}, as there is no {solutions[name]}" for name in names if name not in found
    ]
    trials = [trial for name, path in found.items() for trial in _trials(name, path, course)]
    if may_run and trials:
        kept = _run(trials, out, away)
    else:
        kept = {trial: path for trial in trials if (path := _earlier(trial, out)) is not None}
        left = (f"{trial.name} of {trial.exercise}" for trial in trials if trial not in kept)
        notes += [f"Not tried out: {what}, as --rejudge runs nothing" for what in left]
    judged = {trial: here.submit(judge_trial, trial, course, path) for trial, path in kept.items()}
    wrong = {trial: reason for trial, future in judged.items() if (reason := future.result())}
    for trial in wrong:
        kept[trial].unlink()  # it may have been the machine's fault: run it again next time
    if wrong:
        raise CourseError(_refusal(wrong, course))
    tried = ", ".join(sorted({trial.exercise for trial in kept}))
    return [*notes, *[f"Solution and stub of {tried}: full marks and none, as it must be."] * bool(tried)]


def kit_here() -> tuple[str, str]:
    """Return where this process's kit is, and its hash."""
    return str(Path(course_lib.__file__).parent), kit_digest()


def judge_trial(trial: Trial, course: Course, stored: Path) -> str:
    """Judge stored evidence by the checks of today; returns why the mark is not what it must be, or ""."""
    catalog = catalog_of(course)
    tasks = catalog.of_week(trial.exercise.split("_")[0])
    evidence = unpack(stored.read_bytes(), plan(tasks, catalog, hidden=True))
    return _difference(trial, judge(evidence, tasks, catalog))


def _machine(away: Executor) -> str:
    """Return what evidence depends on besides a job.

    Raises:
        CourseError: Submissions would be run by another version of the kit than judges them.
    """
    ours, digest = kit_here()
    try:
        theirs, other = away.submit(kit_here).result()
    except (ImportError, AttributeError) as error:  # the kit there is older than this function
        theirs, other = f"another place ({error})", ""
    if other != digest:
        raise CourseError(
            f"nothing is graded: submissions would be run by the kit in {theirs}, which is not the version "
            f"in {ours} that judges them. Install the same one there: pip install -e {Path(ours).parent}"
        )
    system = (platform.node(), platform.platform(), sys.version, sys.prefix)
    return repr((digest, system, os.geteuid(), shutil.which("bwrap")))


def _trials(exercise: str, solution: Path, course: Course) -> Iterator[Trial]:
    catalog = catalog_of(course)
    tasks = catalog.of_week(exercise.split("_")[0])
    steps = tuple(step.unjudged() for step in plan(tasks, catalog, hidden=True))
    stub = course.exercises / f"{exercise}.ipynb"
    texts = {
        "solution": (solution, solution.read_bytes()),
        "stub": (stub, stub.read_bytes())
        if stub.is_file()
        else (solution, notebook_text(exercise_from(read_notebook(solution))).encode()),
    }
    for name, (path, data) in texts.items():
        cells = parse_notebook(data, path.name).cells
        files = working_files(path, cells)
        job = Job(cells, STUDENT, steps, catalog.course.limits, files, course.sandbox, course.refused)
        yield Trial(exercise, name, path, job)


def _run(trials: Iterable[Trial], out: Path, away: Executor) -> dict[Trial, Path]:
    """Run what this machine has not run before; returns where the evidence is."""
    machine = _machine(away)
    kept = {trial: out / FOLDER / f"{trial.key(machine)}.msgpack.gz" for trial in trials}
    started = [(path, away.submit(run, t.job)) for t, path in kept.items() if not path.is_file()]
    for path, future in started:
        evidence = future.result().evidence
        with writing(out):
            write_whole(path, evidence)
    return kept


def _earlier(trial: Trial, out: Path) -> Path | None:
    return max((out / FOLDER).glob(f"{trial.job.key}-*.msgpack.gz"), default=None, key=_age)


def _age(path: Path) -> float:
    return path.stat().st_mtime


def _difference(trial: Trial, judgement: Judgement) -> str:
    # Tasks that a person marks do not count.
    marked = [task for task in judgement.tasks if not task.rubric]
    is_solution = trial.name == "solution"
    wrong = [r for r in marked if (r.score < r.points if is_solution else r.score > 0)]
    if not wrong:
        return ""
    got, most = sum(r.score for r in marked), sum(r.points for r in marked)
    expected = "all" if is_solution else "none"
    mark = f"the {trial.name} {trial.path} gets {got:g} of {most:g} points, expected {expected}"
    shown = [_short(result, is_solution=is_solution) for result in wrong[:MOST_SHOWN]]
    return ". ".join([mark, *judgement.cell_errors[:is_solution], *shown])


def _short(result: TaskResult, *, is_solution: bool) -> str:
    """Return a task's points, the first check that should have said otherwise, and the first error."""
    checks = [c for c in result.checks if c.weight and (c.score < 1 if is_solution else c.score > 0)]
    said = [f"{c.scenario}, {c.title!r}: {c.broken or c.message}" for c in checks[:1]]
    return "; ".join([f"{result.task}: {result.score:g} of {result.points:g}", *said, *result.errors[:1]])


def _refusal(wrong: Mapping[Trial, str], course: Course) -> str:
    kit, first = Path(course_lib.__file__).parent, next(iter(wrong)).path
    places = f"The checks are in {course.exercises} and {course.solutions}, the kit is {kit}"
    also = [f"Also: {', '.join(str(trial.path) for trial in wrong if trial.path != first)}"] * (
        len(wrong) > 1
    )
    look = (
        f"Type `course check {first}` to see more, correct the notebook, its checks or the kit, and grade "
        "again. --only '*/week01*' grades one exercise meanwhile"
    )
    return ". ".join([f"nothing is graded: {next(iter(wrong.values()))}", *also, places, look])
