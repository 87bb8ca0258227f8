from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.robots.kinematics import link_poses
from course_lib.robots.mobile_manipulator import mobile_manipulator
from course_lib.robots.robot import load_robot
from tests.robots.urdfs import ALL_KINDS, ARM_2R, with_mesh


@pytest.mark.slow
def test_robot_is_loaded_by_name_with_its_shapes_and_description() -> None:
    robot = load_robot("ur10")
    assert (robot.name, robot.model.nq, len(robot.visual_model.geometryObjects)) == ("ur10", 6, 7)
    assert robot.q0.shape == (6,)
    assert robot.urdf.startswith("<?xml")
    assert robot.tree.root == "world"


def test_meshes_of_a_robot_are_found() -> None:
    robot = load_robot("panda")
    uri = "package://example-robot-data/robots/panda_description/meshes/visual/link0.dae"
    assert uri in robot.urdf
    assert robot.resolve(uri).name == "link0.dae"


@pytest.mark.slow
def test_legged_robot_has_a_free_flyer() -> None:
    assert load_robot("solo12").model.nq == 7 + 12


def test_robot_is_loaded_from_a_urdf_string() -> None:
    robot = load_robot(ALL_KINDS)
    assert (robot.name, robot.urdf, robot.path) == ("small", ALL_KINDS, None)
    assert robot.q0.shape == (robot.model.nq,)


def test_robot_is_loaded_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(ARM_2R)
    assert load_robot(path).model.nq == load_robot(str(path)).model.nq == 2


def test_file_can_reference_meshes_of_its_own_package(tmp_path: Path) -> None:
    stl = Path(
        load_robot("ur10").resolve(
            "package://example-robot-data/robots/ur_description/meshes/ur10/collision/base.stl"
        )
    )
    (tmp_path / "my_robot" / "urdf").mkdir(parents=True)
    (tmp_path / "my_robot" / "base.stl").write_bytes(stl.read_bytes())
    path = tmp_path / "my_robot" / "urdf" / "arm.urdf"
    path.write_text(with_mesh("package://my_robot/base.stl"))
    assert len(load_robot(path).visual_model.geometryObjects) == 1


def test_link_poses_are_computed_without_reading_shapes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr("example_robot_data.load_full")
    monkeypatch.delattr("pinocchio.buildGeomFromUrdfString")
    mobile_manipulator.cache_clear()
    for robot in (load_robot("ur10"), mobile_manipulator()):
        assert robot.tree.root in link_poses(robot)
    assert mobile_manipulator().q0.shape == (6,)


def test_robots_with_equal_descriptions_are_independent() -> None:
    first, second = load_robot(ARM_2R), load_robot(ARM_2R)
    first.model.upperPositionLimit[:] = 9.0
    assert list(second.model.upperPositionLimit) == [1.0, 1.0]


def test_unknown_name_error_suggests_close_names() -> None:
    with pytest.raises(CourseError, match=r"no robot 'ur1O' among the \d+ models\. Did you mean ur10"):
        load_robot("ur1O")


def test_description_that_is_not_a_urdf_is_an_error() -> None:
    with pytest.raises(CourseError, match="'cassie' is described by SDF, not URDF"):
        load_robot("cassie")


@pytest.mark.parametrize("name", ["nowhere/arm.urdf", "arm.urdf", Path("arm")])
def test_missing_file_is_an_error(name: str | Path) -> None:
    with pytest.raises(CourseError, match=f"Cannot read {name}: .*No such file"):
        load_robot(name)


def test_binary_file_is_rejected(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(CourseError, match=r"Cannot read .*arm\.urdf: it is not text in UTF-8"):
        load_robot(path)


MESH = '<mesh filename="package://a/{}.stl"/>'


def test_missing_mesh_is_reported() -> None:
    with pytest.raises(CourseError, match=r"The file package://my_robot/leg\.stl does not exist"):
        load_robot(with_mesh("package://my_robot/leg.stl"))


def test_first_of_several_missing_meshes_is_reported() -> None:
    visuals = "".join(f"<visual><geometry>{MESH.format(n)}</geometry></visual>" for n in range(9))
    with pytest.raises(CourseError, match=r"The file package://a/0\.stl does not exist"):
        load_robot(f'<robot name="r"><link name="base">{visuals}</link></robot>')


def test_unreadable_mesh_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "leg.stl"
    path.write_text("no mesh")
    with pytest.raises(CourseError, match=r"shapes of 'small' cannot be loaded: (.|\n)*leg\.stl"):
        load_robot(with_mesh(path.as_uri()))


XACRO = (
    '<robot name="$(arg name)" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    '<xacro:arg name="high" default="0"/>'
    '<link name="a"/><xacro:if value="$(arg high)"><link name="b"/><joint name="j" type="fixed">'
    '<parent link="a"/><child link="b"/></joint></xacro:if></robot>'
)


@pytest.mark.parametrize("file", ["arm.urdf.xacro", "arm.urdf"])
def test_xacro_arguments_are_passed_as_keywords(file: str, tmp_path: Path) -> None:
    path = tmp_path / file
    path.write_text(XACRO)
    robot = load_robot(path, name="ur", high=True)
    assert (robot.name, list(robot.tree.joints)) == ("ur", ["j"])
    with pytest.raises(
        CourseError, match=r"(?s)Undefined.*needs a value for its argument 'name': load_robot\("
    ):
        load_robot(str(path))


@pytest.mark.parametrize(
    ("names", "advice"),
    [
        (["wheel"], r"only defines the macro, wheel: load a file that .* <xacro:wheel …/>\."),
        (["wheel", "arm"], r"only defines macros, wheel, arm: load a file"),
        (list("abcdef"), r"only defines macros, a, b, c, d, e, …: load"),
    ],
)
def test_error_about_a_macro_only_xacro_file_suggests_a_file_to_load(
    names: list[str], advice: str, tmp_path: Path
) -> None:
    macros = "".join(
        f'<xacro:macro name="{name}" params="x"><link name="a"/></xacro:macro>' for name in names
    )
    path = tmp_path / "parts.xacro"
    path.write_text(f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro">{macros}</robot>')
    with pytest.raises(CourseError, match=rf"No name given for the robot\. The file {advice}"):
        load_robot(path)


@pytest.mark.parametrize(
    ("data", "advice"),
    [
        ('<robot name="é"/>'.encode("latin-1"), "it is not text in UTF-8: save it in this encoding"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", "then git lfs pull"),
    ],
)
@pytest.mark.parametrize("name", ["arm.urdf", "arm.urdf.xacro"])
def test_unreadable_description_is_reported_with_its_cause(
    name: str, data: bytes, advice: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_bytes(data)
    with pytest.raises(CourseError, match=advice):
        load_robot(tmp_path / name)


def test_error_about_a_description_without_links_suggests_the_including_file(tmp_path: Path) -> None:
    path = tmp_path / "materials.xacro"
    path.write_text('<robot><material name="red"><color rgba="1 0 0 1"/></material></robot>')
    with pytest.raises(CourseError, match=r"The file defines no links: load the file that includes it\."):
        load_robot(path)


def test_truncated_description_is_not_reported_as_having_no_links(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text('<robot name="arm">\n  <material name="red">')
    with pytest.raises(CourseError, match="is not XML: no element found") as error:
        load_robot(path)
    assert "links" not in str(error.value)


@pytest.mark.parametrize("name", ["ur10", '<robot name="r"><link name="a"/></robot>'])
def test_arguments_for_a_robot_without_xacro_are_rejected(name: str) -> None:
    with pytest.raises(CourseError, match=r"but prefix was given\. Only xacro files take arguments\."):
        load_robot(name, prefix="left_")
    assert load_robot(name=name).name


def test_robot_is_shown_by_its_name_and_path() -> None:
    robot = load_robot("ur10")
    assert repr(robot) == f"Robot(name='ur10', path={robot.path!r})"
