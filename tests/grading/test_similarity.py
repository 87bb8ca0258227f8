"""Similar solutions: copies in any disguise, and none that were written independently."""

import random
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import pytest

from course_lib.course.exercise import read_notebook, source
from course_lib.course.installation import exercises_dir, solutions_dir
from course_lib.grading.handin.copies import Work, handed_out
from course_lib.grading.handin.similarity import Comparison, compare, fingerprint, normalised
from tests.notebooks.graded import WEEKS, cells_of, solution
from tests.notebooks.test_answers import ANSWERS

INDEPENDENT = ("other_right", "first_try", "second_try")
Disguise = Callable[[list[str]], list[str]]


def compared(class_of: Mapping[str, Sequence[str]]) -> Comparison:
    given = handed_out(exercises_dir())
    works = {student: Work(tuple(cells), "") for student, cells in class_of.items()}
    return compare(
        {student: given.own_runs(work) for student, work in works.items()},
        {student: given.own_lines(work) for student, work in works.items()},
    )


def clusters(class_of: Mapping[str, Sequence[str]]) -> list[tuple[str, ...]]:
    return [cluster.students for cluster in compared(class_of).clusters]


def stub(week: str) -> list[str]:
    return cells_of(exercises_dir() / f"{week}_exercise.ipynb")


def independent(week: str) -> dict[str, Sequence[str]]:
    """Our solution and the other answers to a week that the tests have."""
    others = {name: cells_of(ANSWERS / f"{week}_{name}.py") for name in INDEPENDENT}
    return {"solution": cells_of(solution(week)), **others}


def renamed(cells: list[str]) -> list[str]:
    """Other names for what the student named: variables, methods, classes and attributes."""
    code = "\n".join(cells)
    assigned = re.findall(
        r"^\s+(?:self\.)?([a-z_]\w+) = |def ([a-z]\w+)\(|for (\w+) in|^class (\w+)", code, re.M
    )
    names = {name for row in assigned for name in row if name}
    pattern = re.compile(
        r"(?<![\w.\"'/])(self\.)?\b(" + "|".join(sorted(names)) + r")\b(?!\w*=)(?! ?=[^=]*\))"
    )
    return [pattern.sub(lambda m: f"{m[1] or ''}{m[2]}_of_mine", cell) for cell in cells]


def commented(cells: list[str]) -> list[str]:
    return [re.sub(r"(?m)(.)$", r"\1  # I wrote this", cell) for cell in cells]


def printing(cells: list[str]) -> list[str]:
    """A print and a log line before each return, assignment to a field, and publish."""
    added = r'\1print("here", 1)\n\1self.get_logger().info("there")\n\1\2'
    return [re.sub(r"(?m)^( {8,})(\w+\.\w+.* = [^(\[{]*|return .*)$", added, cell) for cell in cells]


def other_numbers(cells: list[str]) -> list[str]:
    return [re.sub(r"\b\d+\.\d+\b", lambda m: f"{float(m[0]) + 0.25}", cell) for cell in cells]


def reordered(cells: list[str]) -> list[str]:
    return random.Random(1).sample(cells, len(cells))


def reindented(cells: list[str]) -> list[str]:
    return [re.sub(r"(?m)^( +)", r"\1\1", cell).replace(", ", " ,  ") for cell in cells]


def all_of_it(cells: list[str]) -> list[str]:
    return reordered(commented(printing(other_numbers(cells))))


DISGUISES: tuple[Disguise, ...] = (
    list, renamed, commented, printing, other_numbers, reordered, reindented, all_of_it,
)  # fmt: skip


@pytest.mark.parametrize("week", WEEKS)
def test_independent_solutions_and_untouched_exercises_are_not_alike(week: str) -> None:
    assert clusters({**independent(week), "a": stub(week), "b": stub(week), "c": stub(week)}) == []


@pytest.mark.parametrize("disguise", DISGUISES, ids=lambda one: one.__name__)
@pytest.mark.parametrize("week", WEEKS)
def test_a_copy_is_found_among_independent_solutions(week: str, disguise: Disguise) -> None:
    copy = disguise(cells_of(solution(week)))
    assert clusters({**independent(week), "copy": copy, "stub": stub(week)}) == [("copy", "solution")]


@pytest.mark.parametrize("count", [2, 3, 30])
def test_a_class_that_copied_as_a_whole_is_one_cluster(count: int) -> None:
    names = [f"s{number:02}" for number in range(count)]
    assert clusters({name: cells_of(solution("week01")) for name in names}) == [tuple(names)]


def test_code_of_the_lessons_is_nobodys_own() -> None:
    lessons = exercises_dir().parent / "notebooks"
    cells = [cell for path in sorted(lessons.glob("week0[12]*.ipynb")) for cell in cells_of(path)]
    assert clusters({"ada": [*stub("week02"), *cells], "bob": [*cells, *stub("week02")]}) == []


def test_an_answer_in_words_is_compared_word_by_word() -> None:
    text = re.search(r'findings = """(.*?)"""', "\n".join(cells_of(solution("week06"))), re.DOTALL)
    assert text is not None
    words = text[1].split()
    other = random.Random(2).sample(words, len(words))
    as_text = {
        "ada": [f'findings = """{" ".join(words)}"""'],
        "bob": [f'answer = ("{" ".join(words[:40])} " "{" ".join(words[40:])}")'],
        "cleo": [f'findings = """{" ".join(other)}"""'],
    }
    assert clusters(as_text) == [("ada", "bob")]


def test_a_small_solution_that_is_the_same_letter_by_letter_is_found(right: str) -> None:
    cells = right.split("# next cell\n")
    assert clusters({"ada": cells, "bob": cells[::-1]}) == [("ada", "bob")]
    assert clusters({"ada": cells[1:2], "bob": cells[1:2]}) == []  # two lines, which anybody would write


def test_what_many_write_by_themselves_counts_little() -> None:
    """Every pair shares the half that all have; only two share the other half."""
    own = {f"s{n}": frozenset([*range(100), *range(1000 * n, 1000 * n + 100)]) for n in range(1, 21)}
    copies = {"x": own["s1"] - {1000}, "y": own["s1"] - {1001}}
    lines = dict.fromkeys([*own, *copies], ())
    found = compare({**own, **copies}, lines)
    assert [cluster.students for cluster in found.clusters] == [("s1", "x", "y")]


def test_a_pair_far_above_its_class_is_found_with_half_of_it_in_common() -> None:
    own = {f"s{n}": frozenset([*range(20), *range(1000 * n, 1000 * n + 200)]) for n in range(1, 21)}
    half = frozenset([*range(20), *range(1000, 1100), *range(500, 600)])
    found = compare({**own, "half": half}, dict.fromkeys([*own, "half"], ()))
    assert [cluster.students for cluster in found.clusters] == [("half", "s1")]


def test_a_class_that_is_alike_by_nature_is_not_one_cluster() -> None:
    """Each pair shares about two thirds, as of a task that leaves little choice."""
    chance = random.Random(4)
    own = {f"s{n}": frozenset(chance.sample(range(300), 200)) for n in range(30)}
    assert compare(own, dict.fromkeys(own, ())).clusters == ()


@pytest.mark.parametrize(
    "code", ["((((" * 5000, '"""' * 5001, "def f(:\n  x = [\n" * 300, "\0\ud800" * 999, "%%bash\nls"]
)
def test_code_that_does_not_parse_is_compared_as_far_as_it_can_be(code: str) -> None:
    assert len(fingerprint([code]).runs) == len(fingerprint([code]).lines)


def test_lines_of_a_fingerprint_are_those_of_the_code() -> None:
    cells = ["import math\n# a comment\nx = 1", "y = [1,\n     2]\nprint(3)\nz = (1, 2, 3, 4, 5, 6, 7)"]
    assert [token.line for token in normalised(cells[0])] == [2, 2, 2]
    (first, *_) = fingerprint(cells).lines
    assert first == (4, 4, 4, 4, 4, 5, 5, 7, 7, 7, 7, 7, 7, 7, 7, 7)


def test_a_class_of_200_takes_one_look_at_each_different_cell() -> None:
    parts = [cell for week in WEEKS for cells in independent(week).values() for cell in cells]
    chance = random.Random(3)
    class_of: dict[str, Sequence[str]] = {f"s{n}": chance.sample(parts, 15) for n in range(200)}
    normalised.cache_clear()
    assert compared(class_of).median is not None
    assert normalised.cache_info().misses <= len(set(parts))


@pytest.mark.parametrize("disguise", DISGUISES[1:], ids=lambda one: one.__name__)
@pytest.mark.parametrize("week", WEEKS)
def test_each_disguise_changes_each_week(week: str, disguise: Disguise) -> None:
    assert disguise(cells_of(solution(week))) != cells_of(solution(week))


def test_the_solutions_have_code_of_their_own() -> None:
    given = handed_out(exercises_dir())
    for path in solutions_dir().glob("week*_solution.ipynb"):
        cells = [source(cell) for cell in read_notebook(path)["cells"] if cell["cell_type"] == "code"]
        assert len(given.own_runs(Work(tuple(cells), ""))) > 200, Path(path).name
