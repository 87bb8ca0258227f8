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
from course_lib.robots.robot import load_robot
from course_lib.ros.graph import Graph
from tests.displays.bench import marker
from tests.displays.stage import LATCHED, publish, shown
from tests.displays.test_layout import LAYOUT


def test_a_fixed_frame_without_its_quotes_is_refused_before_anything_waits_for_it(graph: Graph) -> None:
    viewer, no_name = Viewer(), cast(Any, map)
    for refused in (lambda: Viewer(fixed_frame=no_name), lambda: setattr(viewer, "fixed_frame", no_name)):
        with pytest.raises(CourseError, match=r'the fixed frame map is not text\. .* fixed_frame="map"'):
            refused()
    publish(graph, "/markers", marker())
    assert viewer.fixed_frame == "map"


def test_a_new_viewer_shows_a_grid_in_its_fixed_frame(graph: Graph) -> None:
    viewer = Viewer(fixed_frame="odom")
    assert [display.name for display in viewer.displays] == ["Grid"]
    assert viewer.fixed_frame == "odom"
    assert shown(viewer) == {"Grid"}


def test_a_display_shows_what_is_published(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    publish(graph, "/m", marker())
    assert shown(viewer) == {"Grid", "Marker"}
    assert ("Marker", "Topic", "ok", "1 messages received at inf hz.") in viewer.statuses()


def test_a_late_display_gets_what_publishers_hold_only_if_it_asks_for_it(graph: Graph) -> None:
    publish(graph, "/m", marker(), LATCHED)
    viewer = Viewer()
    display = viewer.add("Marker", topic="/m")
    assert shown(viewer) == {"Grid"}
    assert "ask for it with Durability Policy: Transient Local" in str(viewer.statuses())
    display["Durability Policy"] = "Transient Local"
    assert shown(viewer) == {"Grid", "Marker"}
    assert "Transient Local" not in str(viewer.statuses())


def test_a_late_viewer_hears_static_transforms(graph: Graph) -> None:
    transform = TransformStamped(child_frame_id="base")
    transform.header.frame_id = "map"
    publish(graph, "/tf_static", TFMessage(transforms=[transform]), LATCHED)
    assert ("Global Status", "Fixed Frame", "ok", "OK") in Viewer().statuses()


def test_markers_expire_as_robot_time_goes_by(graph: Graph) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    fading = marker()
    fading.lifetime.sec = 1
    publish(graph, "/m", fading)
    assert shown(viewer) == {"Grid", "Marker"}
    graph.call_at(graph.now_ns + 2 * 10**9, lambda: None, node=1, entity=0)
    graph.advance()
    assert "displays/Marker/n/0/body" not in viewer.scene.objects()


def test_properties_go_by_rviz_labels_or_python_names_and_show_at_once(graph: Graph) -> None:
    viewer = Viewer()
    grid = viewer["Grid"]
    before = viewer.scene.objects()["displays/Grid/drawing"]
    grid["Cell Size"] = 0.5
    assert viewer.scene.objects()["displays/Grid/drawing"] is not before
    labels: dict[str, Any] = {"Plane Cell Count": 4}
    viewer.add("Grid", name="Big", cell_size=2, **labels)
    assert (viewer["Big"]["Cell Size"], viewer["Big"]["Plane Cell Count"]) == (2.0, 4)


def test_remove_takes_a_display_away_with_what_it_drew(graph: Graph) -> None:
    viewer = Viewer()
    grid = viewer["Grid"]
    viewer.remove(grid)
    assert viewer.displays == []
    assert viewer.scene.objects() == {}
    with pytest.raises(CourseError, match="is not in this viewer"):
        viewer.remove(grid)


MISTAKES: dict[str, tuple[Callable[[Viewer], Any], str]] = {
    "class": (lambda v: v.add("Markr"), "no display 'Markr' here; add one of Marker, MarkerArray"),
    "property": (lambda v: v.add("Marker", topc="/m"), "has no property 'topc', but 'Topic'"),
    "value": (lambda v: v.add("Grid", plane="XX"), "'Plane' is 'XX', expected one of 'XY', 'XZ', 'YZ'"),
    "name": (lambda v: v["Gird"], "No display is called 'Gird'; there is Grid"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_answered_with_what_would_be_right(name: str, graph: Graph) -> None:
    mistake, text = MISTAKES[name]
    viewer = Viewer()
    with pytest.raises(CourseError, match=text):
        mistake(viewer)
    assert len(viewer.displays) == 1


def test_what_is_no_view_is_refused_and_the_old_one_stays() -> None:
    viewer = Viewer()
    with pytest.raises(
        CourseError, match=r"'TopDownOrtho' is not a view; write one like viewer.view = Orbit\(\)"
    ):
        viewer.view = "TopDownOrtho"  # type: ignore[assignment]
    assert isinstance(viewer.view, Orbit)


def test_the_view_may_be_replaced_or_changed_by_label(graph: Graph) -> None:
    viewer = Viewer()
    viewer.view = Orbit(distance=3.0, focal_point=(0, 0, 1))
    assert viewer.scene.camera.target == (0.0, 0.0, 1.0)
    viewer.view["Distance"] = 6.0
    assert np.linalg.norm(np.subtract(viewer.camera.eye, viewer.camera.target)) == pytest.approx(6.0)
    viewer.view = TopDownOrtho()
    assert viewer.scene.camera.orthographic_scale == 10.0


def test_a_layout_makes_a_viewer(graph: Graph, tmp_path: Path) -> None:
    (tmp_path / "view.rviz").write_text(LAYOUT)
    viewer = Viewer.from_rviz(tmp_path / "view.rviz")
    assert [display.name for display in viewer.displays] == ["My grid", "Boxes", "Old", "From ROS 1"]
    assert viewer.fixed_frame == "world"


def test_a_page_and_a_picture_can_be_saved(graph: Graph, tmp_path: Path) -> None:
    viewer = Viewer()
    viewer.save_html(tmp_path / "scene.html")
    assert "<html" in (tmp_path / "scene.html").read_text()[:200].lower()
    picture = viewer.screenshot(tmp_path / "scene.png", size=(80, 60))
    assert (tmp_path / "scene.png").read_bytes() == picture.png
    assert picture.renderer in ("chromium", "numpy")


def test_a_robot_can_be_drawn_without_messages(graph: Graph) -> None:
    viewer, robot = Viewer(), load_robot("ur10")
    viewer.show_robot(robot)
    links = [path for path in viewer.scene.objects() if "visual" in path and viewer.scene.visible(path)]
    assert len(links) == 7
    positions = {"elbow_joint": 1.0}  # [rad]
    viewer.show_robot(robot, positions)
    tip = viewer.scene.world_transform("robots/ur10/wrist_3_link/visual")
    np.testing.assert_allclose(tip, link_poses(robot, positions)["wrist_3_link"])
    with pytest.raises(CourseError, match="'ur10' has no joint 'elbow' that moves"):
        viewer.show_robot(robot, {"elbow": 1.0})


def test_a_robot_can_be_drawn_by_pinocchios_vector(graph: Graph) -> None:
    pytest.importorskip("pinocchio")
    viewer, robot = Viewer(), load_robot("ur10")
    viewer.show_robot(robot, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    tip = viewer.scene.world_transform("robots/ur10/wrist_3_link/visual")
    np.testing.assert_allclose(tip, link_poses(robot, {"elbow_joint": 1.0})["wrist_3_link"])
    with pytest.raises(CourseError, match=r"shape \(2,\), expected \(6,\), or a dict"):
        viewer.show_robot(robot, [0.0, 1.0])


@pytest.mark.parametrize("name", ["talos", "solo12", "tiago"])
def test_pinocchios_vector_places_every_link_where_pinocchio_has_it(graph: Graph, name: str) -> None:
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


def test_links_that_pinocchios_model_lacks_go_along_with_the_root(graph: Graph) -> None:
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


def test_a_free_flyer_stands_where_the_vector_says(graph: Graph) -> None:
    pytest.importorskip("pinocchio")
    viewer, robot = Viewer(), load_robot("solo12")
    vector = robot.q0.copy()
    vector[:7] = [1.0, 2.0, 3.0, 0.0, 0.0, 2.0, 0.0]  # [m], and half a turn about z, not of length 1
    viewer.show_robot(robot, vector)
    base = viewer.scene.world_transform("robots/solo12/base_link/visual")
    expected = np.diag([-1.0, -1.0, 1.0, 1.0])
    expected[:3, 3] = 1.0, 2.0, 3.0
    np.testing.assert_allclose(base, expected, atol=1e-12)
    with pytest.raises(CourseError, match="has numbers that are not finite"):
        viewer.show_robot(robot, vector * np.nan)


def test_a_robot_at_rest_stands_on_its_feet(graph: Graph) -> None:
    viewer = Viewer()
    viewer.show_robot(load_robot("talos"))
    feet = [
        viewer.scene.world_transform(f"robots/talos/leg_{side}_6_link/visual") for side in ("left", "right")
    ]
    assert [round(float(foot[2, 3]), 2) for foot in feet] == [0.11, 0.11]  # [m] the ankle's height


def test_statuses_are_a_table(graph: Graph) -> None:
    statuses = Viewer().statuses()
    assert isinstance(statuses, StatusTable)
    assert statuses[0] == ("Global Status", "Fixed Frame", "warn", statuses[0].text)


def test_code_for_meshcat_draws_into_the_viewer_and_may_move_its_camera(graph: Graph) -> None:
    viewer = Viewer()
    viewer.look()
    viewer.meshcat["box"].set_object(meshcat.geometry.Box([1, 1, 1]))
    viewer.meshcat.set_cam_pos([1.0, 2.0, 3.0])
    viewer.look()
    assert "meshcat/box" in viewer.scene.objects()
    assert viewer.scene.camera.eye == (1.0, 2.0, 3.0)
    viewer.view["Distance"] = 4.0
    viewer.look()
    assert viewer.scene.camera.eye != (1.0, 2.0, 3.0)


def test_a_saved_page_plays_what_was_seen(graph: Graph, tmp_path: Path) -> None:
    viewer = Viewer()
    viewer.add("Marker", topic="/m")
    graph.call_at(graph.now_ns + 10**9, lambda: publish(graph, "/m", marker()), node=1, entity=0)
    while graph.advance():
        pass
    still, film = tmp_path / "still.html", tmp_path / "film.html"
    viewer.save_html(still)
    viewer.save_html(film, playback=True)
    assert still.stat().st_size < film.stat().st_size < 350_000


def test_it_prints_alike_in_every_run(graph: Graph) -> None:
    assert repr(Viewer()) == "<Viewer of map with Grid>"


def test_options_and_tools_are_set_by_rviz_s_labels(graph: Graph, tmp_path: Path) -> None:
    viewer = Viewer()
    viewer.options["Frame Rate"] = 10
    viewer.options["Background Color"] = "#ffffff"
    viewer.tool("2D Goal Pose")["Topic"] = "/my_goal"
    viewer.save_rviz(tmp_path / "mine.rviz")
    again = Viewer.from_rviz(tmp_path / "mine.rviz")
    assert (again.options["Frame Rate"], again.scene.background) == (10, (255, 255, 255))
    assert again.tool("2D Goal Pose")["Topic"] == "/my_goal"
    with pytest.raises(CourseError, match="No tool is called 'Goal'; there is Interact, Move Camera"):
        viewer.tool("Goal")
    with pytest.raises(CourseError, match="has no property 'Frame Rat', but 'Frame Rate'"):
        viewer.options["Frame Rat"] = 5


def test_displays_are_added_to_groups(graph: Graph, tmp_path: Path) -> None:
    viewer = Viewer()
    boxes, names = viewer.add("Marker", group="Seen"), viewer.add("TF", group="Seen")
    viewer.save_rviz(tmp_path / "mine.rviz")
    again = Viewer.from_rviz(tmp_path / "mine.rviz")
    (group,) = (member for member in again.session.tree.members if isinstance(member, Group))
    assert (group.name, [display.name for display in group.displays()]) == ("Seen", [boxes.name, names.name])
