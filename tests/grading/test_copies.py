"""Copies in a graded class: shown to the instructor, never to students, and never a mark."""

from collections.abc import Callable, Sequence
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest
from playwright.sync_api import Page

from course_lib.course.installation import exercises_dir
from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.handin.copies import MAX_CODE, alike_in, compare_class
from course_lib.grading.handin.ids import with_ids
from course_lib.grading.handin.submission import find_submissions
from course_lib.grading.marks.mark import results_in
from course_lib.grading.records import Course
from tests.grading.test_report_pages import browser as browser  # a fixture
from tests.grading.test_report_pages import page as page  # a fixture
from tests.notebooks.graded import cells_of, solution
from tests.notebooks.test_answers import ANSWERS

WriteNotebook = Callable[..., Path]
NAME = "week01_exercise.ipynb"
PAGE = "copies_week01_exercise.html"
HOSTILE = '<script>document.title = "run"</script><img src=x onerror="document.title = 1">'


# A student's own cell: most lines of week 1's answers are handed out in a faulty start.
OWN = """\
def corners_of(width, depth, height):
    corners = []
    for x in (-width / 2, width / 2):
        for y in (-depth / 2, depth / 2):
            for z in (0.0, height):
                corners.append((x, y, z))
    return corners


def longest_way(corners):
    longest = 0.0
    for first in corners:
        for second in corners:
            squares = [(a - b) ** 2 for a, b in zip(first, second)]
            longest = max(longest, sum(squares) ** 0.5)
    return longest


print(longest_way(corners_of(1.0, 2.0, 3.0)))
"""


def cells_as_code(cells: Sequence[str]) -> str:
    return "# next cell\n".join(f"{cell}\n" for cell in cells)


def compared(top: Path, out: Path) -> dict[tuple[str, str], tuple[str, ...]]:
    """Return the pairs of similar submissions in a folder."""
    compare_class(with_ids(find_submissions(top), top), out, exercises_dir(), ZoneInfo("UTC"))
    return {key: alike.others for key, alike in alike_in(out).items()}


@pytest.fixture
def write(tmp_path: Path, write_notebook: WriteNotebook) -> Callable[..., Path]:
    """Writes one student's notebook of cells."""

    def make(student: str, cells: Sequence[str], folder: str = "in", name: str = NAME) -> Path:
        return write_notebook(tmp_path / folder / student / name, cells_as_code(cells), student=student)

    return make


def test_three_identical_solutions_under_three_ids_are_shown(
    course: Course,
    right: str,
    tmp_path: Path,
    write_notebook: WriteNotebook,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for student in ("ada", "bob", "cleo"):
        write_notebook(tmp_path / "in" / student / NAME, right, student=student)
    write_notebook(tmp_path / "in/dora" / NAME, "x = 1", student="dora")
    out = tmp_path / "out"
    grade(tmp_path / "in", out, jobs=1, course=course)
    said = capsys.readouterr().out
    assert "Look at: similar code: 3 submissions (ada week01_exercise, bob week01_exercise, cleo" in said
    assert str(out / "reports" / PAGE) in said
    index = (out / "reports/index.html").read_text()
    assert f'<a href="{PAGE}#cluster-1">similar code: bob, cleo</a>' in index
    assert index.count("similar code: ") == 4  # three lines, and one on top
    marks = {result["student"]: result["row"] for result in results_in(out)}
    assert {marks[name]["status"] for name in marks} == {"graded"}
    assert marks["ada"]["score"] == marks["cleo"]["score"] == 110
    for student in marks:
        report = (out / "reports" / student / "week01_exercise.html").read_text()
        assert "imilar" not in report
        assert not {"ada", "bob", "cleo"} - {student} & set(report.split())


def test_grading_some_again_still_compares_all(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    for student in ("ada", "bob"):
        write_notebook(tmp_path / "in" / student / NAME, right, student=student)
    out = tmp_path / "out"
    grade(tmp_path / "in", out, jobs=1, course=course)
    grade(tmp_path / "in", out, jobs=1, only="ada/*", course=course)
    grade(tmp_path / "in", out, jobs=1, resume=True, course=course)
    write_notebook(tmp_path / "late/cleo" / NAME, right, student="cleo")
    grade(tmp_path / "late", out, jobs=1, course=course)  # a folder of its own
    assert alike_in(out)["ada", "week01_exercise"].others == ("bob", "cleo")


def test_each_exercise_is_compared_with_itself_only(write: Callable[..., Path], tmp_path: Path) -> None:
    write("ada", cells_of(solution("week01")))
    write("bob", cells_of(solution("week01")), name="week02_exercise.ipynb")
    assert compared(tmp_path / "in", tmp_path / "out") == {}


def test_an_earlier_attempt_and_a_program_beside_the_notebook_count(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    cells = cells_of(solution("week01"))
    write("ada", cells)
    program = write("bob", ['run("nodes.py")'])
    program.with_name("nodes.py").write_text("\n".join(cells))
    assert compared(tmp_path / "in", tmp_path / "out")["bob", "week01_exercise"] == ("ada",)


def test_code_without_end_is_compared_as_far_as_a_solution_goes(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    cells = cells_of(solution("week01"))
    write("ada", cells)
    write("bob", [*cells, *(f"x = {'(' * MAX_CODE}{number}" for number in range(20))])
    assert compared(tmp_path / "in", tmp_path / "out")["ada", "week01_exercise"] == ("bob",)
    assert (tmp_path / "out/reports" / PAGE).stat().st_size < 10 * MAX_CODE


def test_a_damaged_file_of_copies_is_named(write: Callable[..., Path], tmp_path: Path) -> None:
    write("ada", ["x = 1"])
    compared(tmp_path / "in", tmp_path / "out")
    kept = tmp_path / "out/copies/week01_exercise.json"
    kept.write_text("{")
    with pytest.raises(CourseError, match=r"week01_exercise\.json can't be read.*Remove it"):
        compared(tmp_path / "in", tmp_path / "out")


@pytest.mark.browser
def test_the_page_shows_copies_side_by_side(page: Page, write: Callable[..., Path], tmp_path: Path) -> None:
    cells = [*cells_of(solution("week01")), OWN]
    write("ada", cells)
    hostile = [cell.replace('"map"', f"'{HOSTILE}'").replace("marker", "m") for cell in reversed(cells)]
    write("bob", hostile)
    write("cleo", cells_of(ANSWERS / "week01_other_right.py"))
    compared(tmp_path / "in", tmp_path / "out")
    page.goto((tmp_path / "out/reports" / PAGE).as_uri())
    sides = page.get_by_role("region", name="code of")
    assert sides.count() == 2
    assert page.get_by_text("cleo").count() == 0
    like = sides.nth(0).locator("tr.same a")
    assert like.count() > 20
    like.first.click()
    target = page.locator(":target")
    assert target.evaluate("row => row.closest('section').ariaLabel") == "code of bob"
    assert "as handed out" in sides.nth(0).inner_text()
    assert HOSTILE in sides.nth(1).inner_text()
    assert page.title() == "Similar code: week01_exercise"
    assert page.locator("main img, main script").count() == 0
    dead = "all => all.filter((e) => !document.getElementById(e.hash.slice(1))).length"
    assert page.locator("tr.same a").evaluate_all(dead) == 0
    columns = page.locator("details[open] .code").evaluate_all(
        "all => all.map((e) => e.getBoundingClientRect().y)"
    )
    assert len(set(columns)) == 1
