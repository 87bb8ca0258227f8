from typing import Any

import pytest
from geometry_msgs.msg import Twist, TwistStamped
from hypothesis import given
from hypothesis import strategies as st

from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.robot.sending import TWIST_STAMPED, VELOCITY_TYPES, is_motion, stop_message

TURNING = Twist()
TURNING.angular.z = -0.1  # [rad/s]


def test_stop_for_a_twist_stamped_is_a_twist_stamped() -> None:
    zero = stop_message(TWIST_STAMPED, 1_700_000_000_250_000_000)
    assert zero is not None
    message: Any = deserialize(zero, message_class(TWIST_STAMPED))
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1_700_000_000, 250_000_000)
    assert message.twist.linear.x == message.twist.angular.z == 0.0
    assert stop_message("std_msgs/msg/String", 0) is None


@pytest.mark.parametrize("type_name", VELOCITY_TYPES)
def test_stop_is_not_a_motion_command(type_name: str) -> None:
    zero = stop_message(type_name, 1)
    assert zero is not None
    assert not is_motion(zero, type_name)
    assert is_motion(zero[:-8] + b"1234567x", type_name)


@pytest.mark.parametrize("frame", ["", "a", "base", "base_link", "base_footprint"])
def test_stamped_command_is_a_motion_by_its_velocities_not_its_header(frame: str) -> None:
    command = TwistStamped()
    command.header.stamp.sec, command.header.frame_id = 7, frame
    assert not is_motion(serialize(command), TWIST_STAMPED)
    command.twist = TURNING
    assert is_motion(serialize(command), TWIST_STAMPED)


@pytest.mark.parametrize("type_name", VELOCITY_TYPES)
@given(cdr=st.binary(max_size=40))
def test_truncated_command_counts_as_a_motion_command(type_name: str, cdr: bytes) -> None:
    assert is_motion(cdr, type_name)
