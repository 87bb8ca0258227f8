"""JupyterLab's file browser on a student's folder, as `course lab` sets it up."""

import os
from pathlib import Path

import pytest
from playwright.sync_api import expect

from tests.browser.jupyterlab import Lab, Notebook, opened

pytestmark = [pytest.mark.browser, pytest.mark.slow]
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder
# The names that are listed, and of each whether it is cut off.
_LISTED = """() => [...document.querySelectorAll(".jp-DirListing-itemText")].map(
    (name) => [name.textContent, name.scrollWidth > name.clientWidth])"""

_GO_TO = "path => jupyterapp.commands.execute('filebrowser:go-to-path', { path })"


def test_lessons_and_exercises_are_listed_first_with_untruncated_file_names(lab: Lab) -> None:
    with opened(lab, "week00_welcome.ipynb") as notebook:
        folder = notebook.folder
        notebook.page.evaluate(_GO_TO, folder.name)
        (folder / "a_recording").mkdir()
        (folder / "a_layout.rviz").write_text("")
        notebook.page.get_by_role("button", name="Refresh the file browser.").click()
        notebook.page.wait_for_selector(".jp-DirListing-itemText:has-text('a_layout')")
        listed = dict(notebook.page.evaluate(_LISTED))
        if PICTURES:
            notebook.page.screenshot(path=Path(PICTURES) / "file_browser.png")
    lessons = [name for name in listed if name.startswith("week") and name.endswith(".ipynb")]
    assert len(lessons) > 15
    assert [*listed].index("a_layout.rviz") > max([*listed].index(name) for name in lessons)
    assert [name for name in lessons if listed[name]] == []


def test_file_browser_of_a_narrow_window_is_folded_once_when_a_notebook_opens(lab: Lab) -> None:
    page = lab.new_page(viewport={"width": 683, "height": 384})  # [px], as a zoom of 200 % makes it
    folder = lab.student_folder("narrow")
    notebook = Notebook(page, lab.address, folder, "week00_welcome.ipynb")
    files = page.locator("#filebrowser")
    files.wait_for(state="hidden")
    if PICTURES:
        page.screenshot(path=Path(PICTURES) / "file_browser_narrow.png")
    page.evaluate("jupyterapp.shell.expandLeft()")
    files.wait_for()
    notebook.leave_for("week01_exercise.ipynb")
    expect(files).to_be_visible()
    notebook.end()
    page.close()
