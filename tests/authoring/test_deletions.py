"""No right answer that crashes without one of its statements or imports passes all public checks."""

from collections.abc import Iterator, Sequence

import pytest

from course_lib.authoring.deletions import Code, Deletion, deletions, find_false_passes, group_deletions
from course_lib.authoring.rehearsal import Rehearsal, RehearsalResult, rehearse
from course_lib.grading import Call, Check, Scenario, Task, expect_value
from course_lib.grading.judge import judge_task
from course_lib.grading.records import Run
from course_lib.grading.run.scenario import run_in_this_process
from course_lib.grading.store import catalog_of, this_course

HINTS = ("one", "two", "three")
IMPORTS = "import math\nfrom pathlib import Path, PurePath"
AREA = '''def area(radius):
    """An area."""
    if radius < 0:
        return PurePath(".")
    square = radius * radius
    return math.pi * square'''
AREAS = """def area(radius):
    known = {}
    known[1.0] = 3.0
    known[-1.0] = 0.0
    return known[radius]"""
OTHER = "OTHER = Path()"


def area_task(*calls: Call, checks: tuple[Check, ...] = ()) -> Task:
    return Task(
        "week09.area", "Area", "function", "area", HINTS, (Scenario("public", calls=calls, checks=checks),)
    )


def made(cells: tuple[str, ...], name: str = "area") -> list[Deletion]:
    task = Task("week09.area", "Area", "function", name, HINTS)
    return list(deletions(Code(cells), [task]))


def test_every_statement_and_import_used_by_a_task_is_deleted_once() -> None:
    found = {one.name: one for one in made((IMPORTS, AREA, OTHER))}
    assert list(found) == [
        "without 'import math'",
        "without import of Path",
        "without import of PurePath",
        "without 'from pathlib import Path, PurePath'",
        'without \'def area(radius): """An area.""" if radius < 0: return PureP…\'',
        "without 'if radius < 0: return PurePath(\".\")'",
        "without 'square = radius * radius'",
        "without 'return math.pi * square'",
        "without 'return PurePath(\".\")'",
    ]
    assert found["without import of Path"].code == "import math\nfrom pathlib import PurePath"
    assert found["without import of Path"].crashes == {"week09.area": ""}
    assert found["without 'import math'"].crashes == {"week09.area": "name 'math' is not defined"}
    assert found["without import of PurePath"].crashes == {"week09.area": "name 'PurePath' is not defined"}


def test_attribute_without_an_assignment_is_reported_as_a_crash() -> None:
    node = "class Area:\n    def __init__(self):\n        self.r = 1.0\n\n    def get(self):\n"
    node += "        return self.r"
    (one,) = [one for one in made((node,), "Area") if one.name == "without 'self.r = 1.0'"]
    assert one.crashes == {"week09.area": "nothing assigns self.r"}


@pytest.mark.parametrize("prefix", ["", "f", "rf"])
def test_statements_of_a_program_in_a_string_are_deleted(prefix: str) -> None:
    text = (
        f'def area():\n    return {prefix}"""\nfrom launch import A, B\n\ndef f():\n    return A({{r}})\n"""'
    )
    found = {one.name: one.code for one in made((text,))}
    assert {"without import of A in the text", "without import of B in the text"} <= found.keys()
    assert "from launch import B\n" in found["without import of A in the text"]
    assert any(name.startswith("without 'return A(") and name.endswith("in the text") for name in found)


def test_interdependent_deletions_are_not_grouped_in_one_notebook() -> None:
    cells = ("RADIUS = 2.0", "def area():\n    return RADIUS", "def other():\n    return 1.0")
    tasks = [Task(f"week09.{name}", name, "function", name, HINTS) for name in ("area", "other")]
    code = Code(cells)
    groups = group_deletions(deletions(code, tasks), code, tasks)
    assert all(len({task for one in group for task in one.tasks}) == len(group) for group in groups)
    assert max(map(len, groups)) == 2


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize("file", ["week05_solution.ipynb", "answers/week05_other_right.py"])
def test_launch_file_with_a_deleted_statement_or_import_does_not_pass(file: str) -> None:
    course, count = this_course(), 0

    def run(rehearsals: Sequence[Rehearsal]) -> Iterator[RehearsalResult]:
        nonlocal count
        count += len(rehearsals)
        return (rehearse(one, course) for one in rehearsals)

    code, tasks = Code.from_notebook(course.solutions / file), [catalog_of(course).task("week05.launch_file")]
    assert list(find_false_passes(code, tasks, "week05", run)) == []
    assert count


def run_here(rehearsal: Rehearsal, task: Task, hidden: Scenario) -> RehearsalResult:
    """Run a rehearsal of one task in this process."""
    names: dict[str, object] = {}
    for cell in rehearsal.cells:
        exec(cell, names)
    runs = [
        Run(one, run_in_this_process(task, one, names.get(task.name), {}), one is hidden)
        for one in (*task.scenarios, *[hidden] * rehearsal.with_hidden)
    ]
    return RehearsalResult((judge_task(task, 10, False, runs),), (), (), ())


@pytest.mark.parametrize(("calls", "count"), [((1.0,), 1), ((1.0, -1.0), 0)])
def test_crash_in_a_line_not_covered_by_public_checks_is_reported(
    calls: tuple[float, ...], count: int
) -> None:
    cells = (
        "import math",
        "from pathlib import PurePath",
        AREA.replace('PurePath(".")', 'len(PurePath("a").name)'),
    )
    checks = (expect_value(3.141593, tolerance=1e-5), expect_value(1, call=1))[: len(calls)]
    task, hidden = area_task(*map(Call, calls), checks=checks), Scenario("hidden")
    found = find_false_passes(
        Code(cells), [task], "week09", lambda r: [run_here(one, task, hidden) for one in r]
    )
    assert [why for _, _, why in found] == ["name 'PurePath' is not defined"] * count


def test_crash_in_a_hidden_scenario_only_is_reported() -> None:
    code = Code((AREAS,))
    task = area_task(Call(1.0), checks=(expect_value(3.0, tolerance=1e-5),))
    hidden = Scenario("hidden", calls=(Call(-1.0),), checks=(expect_value(0.0, tolerance=1e-5),))
    with_hidden = list[str]()

    def run(rehearsals: Sequence[Rehearsal]) -> list[RehearsalResult]:
        with_hidden.extend(one.name for one in rehearsals if one.with_hidden)
        return [run_here(one, task, hidden) for one in rehearsals]

    (found,) = find_false_passes(code, [task], "week09", run)
    assert found[:2] == ("without 'known[-1.0] = 0.0'", "week09.area")
    assert found[2].startswith("in a hidden scenario the code raises an exception")
    # The other deletions fail the public check.
    assert with_hidden == ["without 'known[-1.0] = 0.0'"]
