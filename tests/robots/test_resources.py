from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.robots.robot import resolve


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    path = tmp_path / "my_robot" / "meshes" / "an arm.stl"
    path.parent.mkdir(parents=True)
    path.touch()
    return path


def test_file_address_is_resolved_to_its_file(mesh: Path) -> None:
    assert resolve(mesh.as_uri()) == mesh


def test_package_is_found_in_a_parent_folder_of_the_urdf(mesh: Path) -> None:
    urdf = mesh.parents[1] / "urdf" / "my_robot.urdf"
    assert resolve("package://my_robot/meshes/an%20arm.stl", urdf) == mesh


def test_package_is_found_on_the_package_path(mesh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere:{mesh.parents[2]}")
    assert resolve("package://my_robot/meshes/an arm.stl") == mesh


def test_robot_data_of_the_kit_are_found() -> None:
    uri = "package://example-robot-data/robots/ur_description/meshes/ur10/visual/upperarm.dae"
    assert resolve(uri).stat().st_size > 10_000


@pytest.mark.parametrize("uri", ["package://my_robot/meshes/leg.stl", "file:///nowhere/leg.stl"])
def test_missing_file_is_reported(uri: str) -> None:
    with pytest.raises(CourseError, match=f"The file {uri} does not exist. Correct the address"):
        resolve(uri)


@pytest.mark.parametrize("inside", ["Meshes/an arm.stl", "meshes/An Arm.STL"])
def test_missing_file_is_reported_with_the_file_that_differs_in_capitals(mesh: Path, inside: str) -> None:
    if (mesh.parents[1] / inside).exists():
        pytest.skip("this file system ignores capitals")
    with pytest.raises(CourseError) as caught:
        resolve(f"package://my_robot/{inside}", mesh.parents[1] / "urdf" / "my_robot.urdf")
    assert str(caught.value).endswith(f"the file is {mesh}, and capitals matter.")


@pytest.mark.parametrize("uri", ["meshes/leg.stl", "https://example.org/leg.stl", ""])
def test_invalid_file_address_is_rejected(uri: str) -> None:
    with pytest.raises(CourseError, match="write package://PACKAGE/PATH or file:///PATH"):
        resolve(uri)
