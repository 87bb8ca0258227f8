"""Lessons from week 2 on in real JupyterLab: every cell, every view, a prediction and a quiz by clicks."""

import os
import tomllib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, expect

from course_lib.course.exercise_file import read_notebook, source
from course_lib.course.files import exercises_dir, lessons_dir
from tests.browser.jupyterlab import Notebook, course_lab, pixels_of

pytestmark = [pytest.mark.browser, pytest.mark.slow]
LESSONS = [path for path in sorted(lessons_dir().glob("week*.ipynb")) if path.name >= "week02"]
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder: pictures for the README go there
DRAWN = 150  # [px] that are clearly coloured, in the best view


@pytest.fixture(scope="module", params=LESSONS, ids=lambda path: path.stem)
def lesson(
    request: pytest.FixtureRequest, browser: Browser, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Notebook]:
    folder = tmp_path_factory.mktemp("student")
    with course_lab(folder / "my_course", folder / "home") as address:
        page = browser.new_page(viewport={"width": 1280, "height": 860})
        notebook = Notebook(page, address, request.param.name)
        notebook.run_all()
        yield notebook
        page.close()


def views(lesson: Notebook) -> Iterator[str]:
    """The sources of the cells that show a view."""
    (path,) = lessons_dir().glob(f"{lesson.week}*.ipynb")
    for cell in read_notebook(path)["cells"]:
        if cell["cell_type"] == "code" and source(cell).splitlines()[-1:] == ["viewer"]:
            yield source(cell)


def test_all_cells_run_without_an_error(lesson: Notebook) -> None:
    assert lesson.errors() == []


def test_its_views_are_drawn(lesson: Notebook) -> None:
    best = 0
    for code in views(lesson):
        view = lesson.cell(code).locator("canvas").first
        expect(view).to_be_visible()
        lesson.page.wait_for_timeout(700)
        pixels = pixels_of(view)
        assert np.ptp(pixels) > 60, f"an empty view below:\n{code}"
        coloured = int((np.ptp(pixels, axis=2) > 60).sum())
        if coloured > best and PICTURES:
            lesson.page.screenshot(path=Path(PICTURES) / f"{lesson.week}_jupyterlab.png")
        best = max(best, coloured)
    assert best > DRAWN


def test_its_quiz_answers_a_click_with_a_reason(lesson: Notebook) -> None:
    questions = tomllib.loads((exercises_dir() / "quizzes" / f"{lesson.week}.toml").read_text())["question"]
    right = next(answer for answer in questions[0]["answer"] if answer.get("right"))
    cell = lesson.cell("quiz(")
    cell.get_by_text(right["text"], exact=True).click()
    expect(cell.get_by_text(f"✔ Right. {right['reason']}")).to_be_visible()
