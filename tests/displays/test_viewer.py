from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import meshcat.geometry
import numpy as np
import pytest
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from course_lib.displays.display import Group
from course_lib.displays.statuses import StatusTable
from course_lib.displays.viewer import Viewer
from course_lib.displays.views import Orbit, TopDownOrtho
from course_lib.errors import CourseError
from course_lib.robots.kinematics import link_poses
from course_lib.robots.mobile_manipulator import simple_painter
from course_lib.robots.robot import load_robot
from course_lib.ros.graph.graph import Graph
from course_lib.ros.graph.topics import Qos
from course_lib.viewer import encoding
from course_lib.viewer.drawables import Solids
from tests.displays.bench import marker
from tests.displays.stage import LATCHED, publish, visible_nodes
from tests.displays.test_layout import LAYOUT


def test_unquoted_fixed_frame_is_rejected_before_displays_wait_for_it(graph: Graph) -> None:
    viewer, no_name = Viewer(), cast("Any", map)
    for refused in (lambda: Viewer(fixed_frame=no_name), lambda: setattr(viewer, "fixed_frame", no_name)):
        with pytest.raises(CourseError, match=r'the fixed frame map is not a string\. .* fixed_frame="map"'):
            refused()
    publish(graph, "/markers", marker())
    assert viewer.fixed_frame == "map"


def test_new_viewer_shows_a_grid_in_its_fixed_frame(graph: Graph) -> None:
    viewer = Viewer(fixed_frame="odom")
    assert [display.name for display in viewer.displays] == ["Grid"]
    assert viewer.fixed_frame == "odom"
    assert visible_nodes(viewer) == {"Grid"}


def test_display_shows_published_messages(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    publish(graph, "/m", marker())
    assert visible_nodes(viewer) == {"Grid", "Marker"}
    assert ("Marker", "Topic", "ok", "1 messages received at inf hz.") in viewer.statuses()


def test_cell_that_runs_again_replaces_the_equal_display_it_has_added(
    graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    viewer = Viewer()

    def run(cell: str, number: int, *topics: str) -> list[Any]:
        monkeypatch.setattr("course_lib.displays.viewer.running_cell", lambda: (cell, f"run {number}"))
        for topic in topics:
            viewer.add("Marker", topic=topic)
        return [display["Topic"] for display in viewer.displays[1:]]

    assert run("first", 1, "/a", "/b") == ["/a", "/b"]
    publish(graph, "/a", marker())
    path = viewer.displays[1].path
    assert run("first", 2, "/a", "/a") == ["/b", "/a", "/a"]
    assert viewer.displays[2].path == path
    assert run("first", 3, "/a", "/a", "/c") == ["/b", "/a", "/a", "/c"]
    assert run("second", 4, "/c") == ["/b", "/a", "/a", "/c", "/c"]


def test_display_added_without_a_cell_never_replaces_another_one(graph: Graph) -> None:
    viewer = Viewer()
    assert viewer.add("Marker", topic="/a") is not viewer.add("Marker", topic="/a")
    assert len(viewer.displays) == 3


def test_late_joining_display_needs_transient_local_to_receive_latched_messages(graph: Graph) -> None:
    publish(graph, "/m", marker(), LATCHED)
    viewer = Viewer()
    display = viewer.add("Marker", topic="/m")
    assert visible_nodes(viewer) == {"Grid"}
    assert "set Durability Policy to Transient Local" in str(viewer.statuses())
    display["Durability Policy"] = "Transient Local"
    assert visible_nodes(viewer) == {"Grid", "Marker"}
    assert "Transient Local" not in str(viewer.statuses())


def test_late_joining_viewer_receives_static_transforms(graph: Graph) -> None:
    transform = TransformStamped(child_frame_id="base")
    transform.header.frame_id = "map"
    publish(graph, "/tf_static", TFMessage(transforms=[transform]), LATCHED)
    assert ("Global Status", "Fixed Frame", "ok", "OK") in Viewer().statuses()


def test_slow_publisher_of_a_display_gets_no_hint_about_other_topics(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/plan")
    publish(graph, "/cube", marker())
    assert "no message has arrived on /plan" in str(viewer.statuses())
    graph.add_publisher(graph.add_node("planner", "/"), "/plan", "visualization_msgs/msg/Marker", Qos())
    assert "no message has arrived on /plan" not in str(viewer.statuses())


def test_markers_expire_by_robot_time(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    fading = marker()
    fading.lifetime.sec = 1
    publish(graph, "/m", fading)
    assert visible_nodes(viewer) == {"Grid", "Marker"}
    graph.call_at(graph.now_ns + 2 * 10**9, lambda: None, node=1, entity=0)
    graph.advance()
    assert "displays/Marker/n/0/body" not in viewer.scene.objects()


def test_properties_set_by_label_or_attribute_are_applied_immediately(graph: Graph) -> None:
    viewer = Viewer()
    grid = viewer["Grid"]
    before = viewer.scene.objects()["displays/Grid/drawing"]
    grid["Cell Size"] = 0.5
    assert viewer.scene.objects()["displays/Grid/drawing"] is not before
    labels: dict[str, Any] = {"Plane Cell Count": 4}
    viewer.add("Grid", name="Big", cell_size=2, **labels)
    assert (viewer["Big"]["Cell Size"], viewer["Big"]["Plane Cell Count"]) == (2.0, 4)


def test_remove_deletes_a_display_and_its_objects(graph: Graph) -> None:
    viewer = Viewer()
    grid = viewer["Grid"]
    viewer.remove(grid)
    assert viewer.displays == []
    assert viewer.scene.objects() == {}
    with pytest.raises(CourseError, match="is not in this viewer"):
        viewer.remove(grid)


MISTAKES: dict[str, tuple[Callable[[Viewer], Any], str]] = {
    "class": (lambda v: v.add("Markr"), "no display 'Markr'; use one of Marker, MarkerArray"),
    "class of RViz2": (lambda v: v.add("PathDisplay"), "no display 'PathDisplay'; use Path."),
    "class with one near name": (lambda v: v.add("LaserSkan"), "no display 'LaserSkan'; use LaserScan."),
    "property": (lambda v: v.add("Marker", topc="/m"), "has no property 'topc'; it has 'Topic'"),
    "value": (lambda v: v.add("Grid", plane="XX"), "'Plane' is 'XX', expected one of 'XY', 'XZ', 'YZ'"),
    "name": (lambda v: v["Gird"], "No display has the name 'Gird'; the displays are Grid"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_invalid_call_is_an_error_with_the_correct_usage(name: str, graph: Graph) -> None:
    mistake, text = MISTAKES[name]
    viewer = Viewer()
    with pytest.raises(CourseError, match=text):
        mistake(viewer)
    assert len(viewer.displays) == 1


def test_invalid_view_is_rejected_and_the_current_view_is_kept() -> None:
    viewer = Viewer()
    with pytest.raises(
        CourseError, match=r"'TopDownOrtho' is not a view; assign one, like viewer.view = TopDownOrtho\(\)"
    ):
        viewer.view = "TopDownOrtho"  # type: ignore[assignment]
    assert isinstance(viewer.view, Orbit)


def test_view_can_be_replaced_or_changed_by_label(graph: Graph) -> None:
    viewer = Viewer()
    viewer.view = Orbit(distance=3.0, focal_point=(0, 0, 1))
    assert viewer.scene.camera.target == (0.0, 0.0, 1.0)
    viewer.view["Distance"] = 6.0
    assert np.linalg.norm(np.subtract(viewer.camera.eye, viewer.camera.target)) == pytest.approx(6.0)
    viewer.view = TopDownOrtho()
    assert viewer.scene.camera.orthographic_scale == 10.0


def test_viewer_is_created_from_a_layout(graph: Graph, tmp_path: Path) -> None:
    (tmp_path / "view.rviz").write_text(LAYOUT)
    viewer = Viewer.from_rviz(tmp_path / "view.rviz")
    assert [display.name for display in viewer.displays] == ["My grid", "Boxes", "Old", "From ROS 1"]
    assert viewer.fixed_frame == "world"


@pytest.mark.slow
def test_page_and_image_can_be_saved(graph: Graph, tmp_path: Path) -> None:
    viewer = Viewer()
    viewer.save_html(tmp_path / "scene.html")
    assert "<html" in (tmp_path / "scene.html").read_text()[:200].lower()
    picture = viewer.screenshot(tmp_path / "scene.png", size=(80, 60))
    assert (tmp_path / "scene.png").read_bytes() == picture.png
    assert picture.renderer in ("chromium", "numpy")


def test_robot_can_be_drawn_without_messages(graph: Graph) -> None:
    viewer, robot = Viewer(), load_robot("ur10")
    viewer.show_robot(robot)
    links = [path for path in viewer.scene.objects() if "visual" in path and viewer.scene.is_visible(path)]
    assert len(links) == 7
    positions = {"elbow_joint": 1.0}  # [rad]
    viewer.show_robot(robot, positions)
    tip = viewer.scene.world_transform("robots/ur10/wrist_3_link/visual")
    np.testing.assert_allclose(tip, link_poses(robot, positions)["wrist_3_link"])
    with pytest.raises(CourseError, match="'ur10' has no movable joint 'elbow'"):
        viewer.show_robot(robot, {"elbow": 1.0})


@pytest.mark.slow
def test_robot_can_be_drawn_from_a_pinocchio_configuration(graph: Graph) -> None:
    pytest.importorskip("pinocchio")
    viewer, robot = Viewer(), load_robot("ur10")
    viewer.show_robot(robot, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    tip = viewer.scene.world_transform("robots/ur10/wrist_3_link/visual")
    np.testing.assert_allclose(tip, link_poses(robot, {"elbow_joint": 1.0})["wrist_3_link"])
    with pytest.raises(CourseError, match=r"shape \(2,\), expected \(6,\), or a dict"):
        viewer.show_robot(robot, [0.0, 1.0])


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["talos", "solo12", "tiago"])
def test_pinocchio_configuration_places_every_link_as_in_pinocchio(graph: Graph, name: str) -> None:
    pin = pytest.importorskip("pinocchio")
    viewer, robot = Viewer(), load_robot(name)
    model, data = robot.model, robot.model.createData()
    vector = pin.integrate(model, robot.q0, np.random.default_rng(0).uniform(-0.5, 0.5, model.nv))
    pin.framesForwardKinematics(model, data, vector)
    viewer.show_robot(robot, vector)
    drawn = [path for path in viewer.scene.objects() if path.startswith(f"robots/{name}/")]
    assert len(drawn) > 8
    for path in drawn:
        frame = model.getFrameId(path.split("/")[2], pin.FrameType.BODY)
        link = viewer.scene.world_transform("/".join(path.split("/")[:4]))
        np.testing.assert_allclose(link, data.oMf[frame].homogeneous, atol=1e-12)


@pytest.mark.slow
def test_links_missing_in_the_pinocchio_model_move_with_the_root(graph: Graph) -> None:
    pytest.importorskip("pinocchio")
    viewer, robot = Viewer(), load_robot("talos_legs")  # a model without the body above the legs
    viewer.show_robot(robot)
    base, torso = (f"robots/talos_legs/{name}/visual" for name in ("base_link", "torso_2_link"))
    before = viewer.scene.world_transform(torso) - viewer.scene.world_transform(base)
    vector = robot.q0.copy()
    vector[:3] += 1.0  # [m]
    viewer.show_robot(robot, vector)
    after = viewer.scene.world_transform(torso) - viewer.scene.world_transform(base)
    np.testing.assert_allclose(after, before, atol=1e-12)


@pytest.mark.slow
def test_free_flyer_is_placed_by_the_configuration(graph: Graph) -> None:
    pytest.importorskip("pinocchio")
    viewer, robot = Viewer(), load_robot("solo12")
    vector = robot.q0.copy()
    vector[:7] = [1.0, 2.0, 3.0, 0.0, 0.0, 2.0, 0.0]  # [m], and half a turn about z, not of length 1
    viewer.show_robot(robot, vector)
    base = viewer.scene.world_transform("robots/solo12/base_link/visual")
    expected = np.diag([-1.0, -1.0, 1.0, 1.0])
    expected[:3, 3] = 1.0, 2.0, 3.0
    np.testing.assert_allclose(base, expected, atol=1e-12)
    with pytest.raises(CourseError, match="expected finite numbers"):
        viewer.show_robot(robot, vector * np.nan)


def test_robot_in_its_rest_pose_stands_on_its_feet(graph: Graph) -> None:
    viewer = Viewer()
    viewer.show_robot(load_robot("talos"))
    feet = [
        viewer.scene.world_transform(f"robots/talos/leg_{side}_6_link/visual") for side in ("left", "right")
    ]
    assert [round(float(foot[2, 3]), 2) for foot in feet] == [0.11, 0.11]  # [m] the ankle's height


def test_shown_robot_follows_a_frame_and_is_hidden_while_its_frame_is_unknown(graph: Graph) -> None:
    viewer = Viewer(fixed_frame="map")
    viewer.show_robot(simple_painter(), frame="base_link", at=(0.0, 0.0, 0.5))
    path = "robots/painter"
    assert not viewer.scene.is_visible(path)
    message = TransformStamped(child_frame_id="base_link")
    message.header.frame_id, message.transform.translation.x = "map", 2.0
    message.transform.rotation.w = 1.0
    publish(graph, "/tf_static", TFMessage(transforms=[message]), LATCHED)
    viewer.refresh()
    assert viewer.scene.is_visible(path)
    assert viewer.scene.world_transform(path)[:3, 3].tolist() == [2.0, 0.0, 0.5]


def test_shown_robot_without_a_frame_stands_in_the_fixed_frame(graph: Graph) -> None:
    viewer = Viewer(fixed_frame="odom")
    viewer.show_robot(simple_painter(), at=(-2.5, 0.0, 0.0))
    assert viewer.scene.world_transform("robots/painter/base_link")[:3, 3].tolist() == [-2.5, 0.0, 0.0]


def test_shown_robot_has_the_requested_alpha(graph: Graph) -> None:
    viewer = Viewer()
    viewer.show_robot(simple_painter(), alpha=0.5)
    solids = [one for one in viewer.scene.objects().values() if isinstance(one, Solids)]
    assert {round(float(alpha), 2) for one in solids for alpha in np.atleast_2d(one.colors)[:, 3]} == {0.5}
    with pytest.raises(CourseError, match="alpha is 50, expected a number from"):
        viewer.show_robot(simple_painter(), alpha=50)


def test_shown_robot_that_does_not_move_changes_nothing_in_later_frames(graph: Graph) -> None:
    viewer = Viewer()
    viewer.show_robot(simple_painter(), at=(-2.5, 0.0, 0.0))
    scene, changes = viewer.scene, list[tuple[str, str]]()
    scene.listen(lambda kind, path: changes.append((kind, path)))
    for _ in range(3):
        viewer.session.refresh()
        viewer.session.update(graph.now_ns)
    assert changes == []


def test_statuses_are_returned_as_a_table(graph: Graph) -> None:
    statuses = Viewer().statuses()
    assert isinstance(statuses, StatusTable)
    assert statuses[0] == ("Global Status", "Fixed Frame", "warn", statuses[0].text)


def test_meshcat_code_draws_into_the_viewer_and_can_move_its_camera(graph: Graph) -> None:
    viewer = Viewer()
    viewer.refresh()
    viewer.meshcat["box"].set_object(meshcat.geometry.Box([1, 1, 1]))
    viewer.meshcat.set_cam_pos([1.0, 2.0, 3.0])
    viewer.refresh()
    assert "meshcat/box" in viewer.scene.objects()
    assert viewer.scene.camera.eye == (1.0, 2.0, 3.0)
    viewer.view["Distance"] = 4.0
    viewer.refresh()
    assert viewer.scene.camera.eye != (1.0, 2.0, 3.0)


def test_saved_page_plays_back_the_recording(graph: Graph, tmp_path: Path) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    graph.call_at(graph.now_ns + 10**9, lambda: publish(graph, "/m", marker()), node=1, entity=0)
    while graph.advance():
        pass
    still, recording = tmp_path / "still.html", tmp_path / "recording.html"
    viewer.save_html(still)
    viewer.save_html(recording, playback=True)
    assert still.stat().st_size < recording.stat().st_size < 350_000


def test_saving_prints_the_path_and_how_to_open_it(
    graph: Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    viewer = Viewer()
    viewer.save_html("my_files/page.html", playback=True)
    begin, end = capsys.readouterr().out.splitlines()
    assert begin == "Saving the view …"
    assert end.startswith("Saved my_files/page.html (0.")
    assert "any browser" in end
    assert "<b>Trust HTML</b>" in Path("my_files/page.html").read_text("utf-8").partition("<script")[0]
    viewer.save_rviz("mine.rviz")
    assert capsys.readouterr().out == "", "reports of checks would show it"
    viewer.screenshot("mine.png")
    monkeypatch.setattr("course_lib.displays.viewer.in_notebook", lambda: True)
    viewer.save_rviz("mine.rviz")
    assert capsys.readouterr().out.splitlines() == [
        "Saved mine.png.",
        "Saved mine.rviz. The real RViz2 opens it with: rviz2 -d mine.rviz",
    ]


@pytest.mark.parametrize(
    ("method", "subject"), [("save_html", "page"), ("save_rviz", "layout"), ("screenshot", "picture")]
)
def test_file_that_cannot_be_written_is_reported(
    graph: Graph, tmp_path: Path, method: str, subject: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.viewer.renderer.find_browser", lambda: None)
    with pytest.raises(CourseError, match=rf"Cannot write the {subject} .*: Is a directory\."):
        getattr(Viewer(), method)(tmp_path)


def test_viewer_output_is_equal_in_every_run(graph: Graph) -> None:
    assert repr(Viewer()) == "<Viewer of map with Grid>"


def test_look_is_saved_in_the_layout_and_the_default_look_of_rviz_is_not(
    graph: Graph, tmp_path: Path
) -> None:
    viewer, path = Viewer(), tmp_path / "mine.rviz"
    viewer.save_rviz(path)
    plain = path.read_text()
    viewer.options["Look"] = "Studio"
    viewer.save_rviz(path)
    assert path.read_text().replace("    Look: Studio\n", "") == plain
    reloaded = Viewer.from_rviz(path)
    assert (reloaded.options["Look"], reloaded.scene.look) == ("Studio", "Studio")
    reloaded.options["Look"] = "RViz"
    reloaded.save_rviz(path)
    assert path.read_text() == plain
    with pytest.raises(CourseError, match="'Look' is 'studio', expected one of 'RViz', 'Studio'"):
        viewer.options["Look"] = "studio"


def test_look_is_kept_in_recordings_and_copies(graph: Graph) -> None:
    viewer = Viewer()
    viewer.options["Look"] = "Studio"
    viewer.refresh()
    assert viewer.scene_recording.scene.look == "Studio"
    assert encoding.scene_batch(viewer.scene_recording.scene)["commands"][0]["look"] == "Studio"


def test_options_and_tools_are_set_by_their_rviz_labels(graph: Graph, tmp_path: Path) -> None:
    viewer = Viewer()
    viewer.options["Frame Rate"] = 10
    viewer.options["Background Color"] = "#ffffff"
    viewer.tool("2D Goal Pose")["Topic"] = "/my_goal"
    viewer.save_rviz(tmp_path / "mine.rviz")
    reloaded = Viewer.from_rviz(tmp_path / "mine.rviz")
    assert (reloaded.options["Frame Rate"], reloaded.scene.background) == (10, (255, 255, 255))
    assert reloaded.tool("2D Goal Pose")["Topic"] == "/my_goal"
    with pytest.raises(
        CourseError, match="No tool has the label 'Goal'; the tools are Interact, Move Camera"
    ):
        viewer.tool("Goal")
    with pytest.raises(CourseError, match="has no property 'Frame Rat'; it has 'Frame Rate'"):
        viewer.options["Frame Rat"] = 5


def test_display_with_a_name_that_is_not_a_string_is_rejected(graph: Graph) -> None:
    with pytest.raises(CourseError, match=r"^name is 5, expected the display's name, a string$"):
        Viewer().add("Marker", "/people", name=cast("Any", 5))


def test_displays_are_added_to_groups(graph: Graph, tmp_path: Path) -> None:
    viewer = Viewer()
    boxes, names = viewer.add("Marker", group="Seen"), viewer.add("TF", group="Seen")
    viewer.save_rviz(tmp_path / "mine.rviz")
    reloaded = Viewer.from_rviz(tmp_path / "mine.rviz")
    (group,) = (member for member in reloaded.session.tree.members if isinstance(member, Group))
    assert (group.name, [display.name for display in group.displays()]) == ("Seen", [boxes.name, names.name])
