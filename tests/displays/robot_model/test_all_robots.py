"""Every robot that comes with the kit."""

import pytest
from std_msgs.msg import String

from course_lib.robots.kinematics import link_poses
from course_lib.robots.links import links_of
from course_lib.robots.load import load_robot
from tests.displays.bench import Bench
from tests.displays.robot_model.robots import LATCHED, ROBOT, drawn


def known_robots() -> list[str]:
    example_robot_data = pytest.importorskip("example_robot_data")
    return sorted(example_robot_data.ROBOTS.keys() - {"cassie"})  # which is no URDF


@pytest.mark.slow
def test_all_robots_that_can_be_loaded_are_drawn_without_an_error() -> None:
    blank = {"simple_humanoid", "simple_humanoid_classical"}  # have no visuals
    for name in known_robots():
        loaded = load_robot(name)
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
