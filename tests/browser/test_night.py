"""A notebook whose kernel has ended: closed in the evening, opened again the next day."""

import json
import os
from base64 import b64decode
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from playwright.sync_api import ConsoleMessage, Locator, expect

from course_lib.course.questions import read_prediction, read_quiz
from course_lib.third_party import read_json
from tests.browser.jupyterlab import KERNEL, Lab, Notebook, count_pixels, opened, red_pixels
from tests.browser.waiting import A_FRAME, wait_until
from tests.patience import PATIENCE

pytestmark = [pytest.mark.browser, pytest.mark.slow]
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder
RECALL = read_quiz("week01_recall")[0]
GUESS = read_prediction("week01.ground").answers[0]
LOGGED: list[str] = []  # by the page, as errors, after the notebook was reopened
ENOUGH = 500  # [px] of the cube
CELLS = (
    """\
%load_ext course_lib
import rclpy
from rclpy.node import Node
from visualization_msgs.msg import Marker
from course_lib import Viewer, check, predict, quiz, run_live, spin_for
rclpy.init()""",
    """\
publisher = Node("talker").create_publisher(Marker, "/cube", 10)
cube = Marker(type=Marker.CUBE)
cube.header.frame_id = "map"
cube.scale.x = cube.scale.y = cube.scale.z = 2.0
cube.color.b = cube.color.a = 1.0""",
    "viewer = Viewer()\nviewer.add('Marker', '/cube')\nviewer",
    'predict("week01.ground")',
    'quiz("week01_recall")',
    "class Nothing(Node):\n    pass\ncheck('week01.red_cube', Nothing)",
    "live = run_live(Node('idler'))",
    "cube.color.r, cube.color.b = 1.0, 0.0\npublisher.publish(cube)\nspin_for(0.5)",
    "%rqt graph",
    "from course_lib import load_robot\n"
    "from course_lib.robots import JointStatePublisher, joint_sliders\n"
    "joint_sliders(JointStatePublisher(load_robot('ur10').urdf))",
    "%rqt topic",
    "from ipywidgets import HTML, IntSlider, VBox\nVBox([HTML('<i>words of my own</i>'), IntSlider(7)])",
    "second = Viewer()\nsecond",
    "# again\nsecond",
    *["# JupyterLab draws no cell far out of sight." + "\n" * 30] * 70,
    "print('far below')\nquiz('week01_recall')\npredict('week01.ground')",
)
WITHOUT_A_PAUSE = ("second = Viewer", "# again")
GREEN_CUBE = "cube.color.r, cube.color.g = 0.0, 1.0\npublisher.publish(cube)\nspin_for(0.5)\nviewer"
COLOR_PIXELS = """(image, channel) => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
        const others = [0, 1, 2].filter((one) => one !== channel);
        count += data[i + channel] > 90 && others.every((one) => data[i + one] < 60); }
    return count; }"""
RED, GREEN = 0, 1  # channels

# The second save begins when the first one has written the file, and before the page knows that.
SAVE_TWICE = """async () => {
    const { contents } = jupyterapp.serviceManager, { context } = courseNotebook(), save = contents.save;
    const asks = new Promise((done) => {
        const look = () => document.querySelector(".jp-Dialog") && done("asked");
        new MutationObserver(look).observe(document.body, { childList: true, subtree: true }); });
    const askServer = () => contents.get(context.path, { content: false, hash: true });
    let second;
    contents.save = async (...all) => {
        const written = await save.apply(contents, all);
        contents.save = save;
        second = context.save();
        for (let trips = 0; trips < 3; trips++) await askServer();
        return written; };
    context.model.setMetadata("changed", "yes");
    return Promise.race([asks, context.save().then(() => second).then(() => "saved")]); }"""

# JupyterLab's own kernel object does not know of this request.
RESTART_FROM_ANOTHER_WINDOW = """async () => {
    const { baseUrl, token } = jupyterapp.serviceManager.serverSettings;
    const { id } = KERNEL, headers = { Authorization: `token ${token}` };
    await fetch(`${baseUrl}api/kernels/${id}/restart`, { method: "POST", headers }); }"""

# From now on. An old process that is killed does not report its end. The new one may send its first
# messages before JupyterLab's server is connected to it again.
LOSE_MESSAGES = """async isOld => {
    const kernel = KERNEL, { header } = await kernel.requestKernelInfo();
    const socket = kernel._ws, { onmessage } = socket;
    socket.onmessage = (event) => {
        const isFromOld = new TextDecoder().decode(event.data).includes(header.session);
        if (isFromOld !== isOld) onmessage(event); }; }"""


@pytest.fixture(scope="module")
def reopened(lab: Lab) -> Iterator[Notebook]:
    """A notebook that was run, answered, saved and closed, with its kernel ended, and opened again."""
    with opened(lab, "night.ipynb", CELLS) as notebook:
        notebook.run_all()
        view = notebook.cell("viewer.add").locator("canvas").first
        wait_until(lambda: red_pixels(view) > ENOUGH, notebook.page, A_FRAME)
        later_view = notebook.run_below(GREEN_CUBE).locator("canvas").first
        wait_until(lambda: green_pixels(later_view) > ENOUGH, notebook.page, A_FRAME)
        # On a busy machine these may be out of sight before they are drawn for the first time.
        for source in WITHOUT_A_PAUSE:
            has_grid = partial(has_grey_pixels, notebook.cell(source).locator("canvas").first)
            wait_until(has_grid, notebook.page, A_FRAME)
        notebook.cell("predict(").get_by_text(GUESS.text, exact=True).click()
        notebook.cell("quiz(").get_by_text(RECALL.right.text, exact=True).click()
        notebook.cell("quiz(").get_by_text("✔ Right.").wait_for()
        notebook.cell("viewer.add")
        number = notebook.cell("joint_sliders(").get_by_role("spinbutton", name="elbow_joint, as a number")
        number.fill("-1.25")
        number.press("Enter")
        notebook.page.evaluate("jupyterapp.commands.execute('docmanager:save')")
        notebook.wait_idle()
        picture(notebook, "night_before")
        notebook.end()
        notebook.page.on("console", log)
        notebook.open()
        notebook.page.wait_for_timeout(3000)  # [ms]; views ask for their models for 2 s
        yield notebook
        notebook.page.remove_listener("console", log)


def log(message: ConsoleMessage) -> None:
    if message.type == "error":
        LOGGED.append(message.text)


def has_grey_pixels(view: Locator) -> bool:
    return count_pixels(view, "Math.min(r, g, b) > 100") > ENOUGH / 5


def green_pixels(view: Locator) -> int:
    return count_pixels(view, "g > 90 && r < 60 && b < 60")


def picture(notebook: Notebook, name: str) -> None:
    if PICTURES:
        notebook.page.screenshot(path=Path(PICTURES) / f"{name}.png")


def saved(cell: Locator) -> Locator:
    line = cell.locator(".course-saved")
    line.first.wait_for()
    return line


def test_reopened_view_shows_its_last_image_and_a_continue_button(reopened: Notebook) -> None:
    cell = reopened.cell("viewer.add")
    saved(cell)
    picture(reopened, "night_view")
    image = cell.locator("img")
    # The cube was blue when the view's cell was run, and red before another cell showed the view.
    assert image.evaluate(COLOR_PIXELS, RED) > ENOUGH
    # No message had arrived when the view was displayed.
    assert "messages received at" in (image.get_attribute("alt") or "")
    cell.get_by_role("button", name="Continue here").wait_for()
    later = reopened.cell("color.g = 0.0, 1.0")
    saved(later)
    assert later.locator("img").evaluate(COLOR_PIXELS, GREEN) > ENOUGH


def test_cells_run_without_a_pause_have_pictures_of_the_page(reopened: Notebook) -> None:
    """The second cell starts before the page has drawn the view of the first one."""
    for source in WITHOUT_A_PAUSE:
        image = reopened.cell(source).locator("img")
        image.wait_for()
        assert "Displays: Grid" in (image.get_attribute("alt") or "")


def test_reopened_predictions_and_quizzes_show_the_student_answers(reopened: Notebook) -> None:
    cell = reopened.cell("predict(")
    saved(cell)
    cell.get_by_text(f"◉ {GUESS.text}").wait_for()
    cell = reopened.cell("quiz(")
    saved(cell)
    cell.get_by_text(f"◉ {RECALL.right.text}").wait_for()
    cell.get_by_text(f"✔ Right. {RECALL.right.reason}").wait_for()
    picture(reopened, "night_questions")


def test_reopened_checks_show_their_last_result_and_all_widgets_are_drawn(reopened: Notebook) -> None:
    cell = reopened.cell("check(")
    cell.get_by_text("0 of 7 checks passed").wait_for()
    cell.locator("img").wait_for()
    assert saved(cell).count() == 1
    cell = reopened.cell("run_live(")
    cell.get_by_text("idler ran here. Run this cell to start it again.").wait_for()
    picture(reopened, "night_checks")
    for phrase in ("Error displaying widget", "HBox("):
        expect(reopened.page.get_by_text(phrase)).to_have_count(0)


def test_reopened_rqt_view_and_sliders_show_their_last_state(reopened: Notebook) -> None:
    cell = reopened.cell("%rqt graph")
    saved(cell)
    cell.get_by_text("Node Graph").wait_for()
    # The sliders' node was started after the view was opened.
    graph = cell.locator(".rqt-screen img").get_attribute("src") or ""
    assert "/joint_state_publisher" in b64decode(graph.partition("base64,")[2]).decode()
    cell = reopened.cell("joint_sliders(")
    saved(cell)
    cell.get_by_text("-1.250", exact=True).wait_for()
    cell.get_by_text("elbow_joint").wait_for()
    picture(reopened, "night_controls")
    row = reopened.cell("%rqt topic").locator("tr", has_text="/cube")
    expect(row.locator("td").nth(0)).to_have_text("/cube")
    expect(row.locator("td").nth(1)).to_have_text("visualization_msgs/msg/Marker")
    cell = reopened.cell("words of my own")
    cell.locator("i").get_by_text("words of my own").wait_for()
    expect(cell.locator(".widget-readout")).to_have_text("7")
    picture(reopened, "night_own_widget")


def test_missing_widgets_of_a_reopened_notebook_are_not_logged_as_errors(reopened: Notebook) -> None:
    for source in ("viewer.add", "quiz(", "check(", "far below"):
        saved(reopened.cell(source))
    reopened.page.wait_for_timeout(3000)  # [ms]; the renderer waits 2 s for a model
    assert [text for text in LOGGED if "model not found" in text] == []


def test_continue_button_runs_the_required_cells_and_the_view_is_live_again(reopened: Notebook) -> None:
    cell = reopened.cell("viewer.add")
    saved(cell)
    cell.get_by_role("button", name="Continue here").click()
    cell.locator("canvas").first.wait_for()
    reopened.wait_idle()
    reopened.run_below("cube.color.r, cube.color.b = 1.0, 0.0\npublisher.publish(cube)\nspin_for(0.5)")
    view = reopened.cell("viewer.add").locator("canvas").first
    wait_until(lambda: red_pixels(view) > ENOUGH, reopened.page, A_FRAME)
    picture(reopened, "night_continued")
    assert reopened.errors() == []


def test_cells_that_were_out_of_sight_have_a_continue_button_after_reopening(reopened: Notebook) -> None:
    cell = reopened.cell("far below")
    saved(cell)
    cell.get_by_text(f"○ {GUESS.text}").wait_for()
    # One for both of its outputs.
    expect(cell.get_by_role("button", name="Continue here")).to_have_count(1)


def test_static_page_shows_image_and_answers(reopened: Notebook) -> None:
    from nbconvert import HTMLExporter

    path = reopened.folder / reopened.name
    assert path.stat().st_size < 1_000_000
    exporter = HTMLExporter(template_name="lab")
    html, _ = exporter.from_filename(str(path))
    browser = reopened.page.context.browser
    assert browser is not None
    page = browser.new_page()
    page.set_default_timeout(PATIENCE * 1000)
    page.set_content(html, wait_until="domcontentloaded")
    page.get_by_text(f"◉ {RECALL.right.text}").wait_for()
    page.locator(".jp-RenderedImage img").first.wait_for()
    page.get_by_text("-1.250", exact=True).wait_for()
    page.locator(".rqt img").first.wait_for()
    if PICTURES:
        page.screenshot(path=Path(PICTURES) / "night_static.png", full_page=True)
    page.close()


def test_save_during_another_save_waits_without_a_dialog(reopened: Notebook) -> None:
    assert reopened.ask(SAVE_TWICE) == "saved"


def test_open_page_reports_the_end_of_its_kernel_and_the_continue_button_starts_another(
    reopened: Notebook,
) -> None:
    cell = reopened.cell("predict(")
    cell.get_by_role("button", name="Continue here").click()
    cell.locator("input[type=radio]").first.wait_for()
    reopened.wait_idle()
    reopened.page.evaluate("jupyterapp.serviceManager.sessions.shutdownAll()")
    cell = reopened.cell("predict(")
    cell.get_by_text("The kernel has ended.").wait_for()
    picture(reopened, "night_ended")
    cell.get_by_role("button", name="Continue here").click()
    reopened.wait_idle()
    expect(cell.locator(".course-saved")).to_have_count(0)
    cell.locator("input[type=radio]").first.wait_for()
    assert reopened.errors() == []


def test_controls_of_a_restarted_kernel_become_text_without_broken_links(reopened: Notebook) -> None:
    reopened.run_all()
    sliders = reopened.cell("joint_sliders(")
    number = sliders.get_by_role("spinbutton", name="elbow_joint, as a number")
    number.fill("0.75")
    number.press("Enter")
    reopened.page.evaluate(f"{KERNEL}.restart()")
    saved(sliders).get_by_text("The kernel has ended.").wait_for()
    sliders.get_by_text("0.750", exact=True).wait_for()
    expect(sliders.locator("input")).to_have_count(0)
    live = reopened.cell("run_live(")
    live.get_by_text("idler ran here. Run this cell to start it again.").wait_for()
    view = reopened.cell("viewer.add")
    view.locator("canvas").first.wait_for()
    icons = """cell => [...cell.querySelectorAll(".jupyter-widgets-disconnected")]
        .map(widget => getComputedStyle(widget, "::before").content)"""
    assert set(view.evaluate(icons)) <= {"none"}
    picture(reopened, "night_restarted")


@pytest.mark.parametrize("lost", ["old", "new"])
def test_page_reports_that_another_window_has_restarted_its_kernel(reopened: Notebook, lost: str) -> None:
    reopened.run_to("quiz(")
    reopened.ask(LOSE_MESSAGES.replace("KERNEL", KERNEL), lost == "old")
    reopened.ask(RESTART_FROM_ANOTHER_WINDOW.replace("KERNEL", KERNEL))
    if lost == "old":
        reopened.kernel("pass")
    saved(reopened.cell("quiz(")).get_by_text("The kernel has ended.").wait_for()
    reopened.cell("viewer.add").get_by_text("The kernel of this view has ended.").wait_for()
    picture(reopened, "night_restarted_elsewhere")


def test_notebook_from_another_computer_shows_pictures_and_continue_buttons(reopened: Notebook) -> None:
    # JupyterLab saves every two minutes, perhaps last while cells ran, without their outputs.
    reopened.ask("() => courseNotebook().context.save()")
    content = read_json((reopened.folder / reopened.name).read_bytes())
    # JupyterLab trusts the contents that it has saved itself.
    content["metadata"]["author"] = "another computer"
    (reopened.folder / "received.ipynb").write_text(json.dumps(content))
    reopened.leave_for("received.ipynb")
    cell = reopened.cell("quiz(")
    saved(cell)
    expect(cell.get_by_text(f"◉ {RECALL.right.text}")).to_be_visible()
    cell = reopened.cell("viewer.add")
    saved(cell)
    expect(cell.locator("img")).to_be_visible()
    assert "Fixed Frame" in (cell.locator("img").get_attribute("alt") or "")
    picture(reopened, "night_received")
    cell.get_by_role("button", name="Continue here").click()
    expect(cell.locator("canvas").first).to_be_visible()
    reopened.wait_idle()
    expect(cell.locator(".course-saved")).to_have_count(0)
    assert reopened.errors() == []
