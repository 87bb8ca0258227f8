"""What RViz's RobotModel says and shows (robot_model_display.cpp, robot.cpp, tf_link_updater.cpp)."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from std_msgs.msg import String

from course_lib.displays.display import Display
from course_lib.errors import CourseError
from course_lib.robots.kinematics import link_poses
from course_lib.robots.links import links_of
from course_lib.robots.load import load_robot
from course_lib.ros.qos import Qos
from course_lib.viewer.drawables import Drawable, Lines, Mesh, Solids
from tests.displays.bench import START_NS, Bench

ROBOT = "rviz_default_plugins/RobotModel"
LATCHED = Qos(depth=1, durability="transient_local")
ARM = """<robot name="r">
  <material name="blue"><color rgba="0 0 1 0.5"/></material>
  <link name="base">
    <visual><geometry><box size="1 2 3"/></geometry><material name="blue"/></visual>
    <collision><geometry><sphere radius="1"/></geometry></collision>
    <inertial><mass value="11340"/><inertia ixx="1" iyy="1" izz="1"/></inertial>
  </link>
  <link name="arm"><visual><origin xyz="0 0 1"/><geometry>{arm}</geometry></visual></link>
  <link name="tool"/>
  <joint name="j" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="k" type="fixed"><parent link="arm"/><child link="tool"/></joint>
</robot>"""
CYLINDER = '<cylinder radius="0.5" length="2"/>'
MISSING = '<mesh filename="package://nobody/arm.stl"/>'


def robot(bench: Bench, arm: str = CYLINDER, **properties: Any) -> Display:
    topic = {"Description Topic": {"Value": "/robot_description"}}
    display = bench.session.add(ROBOT, "Robot", topic, **properties)
    bench.hear("/robot_description", String(data=ARM.format(arm=arm)), qos=LATCHED)
    bench.look()
    return display


def standing(bench: Bench, **properties: Any) -> Display:
    """Return a robot whose links are known."""
    for child in ("base", "arm", "tool"):
        bench.transform("map", child, (1.0, 0.0, 0.0))
    return robot(bench, **properties)


def drawn(bench: Bench) -> dict[str, Drawable]:
    """Return what is to be seen of the robot, by link/kind/number."""
    start = "displays/Robot/links/"
    objects = bench.scene.objects().items()
    return {path.removeprefix(start): thing for path, thing in objects if bench.scene.visible(path)}


def test_links_are_drawn_where_tf_has_them() -> None:
    bench = Bench()
    display = standing(bench)
    box, tube = drawn(bench)["base/visual/0"], drawn(bench)["arm/visual/0"]
    assert isinstance(box, Solids)
    assert isinstance(tube, Solids)
    assert (box.shape, tube.shape) == ("box", "cylinder")
    np.testing.assert_array_equal(np.diag(box.placements[0]), [1, 2, 3, 1])
    np.testing.assert_array_equal(np.diag(tube.placements[0]), [1, 1, 2, 1])
    where = bench.scene.world_transform("displays/Robot/links/arm/visual/0")
    np.testing.assert_allclose(where[:3, 3], [1, 0, 1])
    assert bench.said(display, "URDF") == ("ok", "URDF parsed OK")
    assert bench.said(display, "arm") == ("ok", "Transform OK")


def test_the_first_material_of_a_link_paints_it_and_what_has_none_is_red() -> None:
    bench = Bench()
    standing(bench)
    box, tube = drawn(bench)["base/visual/0"], drawn(bench)["arm/visual/0"]
    assert isinstance(box, Solids)
    assert isinstance(tube, Solids)
    np.testing.assert_allclose(box.colors, [0, 0, 1, 0.5])
    np.testing.assert_allclose(tube.colors, [1, 0, 0, 1])


def test_alphas_of_robot_link_and_material_multiply() -> None:
    bench = Bench()
    display = standing(bench, Alpha=0.5)
    display["Links/base/Alpha"] = 0.5
    bench.look()
    box = drawn(bench)["base/visual/0"]
    assert isinstance(box, Solids)
    assert box.colors[3] == pytest.approx(0.5**3)


def test_a_link_without_a_transform_is_white_unshaded_and_an_error() -> None:
    bench = Bench()
    bench.transform("map", "base")
    display = robot(bench)
    tube = drawn(bench)["arm/visual/0"]
    assert isinstance(tube, Solids)
    np.testing.assert_array_equal(tube.colors, np.ones(4))
    assert not tube.lit
    assert bench.said(display, "arm") == ("error", "No transform from [arm] to [map]")
    bench.transform("base", "arm", (0.0, 3.0, 0.0))
    bench.look()
    again = drawn(bench)["arm/visual/0"]
    assert isinstance(again, Solids)
    assert again.lit
    assert bench.said(display, "arm") == ("ok", "Transform OK")


def test_a_latched_description_arrives_although_the_property_says_volatile() -> None:
    display = Bench().session.add(ROBOT, "Robot", {"Description Topic": "/robot_description"})
    assert display["Description Topic/Durability Policy"] == "Volatile"
    assert display.subscriptions[0].qos == LATCHED
    display["Description Topic/Depth"] = 7
    assert display.subscriptions[0].qos == Qos(depth=7)


@pytest.mark.parametrize("text", ["", "hello", "<robot", "<robot name='r'/>", "<html><body/></html>"])
def test_what_is_no_robot_is_an_error_in_rviz_words_with_the_reason_as_a_hint(text: str) -> None:
    bench = Bench()
    display = standing(bench)
    bench.hear("/robot_description", String(data=text), qos=LATCHED)
    bench.look()
    assert bench.said(display, "URDF") == ("error", "URDF failed Model parse")
    assert bench.hints(display)
    assert not drawn(bench)
    assert [prop.label for prop in display.properties if prop.path[:2] == ("Links", "arm")] == []


def test_a_missing_mesh_is_an_error_and_all_else_is_shown() -> None:
    bench = Bench()
    bench.transform("map", "base")
    bench.transform("map", "arm")
    display = robot(bench, MISSING)
    text = (
        "Errors loading geometries:\n"
        "• for link 'arm':\nCould not load mesh resource 'package://nobody/arm.stl'"
    )
    assert bench.said(display, "URDF") == ("error", text)
    assert bench.said(display, "arm") == ("ok", "Transform OK")
    assert list(drawn(bench)) == ["base/visual/0"]


def test_a_file_that_is_no_mesh_is_the_same_error(tmp_path: Path) -> None:
    (tmp_path / "arm.stl").write_text("not a mesh")
    bench = Bench()
    display = robot(bench, f'<mesh filename="file://{tmp_path}/arm.stl"/>')
    assert bench.said(display, "URDF") == (
        "error",
        f"Errors loading geometries:\n• for link 'arm':\nCould not load mesh resource 'file://{tmp_path}/arm.stl'",
    )


def test_stl_takes_the_links_color_and_other_formats_have_their_own(tmp_path: Path) -> None:
    obj = "mtllib m.mtl\nusemtl green\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    (tmp_path / "arm.obj").write_text(obj)
    (tmp_path / "m.mtl").write_text("newmtl green\nKd 0 1 0\n")
    corners = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0"
    stl = f"solid s\nfacet normal 0 0 1\nouter loop\n{corners}\nendloop\nendfacet\nendsolid\n"
    (tmp_path / "arm.stl").write_text(stl)
    for suffix, color in (("stl", [1, 0, 0, 1]), ("obj", [0, 1, 0, 1])):
        bench = Bench()
        bench.transform("map", "arm")
        robot(bench, f'<mesh filename="file://{tmp_path}/arm.{suffix}" scale="2 2 2"/>')
        mesh = drawn(bench)["arm/visual/0"]
        assert isinstance(mesh, Mesh)
        np.testing.assert_allclose(np.broadcast_to(mesh.colors, (3, 4)), [color] * 3, atol=0.01)
        where = bench.scene.world_transform("displays/Robot/links/arm/visual/0")
        np.testing.assert_allclose(np.diag(where), [2, 2, 2, 1])


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        ("Collision Enabled", "base/collision/0"),
        ("Mass", "base/mass/mass"),
        ("Inertia", "base/inertia/inertia"),
        ("Links/tool/Show Axes", "tool/axes/axes"),
    ],
)
def test_a_switch_shows_more_and_hides_it_again(label: str, expected: str) -> None:
    bench = Bench()
    display = standing(bench)
    before = drawn(bench).keys()
    display[label] = True
    assert drawn(bench).keys() - before == {expected}
    node = "displays/Robot/links/" + expected.rpartition("/")[0]
    np.testing.assert_array_equal(bench.scene.transform(node)[:3, 3], [1, 0, 0])
    display[label] = False
    assert drawn(bench).keys() == before


def test_a_mass_is_a_ball_of_lead() -> None:
    bench = Bench()
    standing(bench, Mass=True)
    ball = drawn(bench)["base/mass/mass"]
    assert isinstance(ball, Solids)
    radius = ball.placements[0, 0, 0] / 2
    assert 4 / 3 * np.pi * radius**3 * 11340 == pytest.approx(11340)


def test_links_are_hidden_one_by_one_and_all_at_once() -> None:
    bench = Bench()
    display = standing(bench)
    display["Links/base"] = False
    assert list(drawn(bench)) == ["arm/visual/0"]
    assert display["All Links Enabled"] is False
    display["All Links Enabled"] = True
    assert len(drawn(bench)) == 2
    display["Visual Enabled"] = False
    assert not drawn(bench)


def test_a_layout_keeps_what_it_says_of_links_until_they_are_known() -> None:
    bench = Bench()
    for child in ("base", "arm"):
        bench.transform("map", child)
    links = {"base": {"Value": False}, "arm": {"Alpha": 0.25}}
    config = {"Description Topic": {"Value": "/robot_description"}, "Links": links}
    display = bench.session.add(ROBOT, "Robot", config)
    bench.hear("/robot_description", String(data=ARM.format(arm=CYLINDER)), qos=LATCHED)
    bench.look()
    assert display["Links/arm/Alpha"] == 0.25
    assert list(drawn(bench)) == ["arm/visual/0"]


def test_a_link_without_shapes_cannot_be_ticked() -> None:
    display = robot(Bench())
    with pytest.raises(CourseError, match="no property 'Links/tool'"):
        display["Links/tool"] = False


def test_a_trail_follows_two_metres_of_the_way() -> None:
    bench = Bench()
    bench.transform("map", "base", at=0.0, static=False)
    display = robot(bench)
    display["Links/base/Show Trail"] = True
    for step in range(1, 301):
        bench.transform("map", "base", (0.05 * step, 0.0, 0.0), at=step / 100, static=False)
        bench.look(step / 100)
    trail = drawn(bench)["base/trail"]
    assert isinstance(trail, Lines)
    assert trail.points[-1, 0] == pytest.approx(15.0, abs=0.02)
    assert 1.9 < np.ptp(trail.points[:, 0]) <= 2.0


def test_a_prefix_stands_before_the_frames_so_that_robots_can_be_many() -> None:
    bench = Bench()
    bench.transform("map", "left/base")
    bench.transform("map", "right/base", (0.0, 5.0, 0.0))
    left, right = robot(bench, tf_prefix="left"), robot(bench, tf_prefix="right")
    assert bench.said(left, "left/base") == ("ok", "Transform OK")
    assert bench.said(right, "right/arm") == ("error", "No transform from [right/arm] to [map]")
    where = bench.scene.world_transform("displays/Robot 2/links/base/visual/0")
    np.testing.assert_array_equal(where[:3, 3], [0, 5, 0])
    left["TF Prefix"] = "right"
    assert bench.said(left, "left/base") is None


def test_a_description_may_come_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    bench = Bench()
    bench.transform("map", "base")
    config = {"Description Source": "File", "Description File": str(file)}
    display = bench.session.add(ROBOT, "Robot", config)
    assert bench.said(display, "URDF") == ("error", "URDF is empty")
    assert not display.subscriptions
    file.write_text(ARM.format(arm=CYLINDER))
    display["Enabled"] = False
    display["Enabled"] = True
    assert bench.said(display, "URDF") == ("ok", "URDF parsed OK")
    assert "base/visual/0" in drawn(bench)


def test_links_are_placed_once_per_update_interval() -> None:
    bench = Bench()
    bench.transform("map", "base", static=False)
    robot(bench, update_interval=1.0)
    node = "displays/Robot/links/base/visual"
    for at, x in ((0.5, 0.0), (1.5, 2.0)):
        bench.transform("map", "base", (2.0, 0.0, 0.0), at=at, static=False)
        bench.session.update(START_NS + int(at * 1e9))
        assert bench.scene.transform(node)[0, 3] == x


def test_another_fixed_frame_keeps_the_robot() -> None:
    bench = Bench()
    display = standing(bench)
    bench.session.fixed_frame = "base"
    assert "arm/visual/0" in drawn(bench)
    assert bench.said(display, "arm") == ("ok", "Transform OK")


def test_frames_without_news_tell_the_page_nothing() -> None:
    bench = Bench()
    standing(bench)
    bench.look(0.1)
    told: list[tuple[str, str]] = []
    bench.scene.listen(lambda what, path: told.append((what, path)))
    bench.look(0.2)
    assert told == []


def test_a_robot_that_is_not_ticked_leaves_nothing() -> None:
    bench = Bench()
    display = standing(bench)
    display["Enabled"] = False
    assert not drawn(bench)
    assert not display.rows()


def test_a_loop_in_tf_is_an_error_of_the_links_in_it() -> None:
    bench = Bench()
    bench.transform("arm", "base", at=0.1, static=False)
    bench.transform("base", "arm", at=0.1, static=False)
    display = robot(bench)
    assert bench.said(display, "base") == ("error", "No transform from [base] to [map]")


def known_robots() -> list[str]:
    example_robot_data = pytest.importorskip("example_robot_data")
    return sorted(example_robot_data.ROBOTS.keys() - {"cassie"})  # which is no URDF


@pytest.mark.slow
def test_all_robots_that_can_be_loaded_are_drawn_without_an_error() -> None:
    blank = {"simple_humanoid", "simple_humanoid_classical"}  # have no visuals
    for name in known_robots():
        loaded = load_robot(name)
        bench = Bench(loaded.tree.root)
        for link in link_poses(loaded):
            if link != loaded.tree.root:
                bench.transform(loaded.tree.root, link)
        topic = {"Description Topic": {"Value": "/robot_description"}}
        display = bench.session.add(ROBOT, "Robot", topic)
        bench.hear("/robot_description", String(data=loaded.urdf), qos=LATCHED)
        bench.look()
        assert {row.level for row in display.rows()} == {"ok"}, name
        visuals = [part for part in drawn(bench) if "/visual/" in part]
        assert len(visuals) == sum(len(link.visuals) for link in links_of(loaded.urdf)), name
        assert bool(visuals) == (name not in blank), name


def test_a_transform_that_is_no_number_leaves_the_link_where_it_was_and_is_named() -> None:
    bench = Bench()
    display = standing(bench)
    bench.transform("map", "base", (float("nan"), 0.0, 0.0), at=0.1)
    bench.look(0.1)
    node = "displays/Robot/links/base/visual"
    np.testing.assert_array_equal(bench.scene.transform(node)[:3, 3], [1, 0, 0])
    assert bench.said(display, "base") == ("ok", "Transform OK")
    hints = [row.text for row in bench.session.rows() if row.level == "hint"]
    assert any("nan" in text and "base" in text for text in hints)
