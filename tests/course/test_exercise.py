from typing import Any

import pytest

from course_lib.course.exercise import exercise_from, exercise_path, notebook_text, read_notebook, stub
from course_lib.course.installation import solutions_dir
from course_lib.errors import CourseError

SOLVED = """def area(r):
    # solution: area is empty: return the area of a disc.
    from math import pi
    return pi * r * r
    # end of solution
"""


def cell(kind: str, source: str, *tags: str) -> dict[str, Any]:
    return {
        "cell_type": kind,
        "id": "a",
        "metadata": {"tags": list(tags)},
        "source": source,
        "outputs": [{"text": "seen"}],
        "execution_count": 3,
    }


def test_an_answer_becomes_the_sentence_that_says_what_is_missing() -> None:
    assert stub(SOLVED) == (
        'def area(r):\n    raise NotImplementedError("area is empty: return the area of a disc.")'
    )


@pytest.mark.parametrize(
    "code",
    [SOLVED.replace("# end of solution", ""), SOLVED + "# end of solution", "# solution: a\n" + SOLVED],
)
def test_an_answer_that_is_not_closed_is_refused_and_not_released(code: str) -> None:
    with pytest.raises(CourseError, match="end of solution"):
        stub(code)


def test_instructors_cells_and_outputs_are_left_out() -> None:
    solution: dict[str, Any] = {
        "cells": [cell("markdown", "secret", "solution"), cell("code", SOLVED)],
        "metadata": {},
    }
    exercise = exercise_from(solution)
    assert len(exercise["cells"]) == 1
    assert exercise["cells"][0]["outputs"] == []
    assert exercise["cells"][0]["execution_count"] is None
    assert "pi * r" not in notebook_text(exercise)
    assert solution["cells"][1]["outputs"] == [{"text": "seen"}], "the solution itself is not touched"


@pytest.mark.parametrize(
    "solution", sorted(solutions_dir().glob("week*_solution.ipynb")), ids=lambda p: p.stem
)
def test_every_exercise_is_what_its_solution_makes(solution: Any) -> None:
    made = notebook_text(exercise_from(read_notebook(solution)))
    there = exercise_path(solution).read_text(encoding="utf-8")
    assert there == made, "run: python -m course_lib.course.exercise"


def test_every_solution_has_an_exercise() -> None:
    solutions = list(solutions_dir().glob("week*_solution.ipynb"))
    assert solutions
    assert all(exercise_path(solution).is_file() for solution in solutions)
