"""Joint sliders by keyboard, in real JupyterLab."""

from collections.abc import Iterator
from math import pi

import pytest
from playwright.sync_api import expect

from tests.browser.jupyterlab import Lab, Notebook, opened
from tests.browser.waiting import wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
CELLS = (
    "%load_ext course_lib\n"
    "import rclpy\n"
    "from course_lib import load_robot\n"
    "from course_lib.robots.joint_state_publisher import JointStatePublisher\n"
    "from course_lib.robots.joint_state_publisher import joint_sliders\n"
    "rclpy.init()\n"
    "publisher = JointStatePublisher(load_robot('ur10').urdf)",
    "joint_sliders(publisher)",
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


def test_a_slider_moves_by_arrow_keys_in_steps_of_a_thousandth(notebook: Notebook) -> None:
    cell = notebook.cell("joint_sliders(publisher)")
    expect(cell.get_by_text("-3.142 … 3.142 rad")).to_be_visible()
    cell.locator(".widget-slider", has_text="elbow_joint").locator(".noUi-handle").focus()
    for _ in range(5):
        notebook.page.keyboard.press("ArrowRight")
    elbow_comes_to(notebook, 5 * 2 * pi / 1000, within=1e-3)


def test_a_position_may_be_typed_and_taken_back(notebook: Notebook) -> None:
    cell = notebook.cell("joint_sliders(publisher)")
    number = cell.locator(".widget-slider", has_text="elbow_joint").locator(".widget-readout")
    number.fill("-1.25")
    number.press("Enter")
    elbow_comes_to(notebook, -1.25, within=2 * pi / 1000)
    cell.get_by_role("button", name="Center").click()
    elbow_comes_to(notebook, 0.0, within=0.0)
