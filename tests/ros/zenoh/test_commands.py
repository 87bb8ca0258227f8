from typing import Any

import pytest
from geometry_msgs.msg import Twist, TwistStamped
from hypothesis import given
from hypothesis import strategies as st

from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.zenoh.commands import COMMANDS, TWIST_STAMPED, moves, still

TURNING = Twist()
TURNING.angular.z = -0.1  # [rad/s]


def test_the_stop_of_a_stamped_twist_is_one() -> None:
    zero = still(TWIST_STAMPED, 1_700_000_000_250_000_000)
    assert zero is not None
    message: Any = deserialize(zero, message_class(TWIST_STAMPED))
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == (1_700_000_000, 250_000_000)
    assert message.twist.linear.x == message.twist.angular.z == 0.0
    assert still("std_msgs/msg/String", 0) is None


@pytest.mark.parametrize("type_name", COMMANDS)
def test_a_stop_does_not_move(type_name: str) -> None:
    zero = still(type_name, 1)
    assert zero is not None
    assert not moves(zero, type_name)
    assert moves(zero[:-8] + b"1234567x", type_name)


@pytest.mark.parametrize("frame", ["", "a", "base", "base_link", "base_footprint"])
def test_a_stamped_command_moves_by_its_numbers_not_by_its_header(frame: str) -> None:
    command = TwistStamped()
    command.header.stamp.sec, command.header.frame_id = 7, frame
    assert not moves(serialize(command), TWIST_STAMPED)
    command.twist = TURNING
    assert moves(serialize(command), TWIST_STAMPED)


@pytest.mark.parametrize("type_name", COMMANDS)
@given(cdr=st.binary(max_size=40))
def test_bytes_that_are_not_a_whole_command_are_taken_for_one(type_name: str, cdr: bytes) -> None:
    assert moves(cdr, type_name)
