"""Joint sliders by keyboard, in real JupyterLab."""

from collections.abc import Iterator
from math import pi

import pytest
from playwright.sync_api import expect

from tests.browser.axe import faults
from tests.browser.jupyterlab import VIEWPORT, Lab, Notebook, opened
from tests.browser.waiting import wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
CELLS = (
    "%load_ext course_lib\n"
    "import rclpy\n"
    "from course_lib import load_robot\n"
    "from course_lib.robots.state_publishers import JointStatePublisher\n"
    "from course_lib.robots.state_publishers import joint_sliders\n"
    "rclpy.init()\n"
    "publisher = JointStatePublisher(load_robot('ur10').urdf)",
    "joint_sliders(publisher)",
    "from course_lib import slider\nslider('edge [m]', 0.1, 2.0, lambda edge: None)",
)


@pytest.fixture(scope="module")
def notebook(lab: Lab) -> Iterator[Notebook]:
    with opened(lab, "sliders.ipynb", CELLS) as notebook:
        notebook.run_all()
        yield notebook


def elbow_comes_to(notebook: Notebook, position: float, within: float) -> None:
    """Wait until the elbow is at a position [rad]."""

    def is_there() -> bool:
        elbow = float(notebook.kernel("print(publisher.joints['elbow_joint'].position)"))
        return abs(elbow - position) <= within

    wait_until(is_there, notebook.page)


def test_sliders_are_accessible_by_keyboard_and_screen_reader(notebook: Notebook) -> None:
    cell = notebook.cell("joint_sliders(publisher)")
    expect(cell.get_by_role("slider")).to_have_count(6)
    cell.evaluate("cell => cell.querySelector('.jp-OutputArea').id = 'looked-at'")
    assert faults(notebook.page, "#looked-at") == []


def test_arrow_keys_move_a_slider_by_a_thousandth(notebook: Notebook) -> None:
    cell = notebook.cell("joint_sliders(publisher)")
    cell.get_by_text("-3.142 … 3.142 rad").wait_for()
    elbow = cell.get_by_role("slider", name="elbow_joint")
    elbow.focus()
    for key in ("ArrowRight",) * 4 + ("ArrowUp",) * 2 + ("ArrowLeft",):
        notebook.page.keyboard.press(key)
    elbow_comes_to(notebook, 5 * 2 * pi / 1000, within=1e-3)
    expect(elbow).to_be_focused()  # JupyterLab has not taken ArrowUp for itself
    expect(elbow).to_have_attribute("aria-valuetext", "0.031")


def test_typed_position_is_clamped_and_can_be_centered(notebook: Notebook) -> None:
    cell = notebook.cell("joint_sliders(publisher)")
    number = cell.get_by_role("spinbutton", name="elbow_joint, as a number")
    number.fill("-1.25")
    number.press("Enter")
    elbow_comes_to(notebook, -1.25, within=0.0)
    number.fill("99")
    number.press("Enter")
    elbow_comes_to(notebook, pi, within=1e-3)
    cell.get_by_role("button", name="Center").click()
    elbow_comes_to(notebook, 0.0, within=0.0)
    expect(number).to_have_value("0.000")


def test_slider_fits_a_narrow_window(notebook: Notebook) -> None:
    notebook.page.set_viewport_size({"width": 640, "height": 720})
    cell = notebook.cell("edge [m]")
    ends = """cell => ["input[type=number]", ".jp-OutputArea-output"]
        .map(part => cell.querySelector(part).getBoundingClientRect().right)"""
    try:
        number_end, output_end = cell.evaluate(ends)
        assert number_end <= output_end
    finally:
        notebook.page.set_viewport_size(VIEWPORT)
