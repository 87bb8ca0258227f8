import pytest

from course_lib.errors import CourseError
from course_lib.robots.robot import load_robot, pinocchios
from tests.robots.urdfs import ARM_2R


def test_a_robot_knows_its_links_and_joints() -> None:
    tree = load_robot(ARM_2R).tree
    assert tree.root == "base"
    assert [joint.child for joint in tree.joints.values()] == ["upper", "fore", "tip"]


def test_a_missing_package_is_named_with_what_needs_it_and_what_to_do() -> None:
    with pytest.raises(
        CourseError, match=r"Pinocchio's models.* no_such_package is missing .* WSL2 or conda"
    ):
        pinocchios("no_such_package")
