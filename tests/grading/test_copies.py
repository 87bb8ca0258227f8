"""Copies in a graded class: shown to the instructor, never to students, and never a mark."""

import base64
import random
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest
from playwright.sync_api import Page

from course_lib.course.material import exercises_dir
from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.marks import results_in
from course_lib.grading.store import Course, catalog_of, this_course
from course_lib.grading.submissions.copies import (
    MAX_CODE,
    compare_class,
    find_indirect_code,
    read_similar,
    released_code,
)
from course_lib.grading.submissions.submission import find_submissions, resolve_ids
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
    tasks = catalog_of(this_course()).tasks.values()
    compare_class(resolve_ids(find_submissions(top), top), out, exercises_dir(), ZoneInfo("UTC"), tasks)
    return {key: alike.others for key, alike in read_similar(out).items()}


@pytest.fixture
def write(tmp_path: Path, write_notebook: WriteNotebook) -> Callable[..., Path]:
    """Writes one student's notebook of cells."""

    def make(student: str, cells: Sequence[str], folder: str = "in", name: str = NAME) -> Path:
        return write_notebook(tmp_path / folder / student / name, cells_as_code(cells), student=student)

    return make


@pytest.mark.slow
def test_three_identical_solutions_with_different_ids_are_reported(
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
    output = capsys.readouterr().out
    assert (
        "Please review: similar code: 3 submissions (ada week01_exercise, bob week01_exercise, cleo" in output
    )
    assert str(out / "reports" / PAGE) in output
    index = (out / "reports/index.html").read_text()
    assert f'<a href="{PAGE}#cluster-1">similar code: bob, cleo</a>' in index
    assert index.count("similar code: ") == 4  # three lines, and one on top
    marks = {one.student: one.row for one in results_in(out)}
    assert {marks[name].status for name in marks} == {"graded"}
    assert marks["ada"].cells["score"] == marks["cleo"].cells["score"] == 110
    for student in marks:
        report = (out / "reports" / student / "week01_exercise.html").read_text()
        assert "imilar" not in report
        assert not {"ada", "bob", "cleo"} - {student} & set(report.split())


@pytest.mark.slow
def test_regrading_some_submissions_compares_all(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    for student in ("ada", "bob"):
        write_notebook(tmp_path / "in" / student / NAME, right, student=student)
    out = tmp_path / "out"
    grade(tmp_path / "in", out, jobs=1, course=course)
    grade(tmp_path / "in", out, jobs=1, only="ada/*", course=course)
    grade(tmp_path / "in", out, jobs=1, resume=True, course=course)
    write_notebook(tmp_path / "late/cleo" / NAME, right, student="cleo")
    grade(tmp_path / "late", out, jobs=1, course=course)  # a separate folder
    assert read_similar(out)["ada", "week01_exercise"].others == ("bob", "cleo")


@pytest.mark.slow
def test_submissions_are_compared_only_within_one_exercise(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    write("ada", cells_of(solution("week01")))
    write("bob", cells_of(solution("week01")), name="week02_exercise.ipynb")
    assert compared(tmp_path / "in", tmp_path / "out") == {}


def test_earlier_attempt_and_program_next_to_the_notebook_are_compared(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    cells = cells_of(solution("week01"))
    write("ada", cells)
    program = write("bob", ['run("nodes.py")'])
    program.with_name("nodes.py").write_text("\n".join(cells))
    assert compared(tmp_path / "in", tmp_path / "out")["bob", "week01_exercise"] == ("ada",)


@pytest.mark.slow
def test_excessively_long_code_is_compared_up_to_a_limit(write: Callable[..., Path], tmp_path: Path) -> None:
    cells = cells_of(solution("week01"))
    write("ada", cells)
    write("bob", [*cells, *(f"x = {'(' * MAX_CODE}{number}" for number in range(20))])
    assert compared(tmp_path / "in", tmp_path / "out")["ada", "week01_exercise"] == ("bob",)
    assert (tmp_path / "out/reports" / PAGE).stat().st_size < 10 * MAX_CODE


def junk(size: int, seed: int) -> str:
    """Return valid code of so many characters that two students do not share."""
    chance, lines = random.Random(seed), list[str]()
    while sum(map(len, lines)) < size:
        operators = "".join(chance.choice("+-*/%&|^") + chance.choice("xyz") for _ in range(12))
        lines.append(f"junk_{len(lines)} = lambda x, y, z: x{operators}\n")
    return "".join(lines)


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize("where", ["cell", "same cell", "behind magic", "program"])
def test_junk_code_before_a_copy_does_not_hide_it_and_is_reported(
    write: Callable[..., Path], tmp_path: Path, where: str
) -> None:
    cells = cells_of(solution("week01"))
    write("ada", cells)
    if where == "same cell":
        path = write("bob", [junk(74_000, 1) + "\n" + "\n".join(cells)])
    elif where == "behind magic":
        path = write("bob", ["%matplotlib inline\n" + junk(300_000, 1) + "\n" + "\n".join(cells)])
    else:
        path = write("bob", [junk(74_000, 1), *cells] if where == "cell" else [*cells, 'run("aaa.py")'])
    if where == "program":
        path.with_name("aaa.py").write_text(junk(74_000, 1))
    write("cleo", [OWN])
    out = tmp_path / "out"
    assert compared(tmp_path / "in", out)["bob", "week01_exercise"] == ("ada",)
    assert "kB not compared" in read_similar(out)["bob", "week01_exercise"].remarks[0]
    assert read_similar(out)["ada", "week01_exercise"].remarks == ()
    text = (out / "reports" / PAGE).read_text()
    assert 'id="not-compared"' in text
    assert "kB not compared" in text


@pytest.mark.slow
def test_effective_definition_is_compared_even_if_its_name_is_bound_before(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    cells = cells_of(solution("week01"))
    fakes = "".join(f"class RedCubeNode:\n    {line}\n" for line in junk(90_000, 2).splitlines())
    write("ada", cells)
    write("bob", [fakes, *cells])
    assert compared(tmp_path / "in", tmp_path / "out")["bob", "week01_exercise"] == ("ada",)


def packed(code: str) -> str:
    return base64.b64encode(zlib.compress(code.encode())).decode()


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    "unpack",
    [
        "import base64, zlib\nexec(zlib.decompress(base64.b64decode('{}')))",
        "from base64 import b64decode as d\nfrom zlib import decompress as z\n"
        "eval(compile(z(d('{}')), '', 'exec'))",
        "import builtins as b, base64 as c, zlib\nb.exec(zlib.decompress(c.b64decode('{}')))",
        "import codecs\nget_ipython().run_cell(codecs.decode('{}', 'base64'))",
    ],
)
def test_two_copies_in_packed_code_are_listed_and_reported(
    write: Callable[..., Path], tmp_path: Path, unpack: str
) -> None:
    code = "\n".join(cells_of(solution("week01")))
    for student in ("ada", "bob"):
        write(student, [f"# {student}\n{unpack.format(packed(code))}"])
    for number in range(10):
        write(f"s{number}", [junk(3000, number)])
    out = tmp_path / "out"
    assert compared(tmp_path / "in", out)["ada", "week01_exercise"] == ("bob",)
    for student in ("ada", "bob"):
        (remark,) = read_similar(out)[student, "week01_exercise"].remarks
        assert remark.startswith("uses ")


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("exec(open('x.txt').read())", "uses exec"),
        ("import marshal", "uses marshal"),
        ("\uff45xec(x)", "uses exec"),
        ("f = types.FunctionType(code, {})", "uses FunctionType"),
        ("bytes.fromhex('00')", "uses fromhex"),
        ("%run other.txt", "uses a magic that runs code"),
        ("%%python3\nx = 1", "uses a magic that runs code"),
        ("__builtins__['ex' + 'ec'](x)", "uses __builtins__"),
    ],
)
def test_code_that_runs_other_code_is_reported(code: str, says: str) -> None:
    assert find_indirect_code([code], ()) == (says,)
    assert find_indirect_code([code], [line.strip() for line in code.splitlines()]) == ()


@pytest.mark.parametrize(
    "code",
    [
        "re.compile('x')",
        "model.eval()",
        "# exec",
        "'exec(x)'",
        "execute = evaluate = 1",
        "%matplotlib inline",
    ],
)
def test_code_without_indirect_execution_is_not_reported(code: str) -> None:
    assert find_indirect_code([code], ()) == ()


@pytest.mark.parametrize("week", [f"week{number:02}" for number in range(1, 9)])
def test_correct_solutions_are_not_reported(week: str) -> None:
    assert find_indirect_code(cells_of(solution(week)), released_code(exercises_dir()).lines) == ()


def test_submissions_that_were_not_compared_are_listed_in_index_and_terminal(
    course: Course,
    right: str,
    tmp_path: Path,
    write_notebook: WriteNotebook,
    capsys: pytest.CaptureFixture[str],
) -> None:
    write_notebook(tmp_path / "in/ada" / NAME, f"{right}\nexec('x = 1')", student="ada")
    write_notebook(tmp_path / "in/bob" / NAME, OWN, student="bob")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    output = capsys.readouterr().out
    assert "Please review: code not compared: 1 submission (ada week01_exercise)" in output
    assert PAGE in output
    assert "code not compared: uses exec" in (tmp_path / "out/reports/index.html").read_text()
    assert "not compared" not in (tmp_path / "out/reports/ada/week01_exercise.html").read_text()


@pytest.mark.slow
def test_long_list_of_students_with_identical_files_is_abbreviated(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    for number in range(12):
        write_notebook(tmp_path / "in" / f"s{number:02}" / NAME, right, student="")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    notes = [note for result in results_in(tmp_path / "out") for note in result.result.notes]
    assert "the same file as that of s00, s01, s02, s03, s04, 6 more" in notes


@pytest.mark.slow
def test_damaged_copies_file_is_reported(write: Callable[..., Path], tmp_path: Path) -> None:
    write("ada", ["x = 1"])
    compared(tmp_path / "in", tmp_path / "out")
    kept = tmp_path / "out/copies/week01_exercise.json"
    kept.write_text("{")
    with pytest.raises(CourseError, match=r"week01_exercise\.json can't be read.*Remove it"):
        compared(tmp_path / "in", tmp_path / "out")


@pytest.mark.slow
@pytest.mark.browser
def test_report_page_shows_copies_side_by_side(
    page: Page, write: Callable[..., Path], tmp_path: Path
) -> None:
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
