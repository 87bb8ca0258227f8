"""Links as they are read beside those of Pinocchio."""

from pathlib import Path

import numpy as np
import pytest

from course_lib.robots.robot import load_robot
from course_lib.robots.urdf import Material, links_of
from tests.robots.by_pinocchio import model_of

PAINTED = """<robot name="r">
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="a"><visual><geometry><box size="1 2 3"/></geometry>{a}</visual></link>
  <link name="b">
    <visual><geometry><sphere radius="1"/></geometry>{b}</visual>
    <collision><geometry><cylinder radius="1" length="3"/></geometry></collision>
  </link>
  <joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>
</robot>"""


@pytest.mark.parametrize("name", ["ur10", "panda", "talos", "double_pendulum"])
def test_shapes_are_where_pinocchio_has_them(name: str) -> None:
    robot = load_robot(name)
    ours = [(link.name, shape) for link in links_of(robot.urdf) for shape in link.visuals]
    theirs = {g.name: g for g in robot.visual_model.geometryObjects}
    model = model_of(robot.urdf)
    assert len(ours) == len(theirs)
    count: dict[str, int] = {}
    for link, shape in ours:
        index = count[link] = count.get(link, -1) + 1
        other = theirs[f"{link}_{index}"]
        body = model.frames[model.getFrameId(link)]
        expected = body.placement.homogeneous @ shape.transform_shape_to_link
        np.testing.assert_allclose(expected, other.placement.homogeneous, atol=1e-9)
        if shape.kind == "mesh":
            np.testing.assert_allclose(shape.size, other.meshScale)
            assert robot.resolve(shape.uri).resolve() == Path(other.meshPath).resolve()


@pytest.mark.parametrize("name", ["ur10", "talos"])
def test_masses_are_those_of_pinocchio(name: str) -> None:
    robot = load_robot(name)
    total = sum(link.inertial.mass for link in links_of(robot.urdf) if link.inertial)
    model = model_of(robot.urdf)
    assert total == pytest.approx(sum(inertia.mass for inertia in model.inertias))


def test_the_first_material_of_a_name_holds_wherever_it_is_named() -> None:
    green = '<material name="green"><color rgba="0 1 0 1"/></material>'
    a, b = links_of(PAINTED.format(a=green, b='<material name="green"/>'))
    assert a.material == b.material == Material((0.0, 1.0, 0.0, 1.0))
    other = '<material name="green"><color rgba="1 1 0 1"/></material>'
    assert links_of(PAINTED.format(a=green, b=other))[1].material == a.material
    named = '<material name="blue"/>'
    assert links_of(PAINTED.format(a=named, b=named))[0].material == Material((0.0, 0.0, 1.0, 1.0))


def test_a_material_that_nobody_describes_is_none() -> None:
    a, b = links_of(PAINTED.format(a='<material name="nobody"/>', b=""))
    assert a.material is None
    assert b.material is None


def test_a_texture_is_an_address() -> None:
    painted = '<material name="t"><texture filename="package://p/t.png"/></material>'
    assert links_of(PAINTED.format(a=painted, b=""))[0].material == Material(
        (1, 1, 1, 1), "package://p/t.png"
    )


BROKEN = (
    "<box/>",
    '<box size="1 2"/>',
    '<sphere radius="x"/>',
    '<cylinder radius="1"/>',
    "<mesh/>",
    "<cone/>",
)


@pytest.mark.parametrize("broken", BROKEN)
def test_a_shape_that_cannot_be_read_leaves_the_others(broken: str) -> None:
    sound = "<visual><geometry><sphere radius='1'/></geometry></visual>"
    shapes = f"<visual><geometry>{broken}</geometry></visual>{sound}"
    (link,) = links_of(f'<robot name="r"><link name="a">{shapes}</link></robot>')
    assert [shape.kind for shape in link.visuals] == ["sphere"]


def test_an_inertia_that_cannot_be_read_is_none() -> None:
    inertia = '<inertial><mass value="x"/><inertia ixx="1"/></inertial>'
    (link,) = links_of(f'<robot name="r"><link name="a">{inertia}</link></robot>')
    assert link.inertial is None
