"""Rules for the notebooks of this course, in addition to those of `course verify`."""

import re
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from course_lib.authoring.rules import code_of, names_in_answers, page_flaws
from course_lib.authoring.verify import weeks_of
from course_lib.course.exercise import read_notebook, source
from course_lib.course.material import exercises_dir, lessons_dir, solutions_dir
from course_lib.course.questions import read_quiz
from course_lib.grading.store import this_course

COVERAGE = tomllib.loads(Path(__file__).with_name("coverage.toml").read_text(encoding="utf-8"))["part"]
PAGES = sorted([*lessons_dir().glob("*.ipynb"), *exercises_dir().glob("*.ipynb")])
# A window of 1280 px shows 84 columns beside a view, and two less with a scroll bar.
WIDEST, WEEKS_BESIDE_A_VIEW = 80, ("week01_first", "week03_detections", "week05_configurations")
BESIDE_A_VIEW = [path for path in PAGES if path.name.startswith(WEEKS_BESIDE_A_VIEW)]
SOLUTIONS = sorted(solutions_dir().glob("week*_solution.ipynb"))


@pytest.mark.parametrize("week", [*weeks_of(this_course()), "extras"])
def test_lessons_reviews_exercises_and_solutions_follow_the_rules(week: str) -> None:
    assert [str(flaw) for flaw in page_flaws(week, this_course())] == []


@pytest.mark.parametrize("path", [*PAGES, *SOLUTIONS], ids=lambda path: path.stem)
def test_sentence_is_not_repeated_within_a_cell(path: Path) -> None:
    for cell in read_notebook(path)["cells"]:
        if cell["cell_type"] == "markdown":
            sentences = [one.strip() for one in re.split(r"(?<=[.!?])\s+", source(cell)) if len(one) > 12]
            assert [one for one, count in Counter(sentences).items() if count > 1] == []


@pytest.mark.parametrize("path", BESIDE_A_VIEW, ids=lambda path: path.stem)
def test_code_fits_beside_a_view_on_a_laptop(path: Path) -> None:
    code = (source(cell) for cell in read_notebook(path)["cells"] if cell["cell_type"] == "code")
    assert [line for cell in code for line in cell.splitlines() if len(line) > WIDEST] == []


@pytest.mark.parametrize("part", COVERAGE, ids=lambda part: part["topic"])
def test_every_part_of_the_original_tutorials_is_covered_by_its_keywords(part: dict[str, Any]) -> None:
    assert sum(map(len, part["words"].values())) >= 2
    for name, words in part["words"].items():
        folder = exercises_dir() if name.endswith("exercise") else lessons_dir()
        cells = read_notebook(folder / f"{name}.ipynb")["cells"]
        text = "\n".join(source(cell) for cell in cells).casefold()
        assert [word for word in words if word.casefold() not in text] == []


def test_week_6_contains_the_ten_questions_of_its_tutorial() -> None:
    assert len(read_quiz("week06")) == 10


@pytest.mark.parametrize("path", SOLUTIONS, ids=lambda path: path.stem[:6])
def test_answers_use_names_of_ros_or_the_kit(path: Any) -> None:
    assert len(set(names_in_answers(code_of(path)))) > 3


def test_names_are_collected_from_answers_and_not_from_given_code() -> None:
    code = "from rclpy.node import Node\nclass A(Node):\n    def f(self):\n        self.get_name()\n"
    answer = (
        "        # solution: missing\n        self.create_timer(1.0, self.f)\n        # end of solution\n"
    )
    assert list(names_in_answers(code + answer)) == ["create_timer"]
