import pytest

from course_lib.errors import CourseError
from course_lib.robots.robot import import_pinocchio, load_robot
from tests.robots.urdfs import ARM_2R


def test_robot_has_links_and_joints() -> None:
    tree = load_robot(ARM_2R).tree
    assert tree.root == "base"
    assert [joint.child for joint in tree.joints.values()] == ["upper", "fore", "tip"]


def test_missing_package_error_has_the_reason_and_the_install_options() -> None:
    with pytest.raises(
        CourseError, match=r"Pinocchio's models.* no_such_package is missing .* WSL2 or conda"
    ):
        import_pinocchio("no_such_package")
