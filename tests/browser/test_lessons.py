"""Lessons from week 2 on in real JupyterLab: every cell, every view, a prediction and a quiz by clicks."""

import os
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Browser, expect

from course_lib.course.files import exercises_dir, lessons_dir
from tests.browser.jupyterlab import Notebook, course_lab, pixels_of

pytestmark = [pytest.mark.browser, pytest.mark.slow]
LESSONS = [path for path in sorted(lessons_dir().glob("week*.ipynb")) if path.name >= "week02"]
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder: pictures for the README go there
DRAWN = 150  # [px] that are clearly coloured, in the best view
A_LOOK = 1_500  # [ms], longer than the slowest node is silent


@dataclass(frozen=True)
class Lesson:
    """A lesson that a student went through, and what its views showed: source of the cell and pixels."""

    notebook: Notebook
    views: list[tuple[str, NDArray[np.int64]]]


@pytest.fixture(scope="module", params=LESSONS, ids=lambda path: path.stem)
def lesson(
    request: pytest.FixtureRequest, browser: Browser, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Lesson]:
    folder = tmp_path_factory.mktemp("student")
    with course_lab(folder / "my_course", folder / "home") as address:
        page = browser.new_page(viewport={"width": 1280, "height": 860})
        notebook = Notebook(page, address, request.param.name)
        yield Lesson(notebook, list(views(notebook)))
        page.close()


def views(notebook: Notebook) -> Iterator[tuple[str, NDArray[np.int64]]]:
    """Go through a lesson cell by cell, and look at each view while its nodes still run."""
    for number, (code, cell) in enumerate(notebook.run_one_by_one()):
        if code.splitlines()[-1] == "viewer":
            view = cell.locator("canvas").first
            expect(view).to_be_visible()
            view.scroll_into_view_if_needed()
            notebook.page.wait_for_timeout(A_LOOK)
            if PICTURES:
                notebook.page.screenshot(path=Path(PICTURES) / f"{notebook.week}_{number:02d}.png")
            yield code, pixels_of(view)


def test_its_views_are_drawn(lesson: Lesson) -> None:
    for code, pixels in lesson.views:
        assert np.ptp(pixels) > 60, f"an empty view below:\n{code}"
    coloured = [int((np.ptp(pixels, axis=2) > 60).sum()) for _, pixels in lesson.views]
    assert max(coloured) > DRAWN, coloured


def test_no_cell_has_an_error_one_by_one(lesson: Lesson) -> None:
    assert lesson.notebook.errors() == []  # all at once is nbmake's


def test_its_quiz_answers_a_click_with_a_reason(lesson: Lesson) -> None:
    quiz = exercises_dir() / "quizzes" / f"{lesson.notebook.week}.toml"
    questions = tomllib.loads(quiz.read_text())["question"]
    right = next(answer for answer in questions[0]["answer"] if answer.get("right"))
    cell = lesson.notebook.cell("quiz(")
    cell.get_by_text(right["text"], exact=True).click()
    expect(cell.get_by_text(f"✔ Right. {right['reason']}")).to_be_visible()
