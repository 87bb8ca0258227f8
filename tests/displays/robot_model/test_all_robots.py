"""Every robot that comes with the kit."""

from collections.abc import Iterator

import pytest
from std_msgs.msg import String

from course_lib.robots.kinematics import link_poses
from course_lib.robots.links import links_of
from course_lib.robots.load import load_robot
from course_lib.robots.robot import Robot
from tests.displays.bench import Bench
from tests.displays.robot_model.robots import LATCHED, ROBOT, drawn


def known_robots() -> Iterator[tuple[str, Robot]]:
    """Load all robots, but leave out those that only use meshes of others before them."""
    example_robot_data = pytest.importorskip("example_robot_data")
    seen: set[str] = set()
    for name in sorted(example_robot_data.ROBOTS.keys() - {"cassie"}):  # which is no URDF
        loaded = load_robot(name)
        meshes = {visual.uri for link in links_of(loaded.urdf) for visual in link.visuals}
        if not meshes or meshes - seen:
            yield name, loaded
        seen |= meshes


@pytest.mark.slow
def test_all_robots_that_can_be_loaded_are_drawn_without_an_error() -> None:
    blank = {"simple_humanoid", "simple_humanoid_classical"}  # have no visuals
    for name, loaded in known_robots():
        bench = Bench(loaded.tree.root)
        for link in link_poses(loaded):
            if link != loaded.tree.root:
                bench.transform(loaded.tree.root, link)
        topic = {"Description Topic": {"Value": "/robot_description"}}
        display = bench.session.add(ROBOT, "Robot", topic)
        bench.hear("/robot_description", String(data=loaded.urdf), qos=LATCHED)
        bench.look()
        assert {row.level for row in display.rows()} == {"ok"}, name
        visuals = [part for part in drawn(bench) if "/visual/" in part]
        assert len(visuals) == sum(len(link.visuals) for link in links_of(loaded.urdf)), name
        assert bool(visuals) == (name not in blank), name
