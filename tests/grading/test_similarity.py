"""Similar solutions: disguised copies are found, independent solutions are not."""

import random
import re
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from course_lib.course.exercise import read_notebook, source
from course_lib.course.material import exercises_dir, solutions_dir
from course_lib.grading.submissions.copies import (
    COMMON,
    FEW,
    ComparedSubmission,
    Comparison,
    _shared_weights,
    compare,
    fingerprint,
    normalize_tokens,
    released_code,
)
from tests.notebooks.graded import WEEKS, cells_of, solution
from tests.notebooks.test_answers import ANSWERS

INDEPENDENT = ("other_right", "first_try", "second_try")
Disguise = Callable[[list[str]], list[str]]


def compared(class_of: Mapping[str, Sequence[str]]) -> Comparison:
    given = released_code(exercises_dir())
    works = {student: ComparedSubmission(tuple(cells), "") for student, cells in class_of.items()}
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
    """Rename the student's variables, methods, classes and attributes."""
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


@pytest.mark.sample(1)
@pytest.mark.parametrize("week", WEEKS)
def test_independent_solutions_and_unchanged_exercises_are_not_similar(week: str) -> None:
    assert clusters({**independent(week), "a": stub(week), "b": stub(week), "c": stub(week)}) == []


@pytest.mark.parametrize("disguise", DISGUISES, ids=lambda one: one.__name__)
@pytest.mark.parametrize("week", WEEKS)
def test_copy_is_detected_among_independent_solutions(week: str, disguise: Disguise) -> None:
    copy = disguise(cells_of(solution(week)))
    assert clusters({**independent(week), "copy": copy, "stub": stub(week)}) == [("copy", "solution")]


@pytest.mark.parametrize("count", [2, 3, 30])
def test_class_of_identical_copies_is_one_cluster(count: int) -> None:
    names = [f"s{number:02}" for number in range(count)]
    assert clusters({name: cells_of(solution("week01")) for name in names}) == [tuple(names)]


def test_code_from_the_lessons_is_not_counted_as_similar() -> None:
    lessons = exercises_dir().parent / "notebooks"
    cells = [cell for path in sorted(lessons.glob("week0[12]*.ipynb")) for cell in cells_of(path)]
    assert clusters({"ada": [*stub("week02"), *cells], "bob": [*cells, *stub("week02")]}) == []


def test_written_answers_are_compared_by_words() -> None:
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


def test_identical_small_solution_is_detected(right: str) -> None:
    cells = right.split("# next cell\n")
    assert clusters({"ada": cells, "bob": cells[::-1]}) == [("ada", "bob")]
    assert clusters({"ada": cells[1:2], "bob": cells[1:2]}) == []  # two lines, which anybody would write


def test_frequent_code_has_a_low_similarity_weight() -> None:
    """Every pair shares the half that all have; only two share the other half."""
    own = {f"s{n}": frozenset([*range(100), *range(1000 * n, 1000 * n + 100)]) for n in range(1, 21)}
    copies = {"x": own["s1"] - {1000}, "y": own["s1"] - {1001}}
    lines = dict.fromkeys([*own, *copies], ())
    comparison = compare({**own, **copies}, lines)
    assert [cluster.students for cluster in comparison.clusters] == [("s1", "x", "y")]


def test_pair_far_above_the_class_similarity_is_detected_with_half_in_common() -> None:
    own = {f"s{n}": frozenset([*range(20), *range(1000 * n, 1000 * n + 200)]) for n in range(1, 21)}
    half = frozenset([*range(20), *range(1000, 1100), *range(500, 600)])
    comparison = compare({**own, "half": half}, dict.fromkeys([*own, "half"], ()))
    assert [cluster.students for cluster in comparison.clusters] == [("half", "s1")]


def test_class_with_generally_similar_solutions_is_not_one_cluster() -> None:
    """Each pair shares about two thirds, as of a task that leaves little choice."""
    chance = random.Random(4)
    own = {f"s{n}": frozenset(chance.sample(range(300), 200)) for n in range(30)}
    assert compare(own, dict.fromkeys(own, ())).clusters == ()


@pytest.mark.parametrize(
    "code", ["((((" * 5000, '"""' * 5001, "def f(:\n  x = [\n" * 300, "\0\ud800" * 999, "%%bash\nls"]
)
def test_code_with_syntax_errors_is_compared_as_far_as_possible(code: str) -> None:
    assert len(fingerprint([code]).runs) == len(fingerprint([code]).lines)


def test_fingerprint_lines_match_the_source_lines() -> None:
    cells = ["import math\n# a comment\nx = 1", "y = [1,\n     2]\nprint(3)\nz = (1, 2, 3, 4, 5, 6, 7)"]
    assert [token.line for token in normalize_tokens(cells[0])] == [2, 2, 2]
    (first, *_) = fingerprint(cells).lines
    assert first == (4, 4, 4, 4, 4, 5, 5, 7, 7, 7, 7, 7, 7, 7, 7, 7)


@pytest.mark.slow
def test_each_distinct_cell_of_a_class_of_200_is_tokenized_once() -> None:
    parts = [cell for week in WEEKS for cells in independent(week).values() for cell in cells]
    chance = random.Random(3)
    class_of: dict[str, Sequence[str]] = {f"s{n}": chance.sample(parts, 15) for n in range(200)}
    # The course's own cells are read once for all classes.
    released_code(exercises_dir())
    normalize_tokens.cache_clear()
    assert compared(class_of).median is not None
    assert normalize_tokens.cache_info().misses <= len(set(parts))


@pytest.mark.parametrize("disguise", DISGUISES[1:], ids=lambda one: one.__name__)
@pytest.mark.parametrize("week", WEEKS)
def test_each_disguise_changes_the_solution_of_each_week(week: str, disguise: Disguise) -> None:
    assert disguise(cells_of(solution(week))) != cells_of(solution(week))


def test_every_solution_has_code_that_the_exercise_lacks() -> None:
    given = released_code(exercises_dir())
    for path in solutions_dir().glob("week*_solution.ipynb"):
        cells = [source(cell) for cell in read_notebook(path)["cells"] if cell["cell_type"] == "code"]
        assert len(given.own_runs(ComparedSubmission(tuple(cells), ""))) > 200, Path(path).name


@pytest.mark.slow
def test_shared_weights_of_rare_and_frequent_sequences_match_each_pair() -> None:
    chance = random.Random(4)
    solutions = [frozenset(run for run in range(3000) if chance.random() < run / 3000) for _ in range(60)]
    number = Counter(run for own in solutions for run in own)
    weight = {run: min(1.0, max(FEW, COMMON * len(solutions)) / count) for run, count in number.items()}
    expected = [[sum(weight[run] for run in one & other) for other in solutions] for one in solutions]
    assert np.allclose(_shared_weights(solutions), expected)


@pytest.mark.slow
def test_class_of_300_with_long_common_code_is_compared_within_seconds() -> None:
    """Runs are shared by all, by five or by two."""

    def runs_of(number: int) -> frozenset[int]:
        two, five = 10**6 + number // 2 * 6000, 10**8 + number // 5 * 3000
        return frozenset([*range(2000), *range(two, two + 6000), *range(five, five + 3000)])

    runs = {f"s{number:03}": runs_of(number) for number in range(300)}
    begin = time.process_time()
    comparison = compare(runs, {})
    assert time.process_time() - begin < 15
    assert [cluster.students for cluster in comparison.clusters][:2] == [("s000", "s001"), ("s002", "s003")]
