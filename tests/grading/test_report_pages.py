"""Reports and their index as a browser shows them, from the file system and offline."""

from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from course_lib.grading.grade import grade
from course_lib.grading.marks.mark import Result, read_result
from course_lib.grading.records import Course, catalog_of
from course_lib.grading.reports.report import standalone
from course_lib.viewer.picture import find_browser
from tests.browser.axe import faults
from tests.browser.fake_host import chromium
from tests.browser.test_page import pixels_of
from tests.grading.conftest import RIGHT, write_course, written

pytestmark = pytest.mark.browser

SCRIPT = "<script>document.title = 'run'</script><img src=x onerror=\\\"document.title = 'run'\\\">"
READING = ".course-time output"
FRAMES = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    if find_browser() is None:
        pytest.skip("no Chromium or Chrome on this machine")
    with chromium() as running:
        yield running


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    context = browser.new_context(offline=True, viewport={"width": 1000, "height": 800})
    page = context.new_page()
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.set_default_timeout(8000)
    yield page
    context.close()
    assert errors == []


@pytest.fixture(scope="module")
def graded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Course, Path]:
    """Return the course, and what `grade` writes: no test changes either.

    Ada's cube rises, Bob's frame and output are HTML, the third file is no notebook.
    """
    top, right = tmp_path_factory.mktemp("graded"), RIGHT
    course = write_course(top / "course")
    rising = right.replace("position.z = 0.5", "position.z = self.get_clock().now().nanoseconds / 1e9 % 10")
    hostile = right.replace('frame_id = "map"', f'frame_id = "{SCRIPT}"').replace(
        "Marker(type=Marker.CUBE)", f'Marker(type=Marker.TEXT_VIEW_FACING, text="{SCRIPT}", ns="{SCRIPT}")'
    )
    hostile += f'# next cell\nprint("{SCRIPT}")\nraise ValueError("{SCRIPT}")\n'
    written(top / "in/ada/week01_exercise.ipynb", rising)
    written(top / "in/bob/week01_exercise.ipynb", hostile)
    (top / "in/cleo <b>").mkdir()
    (top / "in/cleo <b>/week01_exercise.ipynb").write_text("<html>")
    grade(top / "in", top / "out", jobs=1, course=course)
    return course, top / "out"


@pytest.fixture
def reports(graded: tuple[Course, Path]) -> Path:
    return graded[1] / "reports"


def yours(page: Page) -> np.ndarray:
    page.evaluate(FRAMES)
    return pixels_of(page.locator("figure canvas").first.screenshot())


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_reports_and_their_index_serve_a_screen_reader(
    page: Page, reports: Path, scheme: Literal["light", "dark"]
) -> None:
    page.emulate_media(color_scheme=scheme)
    for name in ("ada/week01_exercise.html", "bob/week01_exercise.html", "index.html", "items.html"):
        page.goto((reports / name).as_uri())
        assert faults(page) == []


def test_a_report_plays_offline_from_a_file(page: Page, reports: Path) -> None:
    page.goto((reports / "ada/week01_exercise.html").as_uri())
    page.wait_for_selector(READING)
    assert page.locator("figure canvas").count() == 2
    page.locator("figure canvas").first.scroll_into_view_if_needed()
    time = page.get_by_role("slider", name="Time")
    at_end = yours(page)
    time.press("Home")
    at_start = yours(page)
    assert np.count_nonzero((at_start != at_end).any(axis=-1)) > 500
    page.get_by_role("combobox", name="Speed").select_option("4")
    page.get_by_role("button", name="Play").click()
    page.get_by_role("button", name="Pause").wait_for()
    page.get_by_role("button", name="Play").wait_for()
    assert np.array_equal(yours(page), at_end)


def test_what_students_write_shows_as_text_and_does_not_run(page: Page, reports: Path) -> None:
    page.goto((reports / "bob/week01_exercise.html").as_uri())
    page.wait_for_selector("figure canvas")
    page.evaluate(FRAMES)
    assert page.title() == "week01_exercise: bob"
    shown = page.locator("main").inner_text()
    assert shown.count("<script>document.title = 'run'</script>") >= 3  # a reason, an error, the output
    assert page.locator("main img").count() == 0


def test_without_the_viewer_a_report_says_which_file_it_lacks(
    page: Page, reports: Path, tmp_path: Path
) -> None:
    alone = tmp_path / "reports" / "ada" / "week01_exercise.html"
    alone.parent.mkdir(parents=True)
    alone.write_bytes((reports / "ada/week01_exercise.html").read_bytes())
    (script,) = reports.glob("viewer-*.js")
    page.goto(alone.as_uri())
    page.get_by_text(f"The scenes need the file {script.name}").wait_for()


def test_the_index_sorts_by_keyboard_and_leads_to_the_reports(page: Page, reports: Path) -> None:
    page.goto((reports / "index.html").as_uri())
    table = page.get_by_role("table", name="Submissions")
    assert "3 submissions: 2 graded, 1 rejected" in page.locator("main").inner_text()
    heading = table.get_by_role("button", name="mark", exact=True)

    def students() -> list[str]:
        return table.locator("tbody th").all_inner_texts()

    heading.press("Enter")
    assert (
        table.get_by_role("columnheader", name="mark", exact=True).get_attribute("aria-sort") == "ascending"
    )
    assert students()[0].startswith("cleo")  # who has no mark at all
    heading.press("Enter")
    assert students()[2].startswith("cleo")
    assert page.locator("main b").count() == 0
    failures = page.get_by_role("table", name="How often each check failed").inner_text()
    assert "position" in failures
    page.get_by_role("link", name="report of ada, week01_exercise").click()
    assert page.title() == "week01_exercise: ada"


def test_a_returned_report_plays_alone_in_an_empty_folder(
    page: Page, graded: tuple[Course, Path], tmp_path: Path
) -> None:
    course, out = graded
    result = Result.from_plain(read_result(out / "results/ada/week01_exercise.json"))
    alone = tmp_path / "downloads" / "week01_exercise.html"
    alone.parent.mkdir()
    alone.write_bytes(standalone(result, out, catalog_of(course)))
    page.goto(alone.as_uri())
    page.wait_for_selector(READING)
    assert page.locator("figure canvas").count() == 2
    time = page.get_by_role("slider", name="Time")
    page.locator("figure canvas").first.scroll_into_view_if_needed()
    at_end = yours(page)
    time.press("Home")
    assert np.count_nonzero((at_end != yours(page)).any(axis=-1)) > 500
