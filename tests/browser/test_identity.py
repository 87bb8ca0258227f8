"""A student's ID that is set while exercises are open in JupyterLab: no question about changed files."""

import json
from collections.abc import Iterator

import pytest

from course_lib.course.exercise import notebook_text, read_notebook, source
from tests.browser.jupyterlab import Lab, Notebook, opened

pytestmark = pytest.mark.browser
FORM = "from course_lib import ask_identity, set_identity\nask_identity()"
# The exercise opens in a tab behind the form. Its kernel changes the notebook when it reports its language.
OPEN = """async path => {
    const options = { activate: false };
    const opened = await jupyterapp.commands.execute('docmanager:open', { path, options });
    await opened.context.ready;
    await opened.context.sessionContext.ready;
    await opened.context.sessionContext.session.kernel.info;
    globalThis.exercise = opened; }"""
TYPE = """text => exercise.content.model.sharedModel.cells.find((cell) => cell.cell_type === 'code')
    .setSource(text)"""
# A dialog waits for the student, so the save would never end.
SAVE = """async () => {
    const asks = new Promise((done) => {
        const look = () => document.querySelector(".jp-Dialog") && done("asked");
        new MutationObserver(look).observe(document.body, { childList: true, subtree: true }); });
    return Promise.race([asks, exercise.context.save().then(() => "saved")]); }"""


@pytest.fixture(scope="module")
def form(lab: Lab) -> Iterator[Notebook]:
    """A notebook with the form, and an exercise open behind it, in which the student has typed."""
    with opened(lab, "form.ipynb", [FORM]) as notebook:
        notebook.run_all()
        notebook.ask(OPEN, f"{notebook.folder.name}/week01_exercise.ipynb")
        yield notebook


def stored(notebook: Notebook) -> tuple[str | None, list[str]]:
    """Return the ID and the code in the exercise's file."""
    content = read_notebook(notebook.folder / "week01_exercise.ipynb")
    cells = [source(cell) for cell in content["cells"] if cell["cell_type"] == "code"]
    return content["metadata"]["course"].get("student"), cells


def test_exercise_with_unsaved_changes_is_saved_with_them_and_the_id_without_a_question(
    form: Notebook,
) -> None:
    form.ask(TYPE, "typed = 'before'")
    cell = form.cell("ask_identity()")
    cell.get_by_role("textbox").last.fill("s77")
    cell.get_by_role("button", name="Keep").click()
    cell.get_by_text("Your ID is s77").wait_for()
    assert form.ask(SAVE) == "saved"
    student, cells = stored(form)
    assert (student, cells[0]) == ("s77", "typed = 'before'")


def test_another_id_from_a_cell_leaves_a_saved_exercise_unchanged_and_its_next_save_silent(
    form: Notebook,
) -> None:
    form.run_below("set_identity('s88')")
    has_it = "exercise.context.model.getMetadata('course').student === 's88'"
    form.page.wait_for_function(f"() => {has_it} && !exercise.context.model.dirty")
    assert form.page.locator(".jp-Dialog").count() == 0
    form.ask(TYPE, "typed = 'after'")
    assert form.ask(SAVE) == "saved"
    student, cells = stored(form)
    assert (student, cells[0]) == ("s88", "typed = 'after'")


def test_change_by_another_program_is_still_a_question_after_the_id_was_set(form: Notebook) -> None:
    path = form.folder / "week01_exercise.ipynb"
    content = read_notebook(path)
    content["cells"][0]["source"] = "changed elsewhere"
    path.write_text(notebook_text(content))
    form.run_below("set_identity('s99')")
    form.ask(TYPE, "typed = 'here'")
    assert form.ask(SAVE) == "asked"
    assert "changed elsewhere" in json.dumps(read_notebook(path))
    form.page.get_by_role("button", name="Cancel").click()
