"""Links of the kit's URDF reader compared with Pinocchio."""

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


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["ur10", "panda", "talos", "double_pendulum"])
def test_shapes_agree_with_pinocchio(name: str) -> None:
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
def test_masses_agree_with_pinocchio(name: str) -> None:
    robot = load_robot(name)
    total = sum(link.inertial.mass for link in links_of(robot.urdf) if link.inertial)
    model = model_of(robot.urdf)
    assert total == pytest.approx(sum(inertia.mass for inertia in model.inertias))


def test_first_definition_of_a_material_applies_to_all_references() -> None:
    green = '<material name="green"><color rgba="0 1 0 1"/></material>'
    a, b = links_of(PAINTED.format(a=green, b='<material name="green"/>'))
    assert a.material == b.material == Material((0.0, 1.0, 0.0, 1.0))
    other = '<material name="green"><color rgba="1 1 0 1"/></material>'
    assert links_of(PAINTED.format(a=green, b=other))[1].material == a.material
    named = '<material name="blue"/>'
    assert links_of(PAINTED.format(a=named, b=named))[0].material == Material((0.0, 0.0, 1.0, 1.0))


def test_undefined_material_is_none() -> None:
    a, b = links_of(PAINTED.format(a='<material name="nobody"/>', b=""))
    assert a.material is None
    assert b.material is None


def test_texture_is_an_address() -> None:
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
def test_unreadable_shape_does_not_affect_others(broken: str) -> None:
    sound = "<visual><geometry><sphere radius='1'/></geometry></visual>"
    shapes = f"<visual><geometry>{broken}</geometry></visual>{sound}"
    (link,) = links_of(f'<robot name="r"><link name="a">{shapes}</link></robot>')
    assert [shape.kind for shape in link.visuals] == ["sphere"]


def test_unreadable_inertia_is_none() -> None:
    inertia = '<inertial><mass value="x"/><inertia ixx="1"/></inertial>'
    (link,) = links_of(f'<robot name="r"><link name="a">{inertia}</link></robot>')
    assert link.inertial is None


@pytest.mark.parametrize(
    ("broken", "problem"),
    [
        ("<box/>", "Box shape has no size attribute"),
        ('<box size="1 2"/>', "Parser found 2 elements but 3 expected while parsing vector [1 2]"),
        ('<box size="1 2 nan"/>', "Unable to parse component [nan] to a double"),
        ('<sphere radius="x"/>', "radius [x] is not a valid float"),
        ('<sphere radius="1e308"/>', "The size of this sphere is too large."),
        ('<cylinder radius="1"/>', "Cylinder shape must have both length and radius attributes"),
        ("<mesh/>", "Mesh must contain a filename attribute"),
        ('<mesh filename="package://p/a.stl" scale="1 1"/>', "Parser found 2 elements but 3 expected"),
        ("<cone/>", "Unknown geometry type 'cone'"),
        ("", "Geometry tag contains no child element."),
    ],
)
def test_malformed_shape_is_reported_with_the_text_of_urdfdom(broken: str, problem: str) -> None:
    shape = f"<visual><geometry>{broken}</geometry></visual>"
    (link,) = links_of(f'<robot name="r"><link name="a">{shape}</link></robot>')
    assert link.visuals == ()
    assert link.problems[0].startswith(f"Could not parse visual element for Link [a]: {problem}")


@pytest.mark.parametrize("origin", ['xyz="0 0"', 'xyz="a b c"', 'rpy="nan 0 0"', 'rpy="0 0 0 0"', 'xyz=""'])
def test_shape_with_a_malformed_origin_is_omitted(origin: str) -> None:
    shape = f"<visual><origin {origin}/><geometry><sphere radius='1'/></geometry></visual>"
    (link,) = links_of(f'<robot name="r"><link name="a">{shape}</link></robot>')
    assert (link.visuals, len(link.problems)) == ((), 1)


@pytest.mark.parametrize(
    ("rgba", "color", "problem"),
    [
        ("red", None, "malformed color rgba values: Unable to parse component [red]"),
        ("1,0,0,1", None, "Unable to parse component [1,0,0,1]"),
        ("255 0 0 1", None, "Unable to parse component [255]"),
        ("0.8 0 0", (0, 0, 0, 1), "has 3 numbers in its color rgba [0.8 0 0], expected 4"),
        ("0.8 0 0 1 1", (0, 0, 0, 1), "has 5 numbers"),
        ("", (0, 0, 0, 1), "has 0 numbers"),
    ],
)
def test_malformed_color_is_read_as_in_urdfdom(
    rgba: str, color: tuple[float, ...] | None, problem: str
) -> None:
    painted = f'<material name="m"><color rgba="{rgba}"/></material>'
    a, _ = links_of(PAINTED.format(a=painted, b=""))
    assert a.material == (None if color is None else Material(color))
    assert problem in a.problems[0]


def test_malformed_global_material_is_black_and_reported_once() -> None:
    robot = '<robot name="r"><material name="m"><color rgba="red"/></material>{}</robot>'
    shape = '<visual><geometry><sphere radius="1"/></geometry><material name="m"/></visual>'
    links = links_of(robot.format(f'<link name="a">{shape}</link><link name="b">{shape}</link>'))
    assert [link.material for link in links] == [Material((0, 0, 0, 1))] * 2
    assert sum(len(link.problems) for link in links) == 1


def test_loading_a_robot_reports_ignored_elements(capsys: pytest.CaptureFixture[str]) -> None:
    painted = '<material name="m"><color rgba="red"/></material>'
    assert load_robot(PAINTED.format(a=painted, b="")).name == "r"
    assert capsys.readouterr().err.startswith("warning: r: Material [m] has malformed color rgba values")
