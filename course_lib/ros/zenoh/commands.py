"""Commands by which a robot moves until the next one comes, and those that stop it."""

import struct

TWIST, TWIST_STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
COMMANDS = (TWIST, TWIST_STAMPED)
CDR = b"\0\1\0\0"  # little endian
STILL = bytes(48)  # the numbers of a Twist
HEADER = struct.Struct("<iII")  # seconds, nanoseconds, length of the frame's name
ALIGNED = 8  # [B] what the numbers begin at a multiple of


def still(type_name: str, now_ns: int) -> bytes | None:
    """Return the message that stops a robot; None for types that do not move it by their last message."""
    if type_name == TWIST:
        return CDR + STILL
    if type_name == TWIST_STAMPED:  # an empty name is one zero byte, which alignment makes four
        return CDR + HEADER.pack(*divmod(now_ns, 10**9), 1) + bytes(4) + STILL
    return None


def moves(cdr: bytes, type_name: str) -> bool:
    """Return whether a command moves a robot; bytes that are not a whole command are taken for one."""
    if type_name not in COMMANDS:
        return False
    numbers = cdr[len(CDR) :]
    if type_name == TWIST_STAMPED:
        begin = HEADER.size + int.from_bytes(numbers[8:12], "little")
        numbers = numbers[begin + -begin % ALIGNED :]
    return len(numbers) < len(STILL) or any(numbers)
