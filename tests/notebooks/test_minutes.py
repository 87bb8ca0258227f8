"""The stated minutes agree with an estimate, and the README with the notebooks.

How times are estimated, for a student who reads English as a second language: 80 words of prose a
minute; a line of code read in 15 s; a cell run and looked at in 45 s; 4 minutes for each "Try it";
a minute for a prediction; 5 minutes for a quiz. STRANGERS are the lessons as readers met them who
had never seen them: with 9 s and 30 s the estimate said 128, 176 and 150 minutes, too little the
more code a lesson has. An exercise: the same words; a line of given code read in 9 s, as most of it
is known from the lesson; 54 s for each line of an answer, written or copied and corrected; 4
minutes for each task, its checks and hints. Students differ by a factor of two, so the time of an
exercise may differ from the estimate by a third.
"""

import re
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from course_lib.course.exercise import BEGIN, END, read_notebook, source
from course_lib.course.material import exercises_dir, lessons, solutions_dir

LESSONS = lessons()
EXERCISES = sorted(exercises_dir().glob("week*.ipynb"))
ROOT = Path(__file__).parents[2]
WORDS_A_MINUTE = 80
PER_LINE, PER_CELL, PER_TRY, PER_PREDICTION, PER_QUIZ = 0.25, 0.75, 4.0, 1.0, 5.0  # [min]
PER_KNOWN_LINE, PER_LINE_WRITTEN, PER_TASK = 0.15, 0.9, 4.0  # [min]
SPREAD, SPREAD_OF_EXERCISES = 0.15, 1 / 3
OPTIONAL = re.compile(r"^## If you have time \(\+(\d+) min\)$", re.MULTILINE)


class Content(NamedTuple):
    """The amounts of text, code and exercises in a lesson."""

    words: int
    lines: int  # of code
    cells: int
    tries: int
    predictions: int

    def minutes(self) -> float:
        code = self.lines * PER_LINE + self.cells * PER_CELL
        asked = self.tries * PER_TRY + self.predictions * PER_PREDICTION
        return self.words / WORDS_A_MINUTE + code + asked


STRANGERS = {  # lesson: its content when a new reader worked through it, and the minutes taken
    "week02_joint_states": (Content(2958, 255, 49, 4, 7), 155),
    "week06_tooling": (Content(3470, 393, 76, 6, 7), 260),
    "week07_dashboard": (Content(3010, 344, 49, 6, 7), 190),
}


def sources(path: Path, kind: str) -> list[str]:
    return [source(cell) for cell in read_notebook(path)["cells"] if cell["cell_type"] == kind]


def lines_of(cells: list[str]) -> int:
    return sum(bool(line.strip()) for text in cells for line in text.splitlines())


def words_of(cells: list[str]) -> int:
    return sum(len(re.findall(r"\w+", text)) for text in cells)


def contents(path: Path) -> tuple[Content, Content]:
    """Return the content of a lesson, and of its optional section."""
    cells = read_notebook(path)["cells"]
    begins = [i for i, cell in enumerate(cells) if OPTIONAL.search(source(cell))]
    end = len(cells) - 1 if begins else len(cells)  # the last cell is the further reading
    begin = begins[0] if begins else end
    return content(cells[:begin] + cells[end:]), content(cells[begin:end])


def is_skimmed(cell: dict[str, Any]) -> bool:
    """Return whether the lesson states that a cell need not be read yet."""
    return "skim" in cell["metadata"].get("tags", [])


def content(cells: list[dict[str, Any]]) -> Content:
    prose = [source(cell) for cell in cells if cell["cell_type"] == "markdown"]
    code = [source(cell) for cell in cells if cell["cell_type"] == "code"]
    read_code = [source(cell) for cell in cells if cell["cell_type"] == "code" and not is_skimmed(cell)]
    tries = sum(text.count("**Try it") for text in prose)
    predictions = sum("predict(" in cell for cell in code)
    return Content(words_of(prose), lines_of(read_code), len(code), tries, predictions)


def lines_of_answers(solution: Path) -> int:
    count, inside = 0, False
    for line in (line for text in sources(solution, "code") for line in text.splitlines()):
        inside = (inside or bool(BEGIN.match(line))) and END not in line
        count += inside and bool(line.strip()) and not BEGIN.match(line)
    return count


def minutes_of_exercise(path: Path) -> float:
    solution = solutions_dir() / path.name.replace("exercise", "solution")
    tasks = sum(text.count("check(") for text in sources(path, "code"))
    code_reading = lines_of(sources(path, "code")) * PER_KNOWN_LINE
    reading = words_of(sources(path, "markdown")) / WORDS_A_MINUTE + code_reading
    return reading + lines_of_answers(solution) * PER_LINE_WRITTEN + tasks * PER_TASK


def stated(path: Path) -> int:
    match = re.search(r"\*\*Time: (\d+) minutes in total", "\n".join(sources(path, "markdown")))
    assert match is not None
    return int(match[1])


@pytest.mark.parametrize(("read", "took"), STRANGERS.values(), ids=STRANGERS)
def test_estimated_minutes_agree_with_measured_reading_times(read: Content, took: float) -> None:
    assert read.minutes() + PER_QUIZ == pytest.approx(took, rel=SPREAD)


@pytest.mark.parametrize("path", LESSONS, ids=lambda path: path.stem)
def test_stated_minutes_of_a_lesson_match_the_estimate(path: Path) -> None:
    needed, optional = contents(path)
    assert stated(path) == pytest.approx(needed.minutes() + PER_QUIZ, rel=SPREAD)
    more = OPTIONAL.search("\n".join(sources(path, "markdown")))
    assert int(more[1] if more else 0) == pytest.approx(optional.minutes(), rel=SPREAD)


@pytest.mark.parametrize("path", EXERCISES, ids=lambda path: path.stem)
def test_stated_minutes_of_an_exercise_match_the_estimate(path: Path) -> None:
    assert stated(path) == pytest.approx(minutes_of_exercise(path), rel=SPREAD_OF_EXERCISES)


@pytest.mark.parametrize("path", [*LESSONS, *EXERCISES], ids=lambda path: path.stem)
def test_readme_minutes_equal_the_notebook_minutes(path: Path) -> None:
    rows = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    (row,) = (row for row in rows if row.startswith(f"| {int(path.stem[4:6])} "))
    column = 4 if path in EXERCISES else 3
    assert row.split("|")[column].strip() == f"{stated(path)} min"


@pytest.mark.parametrize("path", EXERCISES, ids=lambda path: path.stem)
def test_exercise_text_and_metadata_state_the_same_minutes(path: Path) -> None:
    assert read_notebook(path)["metadata"]["course"]["minutes"] == stated(path)
