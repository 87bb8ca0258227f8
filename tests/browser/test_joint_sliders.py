"""Joint sliders by keyboard, in real JupyterLab."""

from collections.abc import Iterator
from math import pi

import pytest
from playwright.sync_api import Browser, expect

from tests.browser.jupyterlab import Notebook, course_lab, write_notebook

pytestmark = [pytest.mark.browser, pytest.mark.slow]
CELLS = (
    "%load_ext course_lib\n"
    "import rclpy\n"
    "from course_lib import load_robot\n"
    "from course_lib.robots.joint_state_publisher import JointStatePublisher\n"
    "from course_lib.robots.sliders import joint_sliders\n"
    "rclpy.init()\n"
    "publisher = JointStatePublisher(load_robot('ur10').urdf)",
    "joint_sliders(publisher)",
)


@pytest.fixture(scope="module")
def notebook(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Notebook]:
    folder = tmp_path_factory.mktemp("student") / "my_course"
    folder.mkdir()
    write_notebook(folder / "sliders.ipynb", CELLS)
    with course_lab(folder, folder.parent / "home") as address:
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        notebook = Notebook(page, address, "sliders.ipynb")
        notebook.run_all()
        yield notebook
        page.close()


def elbow(notebook: Notebook) -> float:
    notebook.wait_idle()
    return float(notebook.kernel("print(publisher.joints['elbow_joint'].position)"))


def test_a_slider_moves_by_arrow_keys_in_steps_of_a_thousandth(notebook: Notebook) -> None:
    cell = notebook.cell("joint_sliders(publisher)")
    expect(cell.get_by_text("-3.142 … 3.142 rad")).to_be_visible()
    cell.locator(".widget-slider", has_text="elbow_joint").locator(".noUi-handle").focus()
    for _ in range(5):
        notebook.page.keyboard.press("ArrowRight")
    notebook.page.wait_for_timeout(500)
    assert elbow(notebook) == pytest.approx(5 * 2 * pi / 1000, abs=1e-3)


def test_a_position_may_be_typed_and_taken_back(notebook: Notebook) -> None:
    cell = notebook.cell("joint_sliders(publisher)")
    number = cell.locator(".widget-slider", has_text="elbow_joint").locator(".widget-readout")
    number.fill("-1.25")
    number.press("Enter")
    notebook.page.wait_for_timeout(500)
    assert elbow(notebook) == pytest.approx(-1.25, abs=2 * pi / 1000)
    cell.get_by_role("button", name="Center").click()
    notebook.page.wait_for_timeout(500)
    assert elbow(notebook) == 0.0
