import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from course_lib.authoring.new import new_course
from course_lib.book.book import viewer_script
from course_lib.book.kernel import compact, script
from course_lib.viewer import encoding
from course_lib.viewer.drawables import Camera
from course_lib.viewer.scene import Scene
from tests.book.test_compact import ball
from tests.browser.book_pages import (
    HEIGHT,
    MOST,
    WIDTHS,
    dead_links,
    drawn,
    look_at,
    opened,
    pages_of,
    size_of,
)
from tests.browser.test_page import pixels_of
from tests.browser.waiting import at_rest, wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
LESSON = "week01_first_steps.ipynb"


def build(course: Path, out: Path) -> subprocess.CompletedProcess[str]:
    """Build the book of an installed course, as its author does."""
    environment = os.environ | {"PYTHONPATH": str(course)}
    command = [sys.executable, "-m", "course_lib", "book", str(out)]
    return subprocess.run(
        command, cwd=course, env=environment, capture_output=True, text=True, timeout=300, check=False
    )


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new course with one lesson, as pip installs it."""
    root = new_course("Tiny robots", tmp_path_factory.mktemp("course"))
    (root / "notebooks" / "week00_start.ipynb").unlink()
    installed = root / "tiny_robots-0.1.0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: tiny-robots\nVersion: 0.1.0\n")
    package = "course_tiny_robots"
    (installed / "entry_points.txt").write_text(f"[course_lib.course]\n{package} = {package}\n")
    return root


@pytest.fixture(scope="module")
def book(course: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("sphinx_book_theme", reason='pip install "course-lib[docs]"')
    out = tmp_path_factory.mktemp("made") / "book"
    done = build(course, out)
    assert (done.returncode, done.stderr) == (0, "")
    return out


@pytest.fixture
def lesson(book: Path) -> Path:
    return (book / "lessons" / LESSON).with_suffix(".html")


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    said: list[str] = []
    page = opened(browser, said)
    yield page
    page.close()
    assert said == []


@pytest.mark.parametrize("width", WIDTHS)
def test_book_scenes_are_drawn_and_fit_desktop_and_phone_screens(
    page: Page, lesson: Path, width: int
) -> None:
    looked = look_at(page, lesson, width)
    assert (looked.scenes, looked.recordings, looked.problems) == (1, 1, ())


def test_book_scene_plays_the_messages_of_the_lesson(page: Page, lesson: Path) -> None:
    page.goto(lesson.as_uri())
    scene = page.locator(".course-scene")
    scene.scroll_into_view_if_needed()
    end = at_rest(lambda: drawn(scene), page)
    scene.get_by_role("slider").press("Home")
    wait_until(lambda: drawn(scene) < end, page)  # the post was not there yet
    scene.get_by_role("button", name="Play").click()
    wait_until(lambda: drawn(scene) == end, page)


def test_book_scene_is_loaded_when_scrolled_into_view(page: Page, lesson: Path) -> None:
    loaded: list[str] = []
    page.on("request", lambda request: loaded.append(Path(request.url).name))
    page.goto(lesson.as_uri())
    assert "week01_first_steps-01.js" not in loaded
    page.locator(".course-scene").scroll_into_view_if_needed()
    wait_until(lambda: "week01_first_steps-01.js" in loaded, page)


def test_mesh_shared_by_scenes_is_drawn_unchanged(page: Page, tmp_path: Path) -> None:
    scene = Scene()
    scene.camera = Camera(eye=(0.0, -0.3, 0.0), target=(0, 0, 0))
    scene.set_object("ball", ball())
    small, shared = compact(encoding.snapshot(scene))
    for name, content in (shared | {"scene": small}).items():
        (tmp_path / f"{name}.js").write_bytes(script(content))
    (tmp_path / "viewer.js").write_text(viewer_script(), "utf-8")
    host = '<div class="course-scene" style="width:300px;height:300px" data-scene="scene.js"></div>'
    (tmp_path / "page.html").write_text(f'<meta charset="utf-8">{host}<script src="viewer.js"></script>')
    page.goto((tmp_path / "page.html").as_uri())
    page.locator("canvas").wait_for()
    wait_until(lambda: drawn(page.locator(".course-scene")) > 0.3, page)
    upper, lower = np.split(pixels_of(page.locator("canvas").screenshot()), 2)
    for half, color in ((upper, 0), (lower, 2)):  # red, blue
        assert np.bincount(half[half.max(axis=-1) > 60].argmax(axis=-1), minlength=3).argmax() == color


def test_book_pages_are_small_and_their_links_resolve(book: Path) -> None:
    assert list(dead_links(book)) == []
    assert max(size_of(path) for path in pages_of(book)) < MOST


def test_time_bar_follows_the_page_theme(page: Page, lesson: Path) -> None:
    page.goto(lesson.as_uri())
    page.locator(".course-scene").scroll_into_view_if_needed()
    bar = page.locator(".course-time")
    bar.wait_for()
    play = bar.get_by_role("button").first
    colors, signs = set(), set()
    for theme in ("light", "dark"):
        page.evaluate("(theme) => (document.documentElement.dataset.theme = theme)", theme)
        colors.add(bar.evaluate("(bar) => getComputedStyle(bar).backgroundColor"))
        signs.add(play.evaluate("(button) => getComputedStyle(button).color"))
    assert (len(colors), len(signs)) == (2, 2)


def test_search_finds_a_lesson_on_a_file_url(page: Page, book: Path) -> None:
    page.goto(f"{(book / 'search.html').as_uri()}?q=publishes")
    page.get_by_role("link", name="Week 1: First steps").first.wait_for()


def test_search_result_page_scrolls_to_the_found_word(page: Page, book: Path) -> None:
    page.goto(f"{(book / 'search.html').as_uri()}?q=publishes")
    page.get_by_role("link", name="Week 1: First steps").first.click()
    word = page.locator("article .highlighted").first
    word.wait_for()
    wait_until(lambda: 0 < word.evaluate("(word) => word.getBoundingClientRect().top") < HEIGHT, page)


def test_book_contains_no_answers_or_solutions(course: Path, book: Path) -> None:
    text = "\n".join(path.read_text("utf-8") for path in book.rglob("*.html"))
    assert "First steps" in text
    assert not [part for part in ("You predicted", "What happened", "Measured: ") if part in text]
    quiz = (course / "exercises" / "quizzes" / "week01.toml").read_text("utf-8")
    reasons = [line.partition('"')[2][:20] for line in quiz.splitlines() if line.startswith("reason")]
    assert reasons
    assert not [reason for reason in reasons if reason in text]
    assert not list(book.rglob("*solution*"))
