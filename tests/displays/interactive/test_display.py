"""The InteractiveMarkers display: drawing of a server's markers, and feedback to the server."""

from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point, Pose, TransformStamped
from interactive_markers import InteractiveMarkerServer, MenuHandler
from msgspec.structs import replace
from rclpy.node import Node
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import (
    InteractiveMarker,
    MenuEntry,
)
from visualization_msgs.msg import InteractiveMarkerControl as C
from visualization_msgs.msg import InteractiveMarkerFeedback as F

from course_lib.displays.interactive import InteractiveMarkersDisplay
from course_lib.errors import CourseError
from course_lib.ros.time.driving import spin_for
from course_lib.viewer.drawables import Camera, Lines
from tests.displays.bench import Bench
from tests.displays.interactive.control_stage import Stage, box
from tests.displays.interactive.pointing import command
from tests.displays.stage import LATCHED, publish

NAME = "rviz_default_plugins/InteractiveMarkers"
LABEL = "Interactive Marker Client"


def test_late_joining_display_requests_the_markers_and_follows_updates(stage: Stage) -> None:
    display = stage.show(box(C.MOVE_AXIS))
    assert stage.status(display, LABEL) == ("ok", "Initialized")
    assert stage.status(display, "box") == ("ok", "Locked to frame map")
    parts = {path.split("/")[-3] for path in stage.viewer.scene.objects() if "/controls/" in path}
    assert parts == {"move", "button"}
    stage.server.setPose("box", Pose(position=Point(x=2.0)))
    stage.server.applyChanges()
    stage.add(box(name="other"))
    spin_for(0.1, stage.node)
    assert stage.place() == [2, 0, 0]
    assert [*display.markers] == ["box", "other"]
    stage.server.erase("box")
    stage.server.applyChanges()
    spin_for(0.1, stage.node)
    assert [*display.markers] == ["other"]


def test_display_shows_a_server_that_starts_later(stage: Stage) -> None:
    display = stage.viewer.add("InteractiveMarkers", "/late")
    assert "There is no server of interactive markers in /late." in str(stage.viewer.statuses())
    server = InteractiveMarkerServer(stage.node, "late")
    server.insert(box(C.MOVE_AXIS))
    server.applyChanges()
    spin_for(0.2, stage.node)
    assert isinstance(display, InteractiveMarkersDisplay)
    assert [*display.markers] == ["box"]
    server.shutdown()
    spin_for(0.2, stage.node)
    assert stage.status(display, LABEL) == ("warn", "Server not available while running, resetting")
    assert not display.markers


def test_unspun_server_causes_a_hint(stage: Stage) -> None:
    stage.add(box())
    stage.viewer.add("InteractiveMarkers", "/simple")
    spin_for(1.5, Node("other"))
    words = str(stage.viewer.statuses())
    assert "Did not receive response with interactive markers, resending request..." in words
    assert "spin_for(1.0, node)" in words
    spin_for(0.2, stage.node)
    assert stage.place() == [0, 0, 0]


def test_drag_along_an_axis_moves_the_marker_and_sends_feedback_for_each_step(stage: Stage) -> None:
    stage.show(box(C.MOVE_AXIS))
    side = Camera(eye=(0.0, -10.0, 0.0))
    stage.use("move", ("down", (0.7, 0.0, 0.0)), ("move", (1.2, 0.0, 0.5)), camera=side)
    stage.use("move", ("move", (1.7, 0.0, 0.0)), ("up", (1.7, 0.0, 0.0)), camera=side)
    assert stage.place() == [1, 0, 0]
    events = [feedback.event_type for feedback in stage.heard]
    assert events == [F.POSE_UPDATE, F.MOUSE_DOWN, F.POSE_UPDATE, F.POSE_UPDATE, F.POSE_UPDATE, F.MOUSE_UP]
    assert {(f.marker_name, f.control_name, f.client_id) for f in stage.heard} == {("box", "move", "/rviz2")}
    down, last = stage.heard[1], stage.heard[-1]
    assert (down.mouse_point.x, down.mouse_point_valid, down.header.frame_id) == (0.7, True, "map")
    assert last.pose.position.x == pytest.approx(1.0)
    marker = stage.server.get("box")
    assert marker is not None
    assert marker.pose.position.x == pytest.approx(1.0)


def test_rotated_marker_is_drawn_rotated(stage: Stage) -> None:
    stage.show(box(C.ROTATE_AXIS))
    stage.use("turn", ("down", (0.0, 0.5, 0.0)), ("move", (0.0, 0.0, 0.5)), ("up", (0.0, 0.0, 0.5)))
    turn = stage.heard[-1].pose.orientation
    assert (turn.x, turn.w) == pytest.approx((0.5**0.5, 0.5**0.5))
    path = "displays/InteractiveMarkers/handles/box/controls/button"
    assert stage.viewer.scene.world_transform(path)[:3, 1] == pytest.approx((0, 0, 1), abs=1e-9)


def test_button_is_clicked_on_release(stage: Stage) -> None:
    stage.show(box())
    stage.use("button", ("down", (0.5, 0.0, 0.0)), ("up", (0.5, 0.0, 0.0)))
    events = [feedback.event_type for feedback in stage.heard]
    assert events == [F.POSE_UPDATE, F.MOUSE_DOWN, F.BUTTON_CLICK, F.POSE_UPDATE, F.MOUSE_UP]


def test_server_corrects_a_drag_on_release(stage: Stage) -> None:
    def to_the_grid(feedback: F) -> None:
        at = Pose(position=Point(x=float(round(feedback.pose.position.x))))
        stage.server.setPose("box", at)

    stage.show(box(C.MOVE_AXIS))
    stage.server.setCallback("box", to_the_grid)
    side = Camera(eye=(0.0, -10.0, 0.0))
    stage.use("move", ("down", (0.7, 0.0, 0.0)), ("move", (1.5, 0.0, 0.0)), camera=side)
    assert stage.place() == [0.8, 0, 0]
    stage.use("move", ("up", (1.5, 0.0, 0.0)), camera=side)
    assert stage.place() == [1, 0, 0]


def test_right_click_opens_a_menu_and_a_selection_sends_feedback(stage: Stage) -> None:
    menu, chosen = MenuHandler(), list[F]()
    for title in ("One", "Two"):
        menu.insert(title, callback=chosen.append)
    menu.insert("Below", parent=menu.insert("More"))
    menu.insert("Run", command_type=MenuEntry.ROSRUN, command="turtlesim turtlesim_node")
    menu.setCheckState(1, MenuHandler.CHECKED)
    stage.add(box(C.MENU))
    menu.apply(stage.server, "box")
    stage.server.applyChanges()
    display = stage.show()
    entries = stage.use("button", ("down", (0.5, 0.0, 0.0)), ("up", (0.5, 0.0, 0.0)), button=2)
    assert [(entry.id, entry.text.strip("\u3000"), entry.opens) for entry in entries] == [
        (1, "☑ One", False),
        (2, "Two", False),
        (3, "More", True),
        (4, "Below", False),
        (5, "Run", False),
    ]
    path = "displays/InteractiveMarkers/handles/box/controls/button/0/body"
    assert display.choose(path, 2) == ""
    spin_for(0.1, stage.node)
    assert [(f.menu_entry_id, f.control_name, f.mouse_point.x) for f in chosen] == [(2, "button", 0.5)]
    assert display.choose(path, 5).endswith("Run it in a cell: %ros2 run turtlesim turtlesim_node")
    with pytest.raises(CourseError, match="no longer in the menu"):
        display.choose(path, 9)
    assert len(stage.use("menu", ("down", (0.5, 0.0, 0.0)), ("up", (0.5, 0.0, 0.0)))) == 5  # a left click


def test_marker_locked_to_a_frame_moves_and_sends_feedback_in_this_frame(stage: Stage) -> None:
    transform = TransformStamped(header=Header(frame_id="map"), child_frame_id="base")
    transform.transform.translation.y = 3.0
    publish(stage.graph, "/tf_static", TFMessage(transforms=[transform]), LATCHED)
    stage.show(box(C.MOVE_AXIS, frame="base"))
    assert stage.place() == [0, 3, 0]
    side = Camera(eye=(0.0, -10.0, 0.0))
    stage.use("move", ("down", (0.7, 3.0, 0.0)), ("move", (1.7, 3.0, 0.0)), camera=side)
    last = stage.heard[-1]
    assert (last.header.frame_id, last.pose.position.y) == ("base", 0.0)
    assert last.pose.position.x == pytest.approx(1.0)
    assert stage.place() == pytest.approx([1, 3, 0])


def test_marker_in_an_unknown_frame_waits_for_its_transform_and_reports_it(stage: Stage) -> None:
    display = stage.show(box(frame="nowhere"))
    level, text = stage.status(display, LABEL)
    assert level == "ok"
    assert text.startswith("Resetting due to transform error: ")
    assert not display.markers
    transform = TransformStamped(header=Header(frame_id="map"), child_frame_id="nowhere")
    publish(stage.graph, "/tf_static", TFMessage(transforms=[transform]), LATCHED)
    spin_for(0.1, stage.node)
    assert stage.place() == [0, 0, 0]


def test_view_facing_control_rotates_with_the_view(stage: Stage) -> None:
    control = C(name="face", interaction_mode=C.MOVE_PLANE, orientation_mode=C.VIEW_FACING)
    marker = InteractiveMarker(header=Header(frame_id="map"), name="box", controls=[control])
    stage.show(marker)
    path = "displays/InteractiveMarkers/handles/box/controls/face"
    for eye in ((10.0, 0.0, 0.0), (0.0, 0.0, 10.0)):
        stage.viewer.session.on_view_turn(Camera(eye=eye, up=(0.0, 1.0, 0.0)))
        x_axis = stage.viewer.scene.world_transform(path)[:3, 0]
        assert x_axis == pytest.approx(-np.array(eye) / 10, abs=1e-3)


def test_descriptions_axes_and_visual_aids_are_shown_on_request(stage: Stage) -> None:
    display = stage.show(box(C.MOVE_AXIS))
    scene, node = stage.viewer.scene, "displays/InteractiveMarkers/handles/box"
    assert (scene.is_visible(f"{node}/title/0/text"), scene.is_visible(f"{node}/axes")) == (True, False)
    display["Show Descriptions"], display["Show Axes"], display["Show Visual Aids"] = False, True, True
    assert (scene.is_visible(f"{node}/title/0/text"), scene.is_visible(f"{node}/axes")) == (False, True)
    stage.use("move", ("down", (0.7, 0.0, 0.0)))
    assert isinstance(scene.objects()[f"{node}/controls/move/aid"], Lines)
    stage.use("move", ("up", (0.7, 0.0, 0.0)))
    assert f"{node}/controls/move/aid" not in scene.objects()


def test_pointer_events_on_an_erased_marker_have_no_effect(stage: Stage) -> None:
    display = stage.show(box(C.MOVE_AXIS))
    stage.use("move", ("down", (0.7, 0.0, 0.0)))
    stage.server.erase("box")
    stage.server.applyChanges()
    spin_for(0.1, stage.node)
    assert stage.use("move", ("move", (1.0, 0.0, 0.0)), ("up", (1.0, 0.0, 0.0))) == ()
    assert not display.markers


def test_empty_namespace_is_reported_with_rviz_text() -> None:
    bench = Bench()
    display = bench.session.add(NAME, "Im", {})
    assert bench.status(display, LABEL) == ("error", "Error connecting: empty namespace")


def test_lost_update_makes_the_client_request_the_markers_again(stage: Stage) -> None:
    display = stage.show(box())
    stage.add(box(name="other"))
    stage.server.seq_num += 1
    stage.server.setPose("box", Pose(position=Point(x=1.0)))
    stage.server.applyChanges()
    texts = [row.text for row in display.rows()]
    assert "Update sequence number is out of order. 3 (expected) vs. 4 (received)" in texts
    spin_for(0.1, stage.node)  # it asks with the next frame
    spin_for(0.1, stage.node)
    assert stage.place() == [1, 0, 0]


def test_frame_without_motion_makes_no_scene_changes(stage: Stage) -> None:
    stage.show(box(C.MOVE_AXIS))
    stage.viewer.refresh()
    changes: list[str] = []
    stage.viewer.scene.listen(lambda what, path: changes.append(f"{what} {path}"))
    stage.viewer.refresh()
    assert changes == []
    stage.viewer.session.on_view_turn(Camera(eye=(0.0, 9.0, 4.0)))
    assert any(change.endswith("/title") for change in changes)


@pytest.mark.parametrize("wrong", [{"direction": (0.0, 0.0, 0.0)}, {"pixel": 0.0}])
def test_ray_without_a_direction_is_rejected(stage: Stage, wrong: Any) -> None:
    display = stage.show(box(C.MOVE_AXIS))
    path = f"{display.path}/handles/box/controls/move/0/shaft"
    with pytest.raises(CourseError, match="has no direction"):
        display.use(replace(command(path, "down", (0.7, 0.0, 0.0)), **wrong))
