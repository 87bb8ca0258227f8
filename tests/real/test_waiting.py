"""The replacement of the kit's time lock under the real rclpy."""

import pytest
from rclpy.duration import Duration
from rclpy.time import Time
from tf2_ros import Buffer

from course_lib.real.child import program


def test_transform_lookup_with_a_timeout_waits_in_real_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tf2_ros.buffer.time_lock", program.time_lock)
    monkeypatch.setattr("tf2_ros.buffer.current_graph", program.current_graph)
    assert not Buffer().can_transform("map", "base", Time(), Duration(seconds=0.01))
