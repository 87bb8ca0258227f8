"""Links of RViz's RobotModel (robot_link.cpp, robot.cpp)."""

from pathlib import Path

import numpy as np
import pytest

from course_lib.errors import CourseError
from course_lib.viewer.drawables import Lines, Mesh, Solids
from tests.displays.bench import Bench
from tests.displays.robot_model.robots import robot, standing, visible_drawables


def test_links_are_drawn_at_their_tf_frames() -> None:
    bench = Bench()
    display = standing(bench)
    box, tube = visible_drawables(bench)["base/visual/0"], visible_drawables(bench)["arm/visual/0"]
    assert isinstance(box, Solids)
    assert isinstance(tube, Solids)
    assert (box.shape, tube.shape) == ("box", "cylinder")
    np.testing.assert_array_equal(np.diag(box.placements[0]), [1, 2, 3, 1])
    np.testing.assert_array_equal(np.diag(tube.placements[0]), [1, 1, 2, 1])
    where = bench.scene.world_transform("displays/Robot/links/arm/visual/0")
    np.testing.assert_allclose(where[:3, 3], [1, 0, 1])
    assert bench.status(display, "URDF") == ("ok", "URDF parsed OK")
    assert bench.status(display, "arm") == ("ok", "Transform OK")


def test_first_material_colors_the_link_and_a_link_without_material_is_red() -> None:
    bench = Bench()
    standing(bench)
    box, tube = visible_drawables(bench)["base/visual/0"], visible_drawables(bench)["arm/visual/0"]
    assert isinstance(box, Solids)
    assert isinstance(tube, Solids)
    np.testing.assert_allclose(box.colors, [0, 0, 1, 0.5])
    np.testing.assert_allclose(tube.colors, [1, 0, 0, 1])


def test_alphas_of_robot_link_and_material_are_multiplied() -> None:
    bench = Bench()
    display = standing(bench, Alpha=0.5)
    display["Links/base/Alpha"] = 0.5
    bench.update()
    box = visible_drawables(bench)["base/visual/0"]
    assert isinstance(box, Solids)
    assert box.colors[3] == pytest.approx(0.5**3)


def test_link_without_a_transform_is_white_unshaded_and_an_error() -> None:
    bench = Bench()
    bench.transform("map", "base")
    display = robot(bench)
    tube = visible_drawables(bench)["arm/visual/0"]
    assert isinstance(tube, Solids)
    np.testing.assert_array_equal(tube.colors, np.ones(4))
    assert not tube.lit
    assert bench.status(display, "arm") == ("error", "No transform from [arm] to [map]")
    bench.transform("base", "arm", (0.0, 3.0, 0.0))
    bench.update()
    again = visible_drawables(bench)["arm/visual/0"]
    assert isinstance(again, Solids)
    assert again.lit
    assert bench.status(display, "arm") == ("ok", "Transform OK")


def test_stl_uses_the_link_color_and_other_formats_use_their_own(tmp_path: Path) -> None:
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
        mesh = visible_drawables(bench)["arm/visual/0"]
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
def test_display_properties_show_and_hide_their_drawables(label: str, expected: str) -> None:
    bench = Bench()
    display = standing(bench)
    before = visible_drawables(bench).keys()
    display[label] = True
    assert visible_drawables(bench).keys() - before == {expected}
    node = "displays/Robot/links/" + expected.rpartition("/")[0]
    np.testing.assert_array_equal(bench.scene.transform(node)[:3, 3], [1, 0, 0])
    display[label] = False
    assert visible_drawables(bench).keys() == before


def test_mass_is_drawn_as_a_ball_of_lead() -> None:
    bench = Bench()
    standing(bench, Mass=True)
    ball = visible_drawables(bench)["base/mass/mass"]
    assert isinstance(ball, Solids)
    radius = ball.placements[0, 0, 0] / 2
    assert 4 / 3 * np.pi * radius**3 * 11340 == pytest.approx(11340)


def test_links_are_hidden_individually_and_together() -> None:
    bench = Bench()
    display = standing(bench)
    display["Links/base"] = False
    assert list(visible_drawables(bench)) == ["arm/visual/0"]
    assert display["All Links Enabled"] is False
    display["All Links Enabled"] = True
    assert len(visible_drawables(bench)) == 2
    display["Visual Enabled"] = False
    assert not visible_drawables(bench)


def test_link_without_shapes_cannot_be_enabled() -> None:
    display = robot(Bench())
    with pytest.raises(CourseError, match="no property 'Links/tool'"):
        display["Links/tool"] = False


def test_trail_follows_the_last_two_meters_of_the_link() -> None:
    bench = Bench()
    bench.transform("map", "base", at=0.0, static=False)
    display = robot(bench)
    display["Links/base/Show Trail"] = True
    for step in range(1, 301):
        bench.transform("map", "base", (0.05 * step, 0.0, 0.0), at=step / 100, static=False)
        bench.update(step / 100)
    trail = visible_drawables(bench)["base/trail"]
    assert isinstance(trail, Lines)
    assert trail.points[-1, 0] == pytest.approx(15.0, abs=0.02)
    assert 1.9 < np.ptp(trail.points[:, 0]) <= 2.0
