"""Week 0 in a browser: the ID, a prediction and the quiz, and the files that they write."""

import json
from collections.abc import Iterator

import pytest

from course_lib.course.exercise import read_notebook
from course_lib.course.state import State
from tests.browser.jupyterlab import VIEWPORT, Lab, Notebook, count_pixels, opened, view_of
from tests.browser.waiting import A_FRAME, wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
ENOUGH = 300  # [px] of the path or the dog
LIGHT_GREY = "Math.min(r, g, b) > 150 && Math.max(r, g, b) - Math.min(r, g, b) < 40"
YELLOW = "r > 180 && g > 180 && b < 80"


@pytest.fixture(scope="module")
def lesson(lab: Lab) -> Iterator[Notebook]:
    with opened(lab, "week00_welcome.ipynb") as notebook:
        notebook.run_all()
        yield notebook


def test_all_cells_run_without_an_error_and_the_path_is_drawn(lesson: Notebook) -> None:
    view = view_of(lesson.cell('compare("week00.shape"'))
    wait_until(lambda: count_pixels(view, YELLOW) > ENOUGH, lesson.page, A_FRAME)
    assert lesson.errors() == []


def test_stopped_dog_stays_in_its_view(lesson: Notebook) -> None:
    cell = lesson.cell("run_live(RobotStatePublisher")
    cell.get_by_text("■ stopped: robot_state_publisher, dog").wait_for()
    view = view_of(cell)
    wait_until(lambda: count_pixels(view, LIGHT_GREY) > ENOUGH, lesson.page, A_FRAME)


def test_one_click_stores_the_id_and_writes_it_into_the_exercises(lesson: Notebook) -> None:
    cell = lesson.cell("ask_identity()")
    cell.get_by_role("textbox").last.fill(" 2023 77 ")
    cell.get_by_role("button", name="Keep").click()
    answer = cell.get_by_text("Your ID is 202377")
    answer.wait_for()
    assert answer.evaluate("answer => answer.scrollWidth <= answer.parentElement.clientWidth")
    assert json.loads((lesson.folder / ".course" / "identity.json").read_text()) == {"student": "202377"}
    assert read_notebook(lesson.folder / "week01_exercise.ipynb")["metadata"]["course"]["student"] == "202377"


def test_prediction_is_stored_and_shown_next_to_the_result(lesson: Notebook) -> None:
    cell = lesson.cell('predict("week00.shape")')
    cell.get_by_text("a circle", exact=True).click()
    cell.get_by_text("Kept.").wait_for()
    assert State(lesson.folder).section("predictions") == {"week00.shape": "a circle"}
    result = lesson.run_to('compare("week00.shape"')
    result.get_by_text("You predicted: a circle.").wait_for()


def test_quiz_shows_an_explanation_after_each_click(lesson: Notebook) -> None:
    cell = lesson.cell("quiz(")
    cell.get_by_text("2D Goal Pose", exact=True).click()
    cell.get_by_text("✘ Not this one. That sends it somewhere").wait_for()
    cell.get_by_text("2D Pose Estimate", exact=True).click()
    cell.get_by_text("✔ Right. It publishes a pose estimate").wait_for()


def test_long_options_of_a_quiz_are_wrapped_in_a_narrow_window(lesson: Notebook) -> None:
    cell = lesson.run_below('quiz("week06")')
    lesson.page.set_viewport_size({"width": 640, "height": 700})
    option = cell.locator("label", has_text="log of the detector")
    wait_until(lambda: option.evaluate("label => label.clientHeight > 30"), lesson.page)
    assert option.evaluate("label => label.scrollWidth <= label.clientWidth")
    lesson.page.set_viewport_size(VIEWPORT)
