from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.robots.kinematics import link_poses
from course_lib.robots.mobile_manipulator import mobile_manipulator
from course_lib.robots.robot import load_robot
from tests.robots.urdfs import ALL_KINDS, ARM_2R, with_mesh


def test_a_robot_is_loaded_by_name_with_its_shapes_and_its_description() -> None:
    robot = load_robot("ur10")
    assert (robot.name, robot.model.nq, len(robot.visual_model.geometryObjects)) == ("ur10", 6, 7)
    assert robot.q0.shape == (6,)
    assert robot.urdf.startswith("<?xml")
    assert robot.tree.root == "world"


def test_a_robots_meshes_are_found() -> None:
    robot = load_robot("panda")
    uri = "package://example-robot-data/robots/panda_description/meshes/visual/link0.dae"
    assert uri in robot.urdf
    assert robot.resolve(uri).name == "link0.dae"


def test_a_legged_robot_has_a_free_flyer() -> None:
    assert load_robot("solo12").model.nq == 7 + 12


def test_a_robot_is_loaded_from_the_text_of_a_urdf() -> None:
    robot = load_robot(ALL_KINDS)
    assert (robot.name, robot.urdf, robot.path) == ("small", ALL_KINDS, None)
    assert robot.q0.shape == (robot.model.nq,)


def test_a_robot_is_loaded_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(ARM_2R)
    assert load_robot(path).model.nq == load_robot(str(path)).model.nq == 2


def test_a_file_may_name_meshes_of_its_own_package(tmp_path: Path) -> None:
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


def test_poses_of_links_read_no_shapes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr("example_robot_data.load_full")
    monkeypatch.delattr("pinocchio.buildGeomFromUrdfString")
    mobile_manipulator.cache_clear()
    for robot in (load_robot("ur10"), mobile_manipulator()):
        assert robot.tree.root in link_poses(robot)
    assert mobile_manipulator().q0.shape == (6,)


def test_robots_of_one_text_are_apart() -> None:
    first, second = load_robot(ARM_2R), load_robot(ARM_2R)
    first.model.upperPositionLimit[:] = 9.0
    assert list(second.model.upperPositionLimit) == [1.0, 1.0]


def test_an_unknown_name_is_answered_with_close_ones() -> None:
    with pytest.raises(CourseError, match=r"no robot 'ur1O' among the \d+ models\. Did you mean ur10"):
        load_robot("ur1O")


def test_a_robot_that_is_no_urdf_says_so() -> None:
    with pytest.raises(CourseError, match="'cassie' is described by SDF, not URDF"):
        load_robot("cassie")


@pytest.mark.parametrize("name", ["nowhere/arm.urdf", "arm.urdf", Path("arm")])
def test_a_file_that_is_not_there_is_named(name: str | Path) -> None:
    with pytest.raises(CourseError, match=f"Cannot read {name}: .*No such file"):
        load_robot(name)


def test_a_file_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(CourseError, match=r"Cannot read .*arm\.urdf: .*codec"):
        load_robot(path)


def test_a_missing_mesh_is_named() -> None:
    with pytest.raises(CourseError, match=r"There is no file package://my_robot/leg\.stl"):
        load_robot(with_mesh("package://my_robot/leg.stl"))


def test_a_mesh_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    path = tmp_path / "leg.stl"
    path.write_text("no mesh")
    with pytest.raises(CourseError, match=r"shapes of 'small' cannot be loaded: (.|\n)*leg\.stl"):
        load_robot(with_mesh(path.as_uri()))
