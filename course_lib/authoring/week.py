"""One week, verified: its answers run in the jail, its checks judged by what they say of them."""

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial

from course_lib.authoring.answers import RIGHT, read_answers
from course_lib.authoring.edits import Edit, edits_of, packed, rehearsal_of, said
from course_lib.authoring.fields import misspelt
from course_lib.authoring.flaw import Flaw
from course_lib.authoring.mutants import operators
from course_lib.authoring.rehearsal import Rehearsal, Rehearsed, cells_of, options, rehearse, with_option
from course_lib.errors import did_you_mean, place_of
from course_lib.grading.judge import NEEDS_ANOTHER, CheckResult, TaskResult
from course_lib.grading.records import Course, catalog_of
from course_lib.grading.task import Scenario, Task

MOST = 0.1  # of a task's points, for a publisher without content
FEWEST_WRONG = 2  # wrong answers to a task
Look = Callable[[Rehearsed], Iterable[Flaw]]
Key = tuple[str, str, int]  # of a check: task, scenario, number


class WeekRehearsals:
    """The rehearsals of one week.

    Args:
        week: "week01".
        course: Where its files are.
        pool: Runs and judges.
    """

    def __init__(self, week: str, course: Course, pool: Executor) -> None:
        self._week, self._course, self._pool = week, course, pool
        self._tasks = [task for task in catalog_of(course).of_week(week) if not task.rubric]
        self._solution = course.solutions / f"{week}_solution.ipynb"
        self._exercise = course.exercises / f"{week}_exercise.ipynb"
        self._cells = cells_of(self._solution)
        self._answers = read_answers(course.solutions, week)
        self.kept: dict[str, float] = {}  # by wrong answer, its share of the task's points
        self._failed: set[Key] = set()
        self._checks: dict[Key, CheckResult] = {}
        self._places = {
            (task.id, scenario.name, number): check.origin.place
            for task in self._tasks
            for scenario in self._scenarios(task)
            for number, check in enumerate(scenario.checks)
            if check.origin
        }

    def flaws(self) -> Iterator[Flaw]:
        """Run all rehearsals, and yield what is wrong."""
        yield from self._unchecked()
        edits = list(edits_of(self._tasks, self._answers, self._cells, operators(self._course.solutions)))
        yield from (one for one in edits if isinstance(one, Flaw))
        groups = packed([one for one in edits if isinstance(one, Edit)], self._cells, self._week)
        rehearsals = [*self._plain(), *self._whole_files()]
        rehearsals += [(rehearsal, partial(self._look_at_edits, group)) for group, rehearsal in groups]
        done = self._made([rehearsal for rehearsal, _ in rehearsals])
        for (_, look), made in zip(rehearsals, done, strict=True):
            self._note(made.results)
            yield from look(made)
        yield from self._never_failing()
        yield from self._too_few()

    def _unchecked(self) -> Iterator[Flaw]:
        """Yield IDs that cells check and no task has, and tasks that no cell checks."""
        checks = r"^check\(\s*[\"'](\w+\.\w+)[\"']"
        checked = set(re.findall(checks, "\n".join(self._cells), re.MULTILINE))
        known = {task.id for task in catalog_of(self._course).of_week(self._week)}
        for name in sorted(checked - known):
            text = f"check({name!r}, …): there is no such task{did_you_mean(name, known, 3)}"
            yield Flaw("solution", text, str(self._solution))
        for name in sorted(known - checked):
            yield Flaw("solution", f"no cell calls check({name!r}, …)", str(self._solution))

    def _made(self, rehearsals: Sequence[Rehearsal]) -> Iterator[Rehearsed]:
        return self._pool.map(rehearse, rehearsals, [self._course] * len(rehearsals))

    def _plain(self) -> Iterator[tuple[Rehearsal, Look]]:
        """Yield the solution under every option, and the stub."""
        ids = tuple(task.id for task in self._tasks)
        plain = Rehearsal(self._week, "the solution", self._cells, ids, hollow=True)
        yield plain, self._look_at_solution
        for row in range(1, options(self._tasks)):
            own = [task for task in self._tasks if options([task]) > row]
            some = replace(plain, tasks=tuple(task.id for task in own), option=row, hollow=False)
            yield some, partial(self._look_at_option, own, row)
        yield Rehearsal(self._week, "the stub", cells_of(self._exercise), ids), self._look_at_stub

    def _whole_files(self) -> Iterator[tuple[Rehearsal, Look]]:
        ids = tuple(task.id for task in self._tasks)
        for name in [*[RIGHT] * bool(self._answers.other_right), *self._answers.files]:
            path = self._answers.file(name)
            look = self._look_at_right if name == RIGHT else partial(self._look_at_wrong, name)
            yield Rehearsal(self._week, path.name, cells_of(path), ids), look

    def _note(self, results: Iterable[TaskResult]) -> None:
        for key, check in (row for result in results for row in _keyed(result)):
            self._checks.setdefault(key, check)
            if not check.passed and check.mistake != NEEDS_ANOTHER:
                self._failed.add(key)

    def _look_at_solution(self, made: Rehearsed) -> Iterator[Flaw]:
        for error in made.cell_errors:
            yield Flaw("solution", f"a cell raises {error}", str(self._solution))
        for result in made.results:
            yield from self._full("solution", "the solution", result, str(self._solution))
        types = {(task, topic): type_name for task, topic, type_name in made.types}
        for task in self._tasks:
            yield from misspelt(task, self._scenarios(task), types)
        self._note(result for _, _, result in made.hollow)
        for way, remedy, result in made.hollow:
            if result.fraction > MOST:
                earned = ", ".join(check.title for check in result.checks if check.passed and check.weight)
                text = f"{result.task}: {way}: {result.score:g} of {result.points:g} points, for: {earned}"
                yield Flaw("empty", f"{text}. Remedy: {remedy}", self._checks_file)

    def _look_at_option(self, tasks: Sequence[Task], row: int, made: Rehearsed) -> Iterator[Flaw]:
        for task, result in zip(tasks, made.results, strict=True):
            own = {name: choice for name, (choice,) in with_option(task, row).personal.items()}
            yield from self._full("solution", f"the solution with {own}", result, str(self._solution))

    def _full(self, aspect: str, what: str, result: TaskResult, place: str) -> Iterator[Flaw]:
        """Yield a flaw for a task without full marks, at the place of the first check that fails."""
        if result.score < result.points or not result.passed:
            failing = [(key, check) for key, check in _keyed(result) if not check.passed]
            why = [f"{_kind(c)} {c.scenario!r}, {c.title!r}: {c.broken or c.message}" for _, c in failing[:2]]
            text = "; ".join([*result.errors[:1], *why])
            at = place if result.errors or not failing else self._place(failing[0][0])
            score = f"{result.score:g} of {result.points:g} points"
            yield Flaw(aspect, f"{result.task}: {what} has {score}: {text}", at)

    def _place(self, key: Key) -> str:
        return self._places.get(key, self._checks_file)

    def _look_at_stub(self, made: Rehearsed) -> Iterator[Flaw]:
        for result in made.results:
            earned = [check.title for check in result.checks if check.score and check.weight]
            if result.score:
                text = (
                    f"{result.task}: the empty exercise has {result.score:g} points, for: {', '.join(earned)}"
                )
                yield Flaw("stub", text, str(self._exercise))
            elif "NotImplementedError" not in "".join(result.errors):
                text = f"{result.task}: the stub does not say what is missing: is there a # solution:?"
                yield Flaw("stub", text, str(self._solution))

    def _look_at_right(self, made: Rehearsed) -> Iterator[Flaw]:
        path = self._answers.file(RIGHT)
        for result in made.results:
            yield from self._full("second", path.name, result, str(path))

    def _look_at_wrong(self, name: str, made: Rehearsed) -> Iterator[Flaw]:
        for result in made.results:
            says = self._answers.files[name].get(result.task)
            place = place_of(self._answers.path, says or "")
            if says is None:
                continue
            self.kept[f"{result.task}: {name}"] = result.fraction
            if result.errors or result.score >= result.points or not said(result, hidden=True):
                came = [*result.errors, f"{result.score:g} of {result.points:g} points"][0]
                text = f"{result.task}: {name}: {came}, expected a loss by public and by hidden checks"
                yield Flaw("wrong", text, place)
            elif says not in said(result):
                text = f"{result.task}: {name}: expected a message with the words {says!r}, the checks say: "
                yield Flaw("wrong", text + said(result).splitlines()[0], place)

    def _look_at_edits(self, group: Sequence[Edit], made: Rehearsed) -> Iterator[Flaw]:
        """Yield what is wrong with each edit of a notebook; alone, as others may have disturbed it."""
        for edit, result in zip(group, made.results, strict=True):
            found, last = list(edit.look(result)), result
            if found and len(group) > 1:
                (alone,) = self._made([rehearsal_of([edit], self._cells, self._week)])
                self._note(alone.results)
                (last,) = alone.results
                found = list(edit.look(last))
            if not edit.is_right:
                self.kept[edit.name] = last.fraction
            yield from found

    def _never_failing(self) -> Iterator[Flaw]:
        for key, check in self._checks.items():
            if check.weight and key not in self._failed:
                text = f"{key[0]}, {_kind(check)} {check.scenario!r}, {check.title!r}"
                yield Flaw("can fail", f"{text}: no answer fails it. Add a wrong one", self._place(key))

    def _too_few(self) -> Iterator[Flaw]:
        ways = {variant.task for variant in self._answers.variants if variant.way}
        hints = {(variant.task, variant.hint) for variant in self._answers.variants}
        for task in self._tasks:
            count, path = self._answers.wrong_answers_to(task.id), str(self._answers.path)
            if count < FEWEST_WRONG:
                text = f"{task.id}: {count} wrong answers, expected at least {FEWEST_WRONG}"
                yield Flaw("wrong", text, path)
            if self._answers.other_right is None and task.id not in ways:
                yield Flaw("second", f"{task.id}: no other right answer: add one with way = …", path)
            for kind in task.mistakes:
                if (task.id, kind) not in hints:
                    text = f"{task.id}: no wrong answer with hint = {kind!r}: is its own hint ever shown?"
                    yield Flaw("wrong", text, path)
            titles = Counter(check.title for scenario in task.scenarios for check in scenario.checks)
            for title in (title for title, number in titles.items() if number > 1):
                yield Flaw("files", f"{task.id}: two public checks are titled {title!r}", self._checks_file)

    def _scenarios(self, task: Task) -> tuple[Scenario, ...]:
        return task.scenarios + catalog_of(self._course).hidden.get(task.id, ())

    @property
    def _checks_file(self) -> str:
        return str(self._course.exercises / "checks" / f"{self._week}.py")


def _keyed(result: TaskResult) -> Iterator[tuple[Key, CheckResult]]:
    """Yield the checks of a task by task, scenario and number, as check files have them."""
    numbers = Counter[str]()
    for check in result.checks:
        yield (result.task, check.scenario, numbers[check.scenario]), check
        numbers[check.scenario] += 1


def _kind(check: CheckResult) -> str:
    return "hidden" if check.hidden else "public"


def missing_files(week: str, course: Course) -> Iterator[Flaw]:
    """Yield the notebooks of a week with tasks that are not there."""
    for path, how in (
        (course.solutions / f"{week}_solution.ipynb", f"write it, or begin with: course new {week}"),
        (course.exercises / f"{week}_exercise.ipynb", "python -m course_lib.course.exercise makes it"),
    ):
        if not path.is_file():
            yield Flaw("files", f"missing: {how}", str(path))
