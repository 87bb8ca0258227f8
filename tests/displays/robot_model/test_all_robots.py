"""All robots that the kit contains."""

from collections.abc import Iterable, Iterator

import pytest
from std_msgs.msg import String

from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import Robot, load_robot
from course_lib.robots.urdf import links_of
from tests.displays.bench import Bench
from tests.displays.robot_model.robots import LATCHED, ROBOT, visible_drawables

# One of each kind: arms, a hand, legs, wheels, meshes of every format, and a robot without visuals.
SOME = {"anymal", "baxter", "go2", "panda", "simple_humanoid", "tiago", "ur10", "xarm7"}
BLANK = {"simple_humanoid", "simple_humanoid_classical"}  # have no visuals


def known_robots(names: Iterable[str]) -> Iterator[tuple[str, Robot, bool]]:
    """Yield robots, each with whether it has meshes that no earlier robot has."""
    seen: set[str] = set()
    for name in sorted(names):
        loaded = load_robot(name)
        meshes = {visual.uri for link in links_of(loaded.urdf) for visual in link.visuals}
        yield name, loaded, not meshes or bool(meshes - seen)
        seen |= meshes


@pytest.mark.parametrize("which", ["some", pytest.param("all", marks=pytest.mark.slow)])
def test_robot_is_loaded_with_all_links_placed_and_drawn_without_error(which: str) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    example_robot_data = pytest.importorskip("example_robot_data")
    # The data of cassie is not a URDF.
    every = example_robot_data.ROBOTS.keys() - {"cassie"}
    for name, robot, is_new in known_robots(every if which == "all" else SOME & every):
        names = pinocchio.buildModelFromXML(robot.urdf).names  # robot.model reads all shapes as well
        assert set(robot.tree.joints) >= set(names) - {"universe"}, name
        below = {joint.child for joint in robot.tree.joints.values()}
        assert link_poses(robot).keys() == {robot.tree.root, *below}, name
        if is_new:
            assert_drawn(name, robot)


def assert_drawn(name: str, robot: Robot) -> None:
    bench = Bench(robot.tree.root)
    for joint in robot.tree.joints.values():
        bench.transform(robot.tree.root, joint.child)
    display = bench.session.add(ROBOT, "Robot", {"Description Topic": {"Value": "/robot_description"}})
    bench.publish("/robot_description", String(data=robot.urdf), qos=LATCHED)
    bench.update()
    assert {row.level for row in display.rows()} == {"ok"}, name
    visuals = [part for part in visible_drawables(bench) if "/visual/" in part]
    assert len(visuals) == sum(len(link.visuals) for link in links_of(robot.urdf)), name
    assert bool(visuals) == (name not in BLANK), name
