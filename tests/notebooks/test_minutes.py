"""Stated minutes beside an estimate, and the README's beside the notebooks'.

How times are estimated, for a student who reads English as a second language: 80 words of prose a
minute; a line of code read in 9 s; a cell run and looked at in 30 s; 4 minutes for each "Try it"; a
minute for a prediction; 5 minutes for a quiz. An exercise: the same for words and lines of given code;
54 s for each line of an answer, written or copied and corrected; 4 minutes for each task, its checks and
hints. Students differ by a factor of two, so a stated time may differ from the estimate by a third.
"""

import re
from pathlib import Path

import pytest

from course_lib.course.exercise import BEGIN, END, read_notebook, source
from course_lib.course.installation import exercises_dir, lessons, solutions_dir

LESSONS = lessons()
EXERCISES = sorted(exercises_dir().glob("week*.ipynb"))
ROOT = Path(__file__).parents[2]
WORDS_A_MINUTE = 80
PER_LINE, PER_CELL, PER_TRY, PER_PREDICTION, PER_QUIZ = 0.15, 0.5, 4.0, 1.0, 5.0  # [min]
PER_LINE_WRITTEN, PER_TASK = 0.9, 4.0  # [min]
SPREAD = 1 / 3


def sources(path: Path, kind: str) -> list[str]:
    return [source(cell) for cell in read_notebook(path)["cells"] if cell["cell_type"] == kind]


def reading(path: Path) -> float:
    """Minutes for the prose and the code of a notebook."""
    words = sum(len(re.findall(r"\w+", text)) for text in sources(path, "markdown"))
    lines = sum(bool(line.strip()) for text in sources(path, "code") for line in text.splitlines())
    return words / WORDS_A_MINUTE + lines * PER_LINE


def minutes_of_lesson(path: Path) -> float:
    code = sources(path, "code")
    tries = sum(text.count("**Try it") for text in sources(path, "markdown"))
    asked = sum("predict(" in cell for cell in code) * PER_PREDICTION
    return reading(path) + len(code) * PER_CELL + tries * PER_TRY + asked + PER_QUIZ


def lines_of_answers(solution: Path) -> int:
    count, inside = 0, False
    for line in (line for text in sources(solution, "code") for line in text.splitlines()):
        inside = (inside or bool(BEGIN.match(line))) and END not in line
        count += inside and bool(line.strip()) and not BEGIN.match(line)
    return count


def minutes_of_exercise(path: Path) -> float:
    solution = solutions_dir() / path.name.replace("exercise", "solution")
    tasks = sum(text.count("check(") for text in sources(path, "code"))
    return reading(path) + lines_of_answers(solution) * PER_LINE_WRITTEN + tasks * PER_TASK


def stated(path: Path) -> int:
    found = re.search(r"\*\*Time: (\d+) minutes in total", "\n".join(sources(path, "markdown")))
    assert found is not None
    return int(found[1])


@pytest.mark.parametrize("path", [*LESSONS, *EXERCISES], ids=lambda path: path.stem)
def test_the_stated_minutes_are_near_the_estimate(path: Path) -> None:
    estimate = minutes_of_lesson(path) if path in LESSONS else minutes_of_exercise(path)
    assert stated(path) == pytest.approx(estimate, rel=SPREAD)


@pytest.mark.parametrize("path", [*LESSONS, *EXERCISES], ids=lambda path: path.stem)
def test_the_readme_states_the_same_minutes(path: Path) -> None:
    rows = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    (row,) = (row for row in rows if row.startswith(f"| {int(path.stem[4:6])} "))
    column = 4 if path in EXERCISES else 3
    assert row.split("|")[column].strip() == f"{stated(path)} min"


@pytest.mark.parametrize("path", EXERCISES, ids=lambda path: path.stem)
def test_an_exercise_and_its_metadata_state_the_same_minutes(path: Path) -> None:
    assert read_notebook(path)["metadata"]["course"]["minutes"] == stated(path)
