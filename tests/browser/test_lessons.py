"""Lessons from week 2 on in real JupyterLab: every cell and view, a resumption, a quiz by clicks."""

import os
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from playwright.sync_api import Locator

from course_lib.course.material import exercises_dir, lessons
from tests.browser.jupyterlab import COUNT, Lab, Notebook, opened
from tests.browser.waiting import A_FRAME, wait_until
from tests.tools.test_resume import code_cells, places_of, unexpected_failures

pytestmark = [pytest.mark.browser, pytest.mark.slow]
LESSONS = [path for path in lessons() if path.name >= "week02"]
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder: pictures for the README go there
DRAWN = 150  # [px] that are clearly coloured, in the best view
COLOURED = "Math.max(r, g, b) - Math.min(r, g, b) > 60"
LIT = "Math.max(r, g, b) > 108"  # brighter than the background
# Cells of code that are wider than their place, and so have hidden columns.
HIDDEN_CODE = """() => courseNotebook().content.widgets.filter(({ model, node }) => {
    const scroller = node.querySelector(".jp-InputArea-editor .cm-scroller");
    return model.type == "code" && scroller && scroller.scrollWidth > scroller.clientWidth;
}).map(({ model }) => model.id)"""
# Pictures of a view, which span more robot time than the slowest node is silent.
LOOKS = 5
# The view of a cell, in it or beside the notebook, is found anew for each picture: a view may be
# shown in its cell for a moment and then move beside the notebook. The page scrolls to it, as
# Playwright would first wait until it is visible and at rest.
SCROLL_TO_VIEW = """cell => {
    const seen = (root, selector) =>
        [...root.querySelectorAll(selector)].find((one) => one.offsetWidth && one.offsetHeight);
    const here = seen(cell, "canvas, .course-elsewhere");
    const view = here?.tagName == "DIV" ? seen(document, ".jupyterlab-sidecar canvas") : here;
    view?.scrollIntoView({ block: "nearest" });
    return view ?? document.createElement("canvas"); }"""


@dataclass(frozen=True)
class Lesson:
    """A lesson that was run completely, and what its views showed."""

    notebook: Notebook
    week: str
    views: "list[SeenView]"


@dataclass(frozen=True)
class SeenView:
    """A view while its nodes ran.

    Args:
        coloured: The number of its coloured pixels.
        is_beside: Whether a view was beside the notebook.
        hidden_code: The IDs of the cells that hid columns of their code.
    """

    coloured: int
    is_beside: bool
    hidden_code: list[str]


@pytest.fixture(scope="module")
def notebook(lab: Lab) -> Iterator[Notebook]:
    with opened(lab, LESSONS[0].name) as notebook:
        yield notebook


@pytest.fixture(scope="module", params=LESSONS, ids=lambda path: path.stem)
def lesson(request: pytest.FixtureRequest, notebook: Notebook) -> Lesson:
    if notebook.name != request.param.name:
        notebook.leave_for(request.param.name)
    return Lesson(notebook, request.param.stem[:6], list(views(notebook)))


def views(notebook: Notebook) -> Iterator[SeenView]:
    """Go through a lesson cell by cell, and look at each view while its nodes still run.

    A new kernel resumes it at its last place to stop.
    """
    codes = code_cells(notebook.folder / notebook.name)
    place = codes[places_of(codes)[-1]]["id"]
    cells = notebook.run_to_each("viewer", "viewer.beside()", restart_before=place)
    for number, cell in enumerate(cells):
        coloured = look(cell)
        is_beside = notebook.page.locator(".jupyterlab-sidecar canvas:visible").count() > 0
        yield SeenView(coloured, is_beside, notebook.ask(HIDDEN_CODE))
        if PICTURES:
            notebook.page.screenshot(path=Path(PICTURES) / f"{notebook.name[:6]}_{number:02d}.png")


def look(cell: Locator) -> int:
    """Watch a cell's view until it is coloured, or for a few pictures. Return the coloured pixels."""

    def count(condition: str) -> int:
        script = f"cell => ({COUNT})(({SCROLL_TO_VIEW})(cell))"
        return int(cell.evaluate(script.replace("CONDITION", condition)))

    wait_until(lambda: count(LIT), cell.page, A_FRAME)
    most = count(COLOURED)
    for _ in range(LOOKS):
        if most > DRAWN:
            break
        cell.page.wait_for_timeout(A_FRAME * 1000)
        most = max(most, count(COLOURED))
    return most


def test_views_of_each_lesson_are_drawn(lesson: Lesson) -> None:
    coloured = [view.coloured for view in lesson.views]
    assert max(coloured) > DRAWN, coloured


def test_cells_of_each_lesson_run_without_errors_one_by_one(lesson: Lesson) -> None:
    assert lesson.notebook.errors() == []  # nbmake runs all cells without pauses


def test_code_of_each_lesson_is_not_hidden_by_the_view_beside_it(lesson: Lesson) -> None:
    beside = [view for view in lesson.views if view.is_beside]
    assert beside
    assert {cell for view in beside for cell in view.hidden_code} == set()


def test_each_lesson_resumes_at_its_last_stopping_point_after_a_kernel_restart(lesson: Lesson) -> None:
    text = "\n".join("".join(output.get("text", "")) for output in lesson.notebook.outputs())
    (printed,) = re.findall(r"^Ran \d+ cells above\. Continue below\.\n(?:.+\n)*", text, re.MULTILINE)
    assert unexpected_failures(printed, code_cells(lesson.notebook.folder / lesson.notebook.name)) == []


def test_lesson_quiz_shows_an_explanation_after_a_click(lesson: Lesson) -> None:
    quiz = exercises_dir() / "quizzes" / f"{lesson.week}.toml"
    questions = tomllib.loads(quiz.read_text())["question"]
    right = next(answer for answer in questions[0]["answer"] if answer.get("right"))
    cell = lesson.notebook.cell(f'quiz("{lesson.week}")')
    cell.get_by_text(right["text"], exact=True).click()
    cell.get_by_text(f"✔ Right. {right['reason']}").wait_for()
