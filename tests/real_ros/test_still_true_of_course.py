"""The frozen outcomes of the course's code, and the documents' programs, against the real rclpy itself."""

import os
from pathlib import Path

import pytest

from course_lib.real.check import compare
from course_lib.real.process import run_on_ros
from course_lib.recording import read_bag
from tests import test_seed_programs as seeds
from tests.real_ros import differences
from tests.real_ros.mistakes import outcomes_of_mistakes
from tests.real_ros.nodes import outcomes_on_ros
from tests.real_ros.renew import frozen_outcomes

# The first messages are published before the kit is connected.
LOST_SECONDS = 1.5  # [s]
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not os.environ.get("REAL_ROS_PYTHON"), reason="REAL_ROS_PYTHON names no Python with the real rclpy"
    ),
]


def test_real_rclpy_gives_the_frozen_errors_of_mistakes() -> None:
    actual, frozen = outcomes_of_mistakes(), frozen_outcomes("mistakes")
    assert {key: actual[key] for key in actual if actual[key] != frozen[key]} == {}


def test_real_rclpy_gives_the_frozen_outcomes_of_nodes_of_the_course() -> None:
    frozen = frozen_outcomes("nodes")
    actual = outcomes_on_ros(frozen)
    for outcomes in (actual, frozen):
        outcomes.update({name: differences.without_values(outcomes[name]) for name in differences.NODES})
    assert {name: actual[name] for name in actual if actual[name] != frozen[name]} == {}


@pytest.mark.skipif(not seeds.DOCUMENTS, reason="COURSE_SEEDS names no folder with the documents")
@pytest.mark.parametrize("name", sorted(seeds.PROGRAMS))
def test_program_of_the_documents_publishes_the_same_on_the_real_rclpy(tmp_path: Path, name: str) -> None:
    program, topic = tmp_path / "program.py", seeds.PROGRAMS[name][0]
    program.write_text(seeds.program(name))
    in_kit = seeds.run(tmp_path / "kit", program)
    run_on_ros([program], seconds=seeds.SECONDS, bag=tmp_path / "ros", arguments=[], shows=False)
    in_ros = read_bag(tmp_path / "ros")
    (agreement,) = [
        comparison for comparison in compare(in_kit.samples, in_ros.samples) if comparison.topic == topic
    ]
    _, rate, at_once = seeds.PROGRAMS[name]
    assert agreement.ros_count >= (seeds.SECONDS - LOST_SECONDS) * rate * at_once * 0.9
    if name not in differences.OTHER_VALUES:
        assert (agreement.equal, agreement.different_field) == (agreement.pairs, ""), agreement
