"""An interactive marker in real JupyterLab is dragged while its server runs live."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator

from tests.browser.jupyterlab import Lab, Notebook, opened
from tests.browser.waiting import wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder
SERVER = """%load_ext course_lib
import rclpy
from course_lib import Viewer, run_live
from course_lib.displays import Orbit
from interactive_markers import InteractiveMarkerServer
from rclpy.node import Node
from visualization_msgs.msg import InteractiveMarker, InteractiveMarkerControl, Marker

rclpy.init()
node = Node("control")
server = InteractiveMarkerServer(node, "simple")
marker = InteractiveMarker(name="box", description="Drag me")
marker.header.frame_id = "map"
TURNS = {"x": (1.0, 0.0, 0.0), "z": (0.0, 1.0, 0.0), "y": (0.0, 0.0, 1.0)}
for axis, (x, y, z) in TURNS.items():
    for mode in (InteractiveMarkerControl.MOVE_AXIS, InteractiveMarkerControl.ROTATE_AXIS):
        control = InteractiveMarkerControl(name=f"{axis}{mode}", interaction_mode=mode)
        control.orientation.x, control.orientation.y, control.orientation.z = x, y, z
        marker.controls.append(control)
cube = Marker(type=Marker.CUBE)
cube.scale.x = cube.scale.y = cube.scale.z = 0.45
cube.color.r = cube.color.g = cube.color.b = 0.5
cube.color.a = 1.0
plane = InteractiveMarkerControl(name="plane", interaction_mode=InteractiveMarkerControl.MOVE_PLANE)
plane.orientation.y = 1.0
plane.markers = [cube]
plane.always_visible = True
marker.controls.append(plane)
heard = []
server.insert(marker, feedback_callback=heard.append)
server.applyChanges()
"""
SHOW = """viewer = Viewer()
viewer.add("InteractiveMarkers", "/simple")
viewer.view = Orbit(distance=4.0)
viewer
"""
LIVE = "live = run_live(node)"


@pytest.fixture(scope="module")
def notebook(lab: Lab) -> Iterator[Notebook]:
    with opened(lab, "control.ipynb", (SERVER, SHOW, LIVE)) as notebook:
        notebook.run_all()
        yield notebook


def over(canvas: Locator, right: float, up: float) -> tuple[float, float]:
    """Return the page position of an offset from the middle of the canvas [pixels]."""
    box = canvas.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2 + right, box["y"] + box["height"] / 2 - up


def test_interactive_marker_is_dragged_while_its_server_runs_live(notebook: Notebook) -> None:
    canvas, mouse = notebook.cell(SHOW).locator("canvas").first, notebook.page.mouse
    is_over = "canvas => canvas.style.cursor == 'grab'"

    def seen() -> bool:
        mouse.move(*over(canvas, 0, 1))
        mouse.move(*over(canvas, 0, 0))
        return bool(canvas.evaluate(is_over))

    # In its first second a marker is no client's: the server drops a press, as in ROS.
    went_on = "print(node.get_clock().now().nanoseconds > 1_700_000_001 * 10**9)"
    wait_until(lambda: notebook.kernel(went_on).strip() == "True", notebook.page)
    wait_until(seen, notebook.page)
    mouse.down()
    latest = "print(*[feedback.event_type for feedback in heard][-1:])"
    wait_until(lambda: notebook.kernel(latest).strip() == "4", notebook.page)  # the server keeps one message
    for step in range(1, 9):
        mouse.move(*over(canvas, 10 * step, 0))
    moved = "p = server.get('box').pose.position; print(abs(p.x) + abs(p.y) > 0.1 and abs(p.z) < 1e-9)"
    wait_until(lambda: notebook.kernel(moved).strip() == "True", notebook.page)
    if PICTURES:
        notebook.page.screenshot(path=Path(PICTURES) / "interactive_markers_lab.png")
    mouse.up()
    wait_until(lambda: notebook.kernel(latest).strip() == "5", notebook.page)
    assert notebook.kernel("print({feedback.control_name for feedback in heard})").strip() == "{'plane'}"
    assert notebook.errors() == []
