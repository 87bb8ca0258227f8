"""The marking page in Chromium, with two simultaneous graders."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Literal

import pytest
from playwright.sync_api import Browser, Page, expect

from course_lib.grading.marks import read_marks
from course_lib.grading.records import HandMark
from tests.browser.axe import faults
from tests.browser.conftest import PICTURES
from tests.browser.waiting import wait_until
from tests.grading.marking.bench import TASKS, Served, served, write_kinds, write_results
from tests.patience import PATIENCE

pytestmark = pytest.mark.browser
SCRIPT = "<script>document.title = 'run'</script><img src=x onerror=\"document.title = 'run'\">"
STUDENTS = tuple(f"s{number:03}" for number in range(13))
FOUR_ROWS = TASKS.replace(
    'Row("an example", 15)', 'Row("an example", 6), Row("a reason", 5), Row("a source", 4)'
)
ROWS = ("a reason", "a source", "an example", "names the parts")
POINTS = "(fields) => fields.map((field) => field.value)"
MOVED = """(before) => document.getElementById("title").textContent !== before
  || document.getElementById("said").textContent.startsWith("There is no other")"""


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "out"


@pytest.fixture
def graders(browser: Browser) -> Iterator[list[Page]]:
    """Two pages that share nothing."""
    pages = [browser.new_context(viewport={"width": 1400, "height": 900}).new_page() for _ in range(2)]
    errors: list[str] = []
    for page in pages:
        page.set_default_timeout(PATIENCE * 1000)
        page.on("pageerror", lambda error: errors.append(str(error)))
    yield pages
    for page in pages:
        if PICTURES:
            page.screenshot(path=Path(PICTURES) / f"marking_{pages.index(page)}.png")
        page.context.close()
    assert errors == []


def enter(page: Page, server: Served, name: str) -> None:
    """Open the page as somebody."""
    page.goto(server.address)
    page.get_by_label("Your name").fill(name)
    page.get_by_label("Your name").blur()
    page.locator("#work").wait_for()


def choose(page: Page, student: str, task: str = "Why TF?") -> None:
    """Open a task of a student, and leave the list."""
    wait_until_idle(page)
    page.get_by_label("State").select_option("any")
    page.locator("#list button").filter(has_text=student).filter(has_text=task).click()
    expect(page.locator("#title")).to_contain_text(f"{student}: {task}")
    press(page, "Escape")


def wait_until_idle(page: Page) -> None:
    """Wait until the page does nothing: the keys of a page that loads or saves are for no task."""
    page.locator("#form:not([inert])").wait_for(state="attached")


def press(page: Page, *keys: str) -> None:
    """Press one key after the other, each while the page does nothing."""
    for key in keys:
        wait_until_idle(page)
        page.keyboard.press(key)


def mark_all(page: Page) -> None:
    """Press the keys for full points of all rows without points, and open the next task."""
    wait_until_idle(page)
    before = page.locator("#title").text_content()
    points = page.locator("#fields input").evaluate_all(POINTS)
    press(page, *(str(number) for number, given in enumerate(points, 1) if not given), "s")
    page.wait_for_function(MOVED, arg=before)


def finished(pages: Sequence[Page]) -> bool:
    """Mark one task on each page. Return whether all pages show an empty queue."""
    for page in pages:
        mark_all(page)
    return all(page.get_by_text("of 26 tasks, 0 wait").is_visible() for page in pages)


def all_marks(out: Path) -> list[tuple[str, HandMark]]:
    """Return the marks on the disk, with their students."""
    return [(path.parent.name, mark) for path in out.glob("marks/*/*.json") for mark in read_marks(path)]


@pytest.mark.slow
def test_two_graders_lose_none_of_52_marks_when_the_server_is_killed(
    graders: list[Page], tmp_path: Path, out: Path
) -> None:
    course = write_kinds(tmp_path / "course", FOUR_ROWS)
    write_results(course, out, STUDENTS)
    ann, ben = graders
    with served(course, out) as first:
        enter(ann, first, "Ann")
        enter(ben, first, "Ben")
        for _ in range(3):
            mark_all(ann)
            mark_all(ben)
        acknowledged = all_marks(out)
        assert len(acknowledged) == 24
        press(ann, "1")
        first.kill()
        press(ann, "s")
        expect(ann.locator("#unsaved")).to_contain_text("Not saved: The server does not answer")
    with served(course, out, first.port) as second:
        enter(ann, second, "Ann")
        enter(ben, second, "Ben")
        assert all_marks(out) == acknowledged
        wait_until_idle(ann)
        ann.locator("#list button").filter(has_text="not saved yet").click()
        expect(ann.locator("#unsaved")).to_have_text("Not saved yet")
        expect(ann.get_by_label("1 names the parts")).to_have_value("5")
        press(ann, *"234s")
        wait_until(lambda: finished(graders))
    found = all_marks(out)
    assert sorted((who, mark.row) for who, mark in found) == [(who, row) for who in STUDENTS for row in ROWS]
    assert {mark.by for _, mark in found} == {"Ann", "Ben"}


@pytest.mark.slow
def test_conflicting_marks_of_two_graders_are_reported_and_kept(
    graders: list[Page], tmp_path: Path, out: Path
) -> None:
    course = write_kinds(tmp_path / "course")
    write_results(course, out, ("ada", "bob"))
    ann, ben = graders
    with served(course, out) as server:
        for page, name in ((ann, "Ann"), (ben, "Ben")):
            enter(page, server, name)
            choose(page, "ada")
        expect(ann.locator("#list button[aria-current]")).to_contain_text("Ben has it open")
        ben.get_by_label("2 an example").fill("7")
        press(ann, "1", "Shift+Digit2", "c")
        ann.keyboard.type("clear")
        press(ann, "Control+Enter")
        conflict = ben.get_by_role("alertdialog")
        expect(conflict).to_contain_text("Ann saved this task at")
        expect(conflict.get_by_role("row", name="an example, points")).to_have_text("an example, points7.57")
        conflict.get_by_role("button", name="Save mine over theirs").click()
        expect(ben.locator("#history summary")).to_contain_text("Marks: 3; now 24 of 40")
    marks = [(mark.by, mark.points, mark.comment) for _, mark in all_marks(out)]
    assert marks == [("Ann", 5, "clear"), ("Ann", 7.5, ""), ("Ben", 7, "")]


@pytest.mark.slow
def test_withdraw_button_withdraws_the_marks_of_the_task(
    graders: list[Page], tmp_path: Path, out: Path
) -> None:
    course = write_kinds(tmp_path / "course")
    write_results(course, out, ("ada", "bob"))
    page = graders[0]
    with served(course, out) as server:
        enter(page, server, "Ann")
        choose(page, "ada")
        withdraw = page.get_by_role("button", name="Withdraw marks")
        withdraw.click()
        expect(page.locator("#said")).to_have_text("This task has no saved mark")
        page.get_by_label("1 names the parts").fill("4")
        press(page, "Escape", "Control+Enter")
        choose(page, "ada")
        expect(page.locator("#history summary")).to_contain_text("Marks: 1;")
        withdraw.click()
        expect(page.locator("#history summary")).to_contain_text("Marks: 0; now 0 of 40")
        expect(page.get_by_label("1 names the parts")).to_have_value("")
    assert [(mark.points, mark.withdrawn) for _, mark in all_marks(out)] == [(4, False), (None, True)]


@pytest.mark.slow
def test_student_text_is_escaped_names_can_be_hidden_and_comments_are_suggested(
    graders: list[Page], tmp_path: Path, out: Path
) -> None:
    course, name = write_kinds(tmp_path / "course"), f"cleo {SCRIPT}".replace("/", "")
    write_results(course, out, (name, "dan"), f"essay = '''{SCRIPT}'''\n")
    page = graders[0]
    with served(course, out) as server:
        enter(page, server, SCRIPT)
        choose(page, name)
        expect(page.locator("#code")).to_contain_text(SCRIPT)
        page.get_by_label("Comment on the task").fill(SCRIPT)
        press(page, "Control+Enter")
        choose(page, "dan")
        page.get_by_label("Comments used before").select_option(SCRIPT)
        expect(page.get_by_label("Comment on the task")).to_have_value(SCRIPT)
        press(page, "Escape")
        choose(page, name)
        expect(page.locator("#history")).to_contain_text(SCRIPT)
        page.frame_locator("#scene").get_by_text("A person reads and marks this task.").wait_for()
        press(page, "a")
        expect(page.get_by_role("button", name="Hide names")).to_have_attribute("aria-pressed", "true")
        expect(page.locator("#title")).to_contain_text("Student ")
        assert "cleo" not in page.locator("main").inner_text()
        assert page.locator("main img, main script").count() == 0
        assert "run" not in page.title()


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_marking_page_is_accessible_by_keyboard_and_screen_reader(
    graders: list[Page], tmp_path: Path, out: Path, scheme: Literal["light", "dark"]
) -> None:
    course, page = write_kinds(tmp_path / "course"), graders[0]
    write_results(course, out, ("ada", "dan"), "essay = 'My robot'\n")
    page.emulate_media(color_scheme=scheme)
    with served(course, out) as server:
        enter(page, server, "Ann")
        choose(page, "dan")
        expect(page.locator("#code")).to_contain_text("My robot")
        assert faults(page) == []
