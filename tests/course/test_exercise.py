from pathlib import Path
from typing import Any

import pytest

import course_lib.course.exercise as exercise_module
from course_lib.course.exercise import exercise_from, exercise_path, notebook_text, read_notebook, stub
from course_lib.course.material import solutions_dir
from course_lib.errors import CourseError
from tests.export.conftest import write_notebook

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


def test_answer_is_replaced_by_a_description_of_the_missing_part() -> None:
    assert stub(SOLVED) == (
        'def area(r):\n    raise NotImplementedError("area is empty: return the area of a disc.")'
    )


@pytest.mark.parametrize(
    "code",
    [SOLVED.replace("# end of solution", ""), SOLVED + "# end of solution", "# solution: a\n" + SOLVED],
)
def test_unterminated_solution_block_is_rejected_and_not_released(code: str) -> None:
    with pytest.raises(CourseError, match="end of solution"):
        stub(code)


def test_instructor_cells_and_outputs_are_removed() -> None:
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
def test_exercises_equal_notebooks_generated_from_the_solutions(solution: Any) -> None:
    made = notebook_text(exercise_from(read_notebook(solution)))
    there = exercise_path(solution).read_text(encoding="utf-8")
    assert there == made, "run: python -m course_lib.course.exercise"


def test_every_solution_has_an_exercise() -> None:
    solutions = list(solutions_dir().glob("week*_solution.ipynb"))
    assert solutions
    assert all(exercise_path(solution).is_file() for solution in solutions)


@pytest.mark.parametrize(
    ("cell", "message"),
    [
        (
            "# solution: a is empty\na = 1",
            "write '# end of solution' after the line '# solution: a is empty'",
        ),
        ("a = 1\n# end of solution", "'# end of solution' is in the wrong place"),
        ("# solution: a\n# solution: b\n# end of solution", "'# solution: b' is in the wrong place"),
    ],
)
def test_invalid_solution_marker_is_reported_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cell: str, message: str
) -> None:
    write_notebook(tmp_path / "week09_solution.ipynb", [cell])
    monkeypatch.setattr(exercise_module, "solutions_dir", lambda: tmp_path)
    with pytest.raises(SystemExit) as leaving:
        exercise_module.main()
    line = str(leaving.value.code)
    assert line.startswith(f"error: {tmp_path / 'week09_solution.ipynb'}: ")
    assert f"in the cell that begins with {cell.partition(chr(10))[0]!r}, " in line
    assert message in line
    assert "\n" not in line


def test_missing_notebook_is_reported_with_the_notebooks_of_its_folder(tmp_path: Path) -> None:
    (tmp_path / "week07_mine.ipynb").touch()
    with pytest.raises(
        CourseError, match=r"no notebook .*week07\.ipynb\. Its folder has week07_mine\.ipynb\."
    ):
        read_notebook(tmp_path / "week07.ipynb")
