from course_lib.robots.robot import load_robot
from tests.robots.urdfs import ARM_2R


def test_a_robot_knows_its_links_and_joints() -> None:
    tree = load_robot(ARM_2R).tree
    assert tree.root == "base"
    assert [joint.child for joint in tree.joints.values()] == ["upper", "fore", "tip"]
