"""Every robot that comes with the kit."""

from collections.abc import Iterator

import pytest
from std_msgs.msg import String

from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import Robot, load_robot
from course_lib.robots.urdf import links_of
from tests.displays.bench import Bench
from tests.displays.robot_model.robots import LATCHED, ROBOT, drawn

BLANK = {"simple_humanoid", "simple_humanoid_classical"}  # have no visuals


def known_robots() -> Iterator[tuple[str, Robot, bool]]:
    """Load all robots, each once as it takes a second; and say which have meshes of none before them."""
    example_robot_data = pytest.importorskip("example_robot_data")
    seen: set[str] = set()
    for name in sorted(example_robot_data.ROBOTS.keys() - {"cassie"}):  # which is no URDF
        loaded = load_robot(name)
        meshes = {visual.uri for link in links_of(loaded.urdf) for visual in link.visuals}
        yield name, loaded, not meshes or bool(meshes - seen)
        seen |= meshes


@pytest.mark.slow
def test_every_robot_is_loaded_all_its_links_are_placed_and_it_is_drawn_without_an_error() -> None:
    pinocchio = pytest.importorskip("pinocchio")
    for name, robot, is_new in known_robots():
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
    bench.hear("/robot_description", String(data=robot.urdf), qos=LATCHED)
    bench.look()
    assert {row.level for row in display.rows()} == {"ok"}, name
    visuals = [part for part in drawn(bench) if "/visual/" in part]
    assert len(visuals) == sum(len(link.visuals) for link in links_of(robot.urdf)), name
    assert bool(visuals) == (name not in BLANK), name
