"""All that `course verify` looks at, in every week of the course."""

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest

from course_lib.authoring.rules import ASPECTS, EXTRAS
from course_lib.authoring.verify import WeekReport, verify, weeks_of
from course_lib.course.exercise import exercise_path
from course_lib.course.material import solutions_dir
from course_lib.grading.store import this_course
from tests.notebooks.graded import (
    IN_PROCESS,
    WEEKS,
    catalog,
    cells_of,
    defined,
    evidence_here,
    run_of,
    solution,
)
from tests.once import Once

ANSWERS = solutions_dir() / "answers"
ALL_WEEKS = weeks_of(this_course())


@pytest.fixture(scope="module")
def report(once: Once) -> Iterator[Callable[[str], WeekReport]]:
    """Verify a week, once for all aspects."""

    @cache
    def verified(week: str) -> WeekReport:
        # In this process: a pool would start its processes for each week.
        (report,) = verify(this_course(), [week], jobs=1)
        return report

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("course_lib.authoring.verify.rehearse", once.rehearse)
        patch.setattr("course_lib.authoring.verify.run_lesson", once.run_lesson)
        yield verified


@pytest.mark.slow
@pytest.mark.parametrize("aspect", ASPECTS, ids=lambda aspect: aspect.replace(" ", "_"))
@pytest.mark.parametrize("week", ALL_WEEKS)
def test_each_week_has_no_flaws_in_any_aspect(
    week: str, aspect: str, report: Callable[[str], WeekReport]
) -> None:
    assert [str(flaw) for flaw in report(week).flaws if flaw.aspect == aspect] == []
    assert report(week).cell(aspect) == "✔" or week not in WEEKS


def test_every_week_with_a_solution_is_verified() -> None:
    assert set(WEEKS) < set(ALL_WEEKS)
    assert EXTRAS not in ALL_WEEKS


def kinds_of_files() -> list[tuple[str, str]]:
    # The stubs of all weeks raise the same exception.
    stubs = [(week, "stub") for week in WEEKS[:1]]
    return stubs + [(week, kind) for week in WEEKS for kind in ("solution", "first_try", "second_try")]


@pytest.mark.sample(3)
@pytest.mark.parametrize(("week", "kind"), kinds_of_files())
def test_kernel_and_worker_record_equal_evidence(
    week: str, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # answers may write files
    paths = {"solution": solution(week), "stub": exercise_path(solution(week))}
    path = paths.get(kind, ANSWERS / f"{week}_{kind}.py")
    namespace = defined(cells_of(path), week)
    for run in run_of(path).runs:
        task = catalog().task(run.evidence.task)
        if task.kind not in IN_PROCESS:
            continue
        here = evidence_here(task, run.scenario, namespace)
        assert here.recording.digest() == run.evidence.recording.digest(), (task.id, run.scenario.name)
        assert here.returns == run.evidence.returns, (task.id, run.scenario.name)
