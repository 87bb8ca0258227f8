"""rqt's views in real JupyterLab, while nodes run live and by keyboard."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect
from rcl_interfaces.msg import Log

from course_lib.ros.graph.graph import Graph
from course_lib.tools.rqt.monitors import ConsoleView, topic_cells
from course_lib.tools.rqt.view import STYLE
from tests.browser.axe import faults
from tests.browser.jupyterlab import Lab, Notebook, opened
from tests.browser.waiting import at_rest, wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder
NARROW = 900  # [px] of a window
NODES = """%load_ext course_lib
from math import sin
import rclpy
from example_interfaces.srv import AddTwoInts
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from std_msgs.msg import Float64
from course_lib import run_live

class Arm(Node):
    def __init__(self):
        super().__init__("controller", namespace="arm")
        limits = ParameterDescriptor(floating_point_range=[FloatingPointRange(from_value=0.0, to_value=5.0)])
        self.declare_parameter("gain", 1.0, limits)
        self.declare_parameter("frame", "base")
        self.add_on_set_parameters_callback(self.check)
        self.angle = self.create_publisher(Float64, "angle", 10)
        self.create_timer(0.05, self.move)
        self.create_service(AddTwoInts, "add", self.add)

    def check(self, parameters):
        good = all(p.name != "frame" or p.value == "base" for p in parameters)
        return SetParametersResult(successful=good, reason="" if good else "there is only base")

    def move(self):
        seconds = self.get_clock().now().nanoseconds * 1e-9
        self.angle.publish(Float64(data=self.get_parameter("gain").value * sin(seconds)))

    def add(self, request, response):
        response.sum = request.a + request.b
        return response

rclpy.init()
arm, planner = Arm(), Node("planner")
heard = []
planner.create_subscription(Float64, "/arm/angle", heard.append, 10)
live = run_live(arm, planner)"""
VIEWS = (
    "%rqt graph",
    "%rqt plot /arm/angle/data",
    "%rqt reconfigure /arm/controller\n%rqt service_caller /arm/add",
)


@pytest.fixture(scope="module")
def notebook(lab: Lab) -> Iterator[Notebook]:
    with opened(lab, "rqt.ipynb", (NODES, *VIEWS)) as notebook:
        notebook.run_all()
        yield notebook


def look(notebook: Notebook, cell: Locator, name: str) -> None:
    if PICTURES:
        cell.screenshot(path=Path(PICTURES) / f"rqt_{name}.png")


@pytest.mark.parametrize("view", VIEWS)
def test_rqt_views_are_accessible_by_keyboard_and_screen_reader(notebook: Notebook, view: str) -> None:
    notebook.cell(view).locator(".rqt").first.wait_for()
    notebook.cell(view).evaluate("cell => cell.id = 'looked-at'")
    usual = notebook.page.viewport_size
    assert usual is not None
    try:
        found = faults(notebook.page, "#looked-at .rqt")
        notebook.page.set_viewport_size({**usual, "width": NARROW})
        found += faults(notebook.page, "#looked-at .rqt")
    finally:
        notebook.page.set_viewport_size(usual)
        notebook.cell(view).evaluate("cell => cell.removeAttribute('id')")
    assert found == []


def test_rqt_graph_updates_when_nodes_change(notebook: Notebook) -> None:
    cell = notebook.cell(VIEWS[0])
    expect(cell.locator("ellipse")).to_have_count(2)
    cell.get_by_role("img", name="2 nodes. /arm/controller to /arm/angle").wait_for()
    notebook.kernel("planner.create_publisher(Float64, 'goal', 1)")
    cell.get_by_label("Show").select_option("Nodes/Topics (all)")
    cell.locator("svg text", has_text="/goal").wait_for()
    look(notebook, cell, "graph")


def test_rqt_plot_scrolls_until_paused_by_keyboard(notebook: Notebook) -> None:
    cell = notebook.cell(VIEWS[1])
    curve = cell.get_by_role("img", name="Values from")  # and the last value, then
    before = curve.get_attribute("aria-label")
    expect(curve).not_to_have_attribute("aria-label", before or "")
    cell.get_by_label("Pause").focus()
    notebook.page.keyboard.press("Space")
    expect(cell.get_by_label("Pause")).to_be_checked()
    notebook.kernel("pass")  # after it, all messages before the pause have arrived
    # A busy page still draws the received messages.
    before = at_rest(lambda: curve.get_attribute("aria-label"))
    notebook.page.wait_for_timeout(600)
    assert curve.get_attribute("aria-label") == before
    look(notebook, cell, "plot")


def test_parameters_are_set_while_nodes_run_and_a_rejected_value_shows_the_reason(notebook: Notebook) -> None:
    cell = notebook.cell(VIEWS[2])
    frame = cell.get_by_label("frame")
    frame.fill("map")
    frame.press("Enter")
    cell.get_by_text("Not set: there is only base").wait_for()
    expect(frame).to_have_value("base")
    cell.get_by_role("slider", name="gain").focus()
    notebook.page.keyboard.press("ArrowRight")
    cell.get_by_text("set", exact=True).wait_for()
    assert float(notebook.kernel("print(arm.get_parameter('gain').value)")) > 1.0


def test_rqt_service_caller_shows_the_response_and_closes(notebook: Notebook) -> None:
    cell = notebook.cell(VIEWS[2])
    cell.get_by_label("Request").fill("{a: 20, b: 22}")
    cell.get_by_role("button", name="Call").press("Enter")
    cell.get_by_text("sum: 42").wait_for()
    look(notebook, cell, "services")
    cell.get_by_role("button", name="Close").first.press("Enter")
    expect(cell.get_by_text("Dynamic Reconfigure")).to_have_count(0)
    cell.get_by_text("Service Caller").wait_for()
    assert notebook.errors() == []
    wait_until(lambda: int(notebook.kernel("print(len(heard))")) > 10, notebook.page)


COUNT_LINES = """cell => {
    const range = document.createRange();
    range.selectNodeContents(cell);
    return new Set([...range.getClientRects()].map(({ top }) => Math.round(top))).size; }"""


@pytest.mark.parametrize(("width", "lines"), [(1000, [1, 1, 1]), (640, [1, 2, 2]), (400, [1, 1, 1])])  # [px]
def test_console_beside_a_view_breaks_lines_between_parts_of_names(
    one_page: Page, width: int, lines: list[int]
) -> None:
    log = Log(msg="30 images per second", name="robot.camera_driver", level=20, line=116)
    log.file, log.function = "unknown_robot.py", "start"
    log.stamp.sec, log.stamp.nanosec = 1700000128, 348246398
    console = ConsoleView(Graph(), [])
    console._logs.append((2, log))
    one_page.set_viewport_size({"width": width, "height": 200})  # [px]
    one_page.set_content(console.static_html())
    cells = one_page.locator("td")
    assert [cells.nth(index).evaluate(COUNT_LINES) for index in (1, 4, 5)] == lines
    screen = one_page.locator(".rqt-screen")
    assert screen.evaluate("screen => screen.scrollWidth - screen.clientWidth") == 0


@pytest.mark.parametrize(("width", "lines"), [(1000, 1), (560, 2), (380, 3)])  # [px]
def test_topic_monitor_is_higher_in_a_narrow_cell(one_page: Page, width: int, lines: int) -> None:
    cells = topic_cells(["visualization_msgs/msg/MarkerArray", "278.16 KB/s", "30.00", 30 * "0.0,"])
    boxes = "style='display: flex'"  # as by the style of ipywidgets
    name = "<button style='flex: none; width: 210px; height: 28px'>/robot/annotations</button>"
    row = f"<div class='widget-hbox rqt-row' {boxes}>{name}<div class='widget-html' style='flex: 1'>{cells}"
    one_page.set_viewport_size({"width": width, "height": 200})  # [px]
    one_page.set_content(f"{STYLE}<div class='rqt'><div class='rqt-wide'>{row}")
    sheet = one_page.locator(".rqt-wide")
    assert sheet.evaluate("sheet => sheet.scrollWidth - sheet.clientWidth") == 0
    read = "parts => parts.map((part) => [part.getBoundingClientRect().bottom, part.offsetWidth])"
    parts = one_page.locator("button, .rqt-cells span").evaluate_all(read)
    assert len({round(bottom / 15) for bottom, _ in parts[1:]}) + (parts[0][1] > 300) == lines
    assert parts[-1][1] > 200


def test_notice_follows_the_colors_of_a_dark_theme(one_page: Page) -> None:
    theme = "--jp-layout-color1: #111111; --jp-ui-font-color1: #eeeeee"
    notice = "<p class='rqt-notice'>Not set: there is only base</p>"
    one_page.set_content(f"{STYLE}<div class='rqt' style='{theme}'>{notice}</div>")
    # A canvas converts any color to 8 bits a channel.
    read = """(notice, property) => {
        const pen = new OffscreenCanvas(1, 1).getContext("2d");
        pen.fillStyle = getComputedStyle(notice)[property];
        pen.fillRect(0, 0, 1, 1);
        return Math.max(...pen.getImageData(0, 0, 1, 1).data.slice(0, 3)); }"""
    shades = [
        one_page.locator(".rqt-notice").evaluate(f"notice => ({read})(notice, '{name}')")
        for name in ("backgroundColor", "color")
    ]
    assert shades[0] < 100 < 200 < shades[1]
