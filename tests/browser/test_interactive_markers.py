"""Interactive markers in a real page: the server receives drags, clicks and menu selections."""

from collections.abc import Iterator

import pytest
import rclpy
from interactive_markers import InteractiveMarkerServer, MenuHandler
from rclpy.node import Node
from std_msgs.msg import Header
from visualization_msgs.msg import (
    InteractiveMarker,
    InteractiveMarkerControl,
    InteractiveMarkerFeedback,
    Marker,
)

from course_lib.displays.views import Orbit
from course_lib.ros.time.driving import spin_for
from tests.browser.bench import Bench
from tests.browser.waiting import wait_until

pytestmark = pytest.mark.browser
FEEDBACK = InteractiveMarkerFeedback
HALF_PI = 1.5707963


class Server:
    """A red box that moves along y, with a menu; and the feedback on it."""

    def __init__(self, bench: Bench) -> None:
        rclpy.init(args=[])
        self.bench, self.node = bench, Node("control")
        self.server, self.menu = InteractiveMarkerServer(self.node, "simple"), MenuHandler()
        self.heard: list[InteractiveMarkerFeedback] = []
        self.chosen: list[int] = []
        cube = Marker(type=Marker.CUBE)
        cube.color.r = cube.color.a = 1.0
        cube.scale.x = cube.scale.y = cube.scale.z = 2.0
        move = InteractiveMarkerControl.MOVE_AXIS
        control = InteractiveMarkerControl(name="move", interaction_mode=move, markers=[cube])
        control.orientation.z = control.orientation.w = 0.5**0.5
        marker = InteractiveMarker(header=Header(frame_id="map"), name="box", controls=[control])
        self.server.insert(marker, feedback_callback=self.heard.append)
        for title in ("First", "Second"):
            self.menu.insert(title, callback=lambda feedback: self.chosen.append(feedback.menu_entry_id))
        self.menu.apply(self.server, "box")
        self.server.applyChanges()
        bench.viewer.remove(bench.viewer["Marker"])
        bench.viewer.add("InteractiveMarkers", "/simple")
        bench.viewer.view = Orbit(yaw=0.0, pitch=0.3)  # y is to the right
        self.spin(1.5)
        wait_until(self.can_grab, bench.page)

    def can_grab(self) -> bool:
        """Move the pointer to the middle, and return whether the page detects a marker there."""
        self.spin()
        canvas = self.bench.page.locator("canvas")
        canvas.hover()
        return bool(canvas.evaluate("canvas => canvas.style.cursor == 'grab'"))

    def spin(self, seconds: float = 0.1) -> None:
        spin_for(seconds, self.node)
        self.bench.viewer.refresh()
        self.bench.widget.flush()
        self.bench.host.carry()


@pytest.fixture
def server(bench: Bench) -> Iterator[Server]:
    yield Server(bench)
    rclpy.shutdown()


def test_interactive_marker_is_dragged_along_its_axis(server: Server) -> None:
    server.bench.drag((0, 0), (40, 0), (80, 15))
    server.spin()
    events = [feedback.event_type for feedback in server.heard]
    assert events[:2] == [FEEDBACK.POSE_UPDATE, FEEDBACK.MOUSE_DOWN]
    assert events[-1] == FEEDBACK.MOUSE_UP
    at = server.heard[-1].pose.position
    assert at.y > 0.5
    assert (at.x, at.z) == pytest.approx((0, 0), abs=1e-9)
    marker = server.server.get("box")
    assert marker is not None
    assert marker.pose.position.y == pytest.approx(at.y)


def test_control_below_the_pointer_is_brighter_until_the_pointer_has_left(server: Server) -> None:
    page = server.bench.page
    box = page.locator("canvas").bounding_box()
    assert box is not None
    row, column = round(box["y"] + box["height"] / 2), round(box["x"] + box["width"] / 2)

    def middle() -> int:
        """Return the green part of the red box, which only its highlight adds."""
        return int(server.bench.host.pixels()[row, column, 1])

    wait_until(lambda: middle() == pytest.approx(0.15 * 255, abs=2), page)
    page.mouse.down()
    server.spin()
    wait_until(lambda: middle() == pytest.approx(0.25 * 255, abs=2), page)
    page.mouse.up()
    page.mouse.move(box["x"] + 5, box["y"] + 5)
    server.spin()
    wait_until(lambda: middle() == 0, page)


@pytest.mark.slow
def test_dragging_next_to_a_marker_sends_no_feedback(server: Server) -> None:
    server.bench.drag((-200, -200), (-100, -200))
    server.spin()
    assert server.heard == []


@pytest.mark.slow
def test_menu_opens_with_the_right_button_and_is_operated_by_keyboard(server: Server) -> None:
    bench = server.bench
    box = bench.page.locator("canvas").bounding_box()
    assert box is not None
    bench.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, button="right")
    bench.host.carry()
    dialog = bench.page.get_by_role("dialog", name="Choose")
    assert dialog.get_by_role("option").all_inner_texts() == ["\u3000First", "\u3000Second"]
    dialog.get_by_role("listbox").press("End")
    dialog.get_by_role("listbox").press("Enter")
    bench.host.carry()
    server.spin()
    assert server.chosen == [2]


@pytest.mark.slow
def test_other_tools_do_not_move_interactive_markers(server: Server) -> None:
    server.bench.page.locator("canvas").press("m")
    server.bench.drag((0, 0), (40, 0))
    server.spin()
    assert server.heard == []
