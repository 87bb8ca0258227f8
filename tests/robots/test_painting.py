"""The rules of painting, over the run of tests/programs/painting_robot.py."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import rclpy
from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

from course_lib.robots.mobile_manipulator import PaintNode
from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.messages import deserialize, message_class
from course_lib.ros.time import virtual_time
from course_lib.ros.time.driving import spin_for
from course_lib.ros.time.time_lock import time_lock
from tests.programs.painting_robot import DRIVE, SECOND, nodes

Heard = list[tuple[float, str, Any]]  # [s], topic, message


@pytest.fixture(scope="module")
def painted() -> tuple[PaintNode, Heard]:
    """The node after both sweeps, and its published messages."""
    received: Heard = []
    virtual_time.install()
    with use_graph(Graph(notebook=True)) as graph, time_lock.hold():
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        graph.tap(
            lambda s: received.append(
                ((s.stamp_ns - START_NS) / 1e9, s.topic, deserialize(s.cdr, message_class(s.type_name)))
            )
        )
        paint = PaintNode()
        spin_for(12.0, paint, *nodes())
        uninstall_signal_handlers()
    return paint, received


def markers(painted: tuple[PaintNode, Heard]) -> list[tuple[float, Any]]:
    return [(seconds, message) for seconds, topic, message in painted[1] if topic == "/visualization_marker"]


@pytest.mark.slow
def test_two_sweeps_paint_two_stripes_of_at_least_8_points(painted: tuple[PaintNode, Heard]) -> None:
    assert [len(stripe) >= 8 for stripe in painted[0].stripes] == [True, True]
    last = {marker.id: marker for _, marker in markers(painted)}
    for number, stripe in enumerate(painted[0].stripes):
        assert [[p.x, p.y, p.z] for p in last[number].points] == np.array(stripe).tolist()


def test_painting_stops_while_the_base_drives(painted: tuple[PaintNode, Heard]) -> None:
    assert not [seconds for seconds, _ in markers(painted) if DRIVE <= seconds < SECOND]


def test_reason_for_not_painting_is_logged(
    run: Callable[..., None], capfd: pytest.CaptureFixture[str]
) -> None:
    run(6.0, PaintNode("hand"))
    assert "Nothing is painted: TF does not know hand in map." in capfd.readouterr().err


def test_stripes_are_yellow_and_0_2_m_wide_in_map(painted: tuple[PaintNode, Heard]) -> None:
    for _, marker in markers(painted):
        assert (marker.type, marker.header.frame_id, marker.scale.x) == (marker.LINE_STRIP, "map", 0.2)
        assert (marker.color.r, marker.color.g, marker.color.b, marker.color.a) == (1.0, 1.0, 0.0, 1.0)


def test_points_satisfy_the_two_rules(painted: tuple[PaintNode, Heard]) -> None:
    for stripe in painted[0].stripes:
        heights = np.array(stripe)[:, 2]  # the base is on the ground of map
        assert (heights > 0.5).all()
        assert (np.abs(np.diff(heights)) > 0.01).all()


def test_second_stripe_is_at_the_new_base_position(painted: tuple[PaintNode, Heard]) -> None:
    first, second = (np.array(stripe)[:, 1].mean() for stripe in painted[0].stripes)
    assert second - first == pytest.approx(0.5, abs=1e-6)  # [m]
