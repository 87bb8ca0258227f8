"""Reports and their index as a browser shows them, from the file system and offline."""

from collections.abc import Iterator
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from course_lib.grading.grade import grade
from course_lib.grading.marks import read_result
from course_lib.grading.reports.report import standalone
from course_lib.grading.store import Course, catalog_of
from course_lib.viewer.html import static_page
from course_lib.viewer.renderer import find_browser
from course_lib.viewer.scene import Scene
from tests.browser.axe import faults
from tests.browser.fake_host import chromium
from tests.browser.test_page import pixels_of
from tests.browser.test_playback import READING, WATCH
from tests.browser.waiting import at_rest
from tests.grading.conftest import RIGHT, write_course, written

pytestmark = pytest.mark.browser

SCRIPT = "<script>document.title = 'run'</script><img src=x onerror=\\\"document.title = 'run'\\\">"
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
    """Return the course and the output of `grade`, which no test modifies.

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


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_reports_and_index_are_accessible(
    page: Page, reports: Path, scheme: Literal["light", "dark"]
) -> None:
    page.emulate_media(color_scheme=scheme)
    for name in ("ada/week01_exercise.html", "bob/week01_exercise.html", "index.html", "items.html"):
        page.goto((reports / name).as_uri())
        assert faults(page) == []


@pytest.mark.slow
def test_report_plays_offline_from_a_file(page: Page, reports: Path) -> None:
    page.goto((reports / "ada/week01_exercise.html").as_uri())
    page.wait_for_selector(READING)
    assert page.locator("figure canvas").count() == 2
    page.locator("figure canvas").first.scroll_into_view_if_needed()
    time = page.get_by_role("slider", name="Time")
    at_end = at_rest(lambda: yours(page), page)
    time.press("Home")
    at_start = yours(page)
    assert np.count_nonzero((at_start != at_end).any(axis=-1)) > 500
    page.get_by_role("combobox", name="Speed").select_option("4")
    page.evaluate(WATCH)
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("seen.length > 2 && seen.at(-1) > seen[0]")
    page.get_by_role("button", name="Play").wait_for()
    assert np.array_equal(at_rest(lambda: yours(page), page), at_end)


def test_student_text_is_escaped_in_the_report(page: Page, reports: Path) -> None:
    page.goto((reports / "bob/week01_exercise.html").as_uri())
    page.wait_for_selector("figure canvas")
    page.evaluate(FRAMES)
    assert page.title() == "week01_exercise: bob"
    shown = page.locator("main").inner_text()
    assert shown.count("<script>document.title = 'run'</script>") >= 3  # a reason, an error, the output
    assert page.locator("main img").count() == 0


PAGES = (
    "ada/week01_exercise.html", "index.html", "items.html", "copies_week01_exercise.html", "alone.html",
    "render.html",
)  # fmt: skip
INJECTED = (
    "<script>document.title = 'run'</script><img src=x onerror=\"document.title = 'run'\">"
    "<iframe srcdoc=\"<script>parent.document.title = 'run'</script>\"></iframe>"
    "<a id=trap href=\"javascript:void(document.title = 'run')\">trap</a>"
)


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", PAGES)
def test_content_security_policy_blocks_scripts_in_unescaped_text(
    page: Page, graded: tuple[Course, Path], tmp_path: Path, name: str
) -> None:
    course, out = graded
    result = read_result(out / "results/ada/week01_exercise.json").result
    if name == "alone.html":
        text = standalone(result, out, catalog_of(course)).decode()
    elif name == "render.html":
        text = static_page(Scene())
    else:
        text = (out / "reports" / name).read_text()
    before, script, after = text.rpartition("<script>")
    spoilt = f"{before}{INJECTED}{script}{after}" if script else text.replace("</main>", f"{INJECTED}</main>")
    path = tmp_path / "reports" / "ada" / "page.html"
    path.parent.mkdir(parents=True)
    path.write_text(spoilt)
    for viewer in (out / "reports").glob("viewer-*.js"):
        (tmp_path / "reports" / viewer.name).write_bytes(viewer.read_bytes())
    page.goto(path.as_uri())
    title = page.title()
    page.get_by_text("trap").evaluate("(link) => link.click()")
    page.evaluate(FRAMES)
    assert page.title() == title != "run"
    if 'class="course-scene"' in text:
        page.wait_for_selector("canvas")


@pytest.mark.slow
def test_report_without_the_viewer_shows_the_missing_file(page: Page, reports: Path, tmp_path: Path) -> None:
    alone = tmp_path / "reports" / "ada" / "week01_exercise.html"
    alone.parent.mkdir(parents=True)
    alone.write_bytes((reports / "ada/week01_exercise.html").read_bytes())
    (script,) = reports.glob("viewer-*.js")
    page.goto(alone.as_uri())
    page.get_by_text(f"The scenes need the file {script.name}").wait_for()


@pytest.mark.slow
def test_index_is_sortable_by_keyboard_and_links_to_the_reports(page: Page, reports: Path) -> None:
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


@pytest.mark.slow
def test_standalone_report_plays_in_an_empty_folder(
    page: Page, graded: tuple[Course, Path], tmp_path: Path
) -> None:
    course, out = graded
    result = read_result(out / "results/ada/week01_exercise.json").result
    alone = tmp_path / "downloads" / "week01_exercise.html"
    alone.parent.mkdir()
    alone.write_bytes(standalone(result, out, catalog_of(course)))
    page.goto(alone.as_uri())
    page.wait_for_selector(READING)
    assert page.locator("figure canvas").count() == 2
    time = page.get_by_role("slider", name="Time")
    page.locator("figure canvas").first.scroll_into_view_if_needed()
    at_end = at_rest(lambda: yours(page), page)
    time.press("Home")
    assert np.count_nonzero((at_end != yours(page)).any(axis=-1)) > 500
