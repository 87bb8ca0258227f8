"""Addresses of robots: how they are written, and whether a network leads there."""

import re
import socket
from ipaddress import ip_address

from course_lib.errors import CourseError

# Address prefix of links over DDS.
DDS = "dds/"
# An IPv4 address or a name.
HOST = re.compile(r"\d+(?:\.\d+){3}|(?![\d.]+$)[\w.-]+", re.ASCII)
# A Zenoh router: protocol, login, host and port, of which only the host is required.
ROUTER = re.compile(r"(?:(\w+)/)?(\w+:[\w-]+@)?([\w.-]+|\[[0-9a-fA-F:]+\])(?::(\d+))?", re.ASCII)
# The default port of rmw_zenohd.
PORT = 7447
LAST_PORT = 65535


def is_over_dds(address: str) -> bool:
    """Return whether an address, which may be malformed, is meant for a link over DDS.

    Raises:
        CourseError: It is not a string.
    """
    # A robot from start_robot has its address as an attribute.
    if not isinstance(address, str):
        raise CourseError(
            f"{address!r} is not an address of a robot, but an object of type "
            f"{type(address).__name__}: pass a string like {DDS}192.168.1.5, or robot.address."
        )
    return re.match(r"dds([:/]|$)", address, re.IGNORECASE) is not None


def full_address(address: str) -> str:
    """Return `dds/HOST` unchanged, and the address of a Zenoh router with its protocol and port.

    Raises:
        CourseError: The address is malformed.
    """
    if is_over_dds(address):
        if not address.startswith(DDS) or not HOST.fullmatch(address.removeprefix(DDS)):
            raise CourseError(f"{address!r} is not an address of a robot: {_dds_advice(address)}")
        return address
    match = ROUTER.fullmatch(address)
    if match is None:
        raise CourseError(
            f"{address!r} is not an address of a robot: write it like tcp/192.168.1.5:{PORT} or "
            f"{DDS}192.168.1.5."
        )
    if match[4] and not 0 < int(match[4]) <= LAST_PORT:
        raise CourseError(
            f"{address!r} is not an address of a robot: a port is a number from 1 to {LAST_PORT}, "
            f"and a router usually has {PORT}."
        )
    return f"{match[1] or 'tcp'}/{match[2] or ''}{match[3]}:{match[4] or PORT}"


def _dds_advice(address: str) -> str:
    """Return how to write a malformed address of a link over DDS."""
    host = re.sub(r"^dds(/+|:/*|$)", "", address, flags=re.IGNORECASE)
    if host.count(":") > 1:
        return f"a link over DDS needs the robot's IPv4 address, like {DDS}192.168.1.5."
    if re.fullmatch(r"[\d.]+", host) and not HOST.fullmatch(host):
        return f"an IPv4 address has four numbers, like {DDS}192.168.1.5."
    host_match = HOST.fullmatch(host.partition(":")[0].rstrip("/"))
    if host_match:
        return f"write it without a port or other signs, {DDS}{host_match[0]}."
    return f"write it like {DDS}192.168.1.5."


def resolve(host: str) -> str:
    """Return the IPv4 address of a host.

    Raises:
        CourseError: The name is unknown, or the address does not belong to a single computer.
    """
    try:
        address = ip_address(socket.gethostbyname(host))
    # A label that is empty or longer than 63 characters raises UnicodeError.
    except (OSError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise CourseError(
            f"There is no computer {host!r} in this network ({reason}): write the robot's address "
            "like dds/192.168.1.5."
        ) from error
    if address.is_unspecified:
        raise CourseError(
            f"{address} stands for all addresses of a computer: write the robot's own address like "
            f"{DDS}192.168.1.5, or {DDS}127.0.0.1 if its programs run on this computer."
        )
    if address.is_multicast:
        raise CourseError(
            f"{address} is a multicast address, which belongs to a group of computers: write the "
            f"robot's own address like {DDS}192.168.1.5. The link finds it without multicast."
        )
    return str(address)


def common_bits(address: str, other: str) -> int:
    """Return the number of leading bits that two IPv4 addresses have in common."""
    first, second = (int.from_bytes(socket.inet_aton(text), "big") for text in (address, other))
    return 32 - (first ^ second).bit_length()


def bind_udp(address: str, ports: range, buffer_size: int) -> socket.socket:
    """Return a socket on the first of some ports that is free on this computer.

    Args:
        address: Address of this computer.
        ports: The ports to try.
        buffer_size: Size of its buffers for sending and receiving [B].

    Raises:
        CourseError: No port is free.
    """
    for port in ports:
        udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        udp.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer_size)
        udp.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, buffer_size)
        udp.setblocking(False)
        try:
            udp.bind((address, port))
            return udp
        except OSError:
            udp.close()
    raise CourseError(
        f"No UDP port from {ports[0]} to {ports[-1]} is free on {address}: end other ROS programs "
        "on this computer, or choose another domain."
    )


def socket_towards(host: str, port: int) -> socket.socket:
    """Return a socket connected to a port, so that it reports an error if nothing listens there.

    Raises:
        CourseError: No network leads to the host.
    """
    probe = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        probe.connect((host, port))
    except PermissionError as error:
        probe.close()
        raise CourseError(
            f"{host} is the broadcast address of a network, to which all its computers listen: "
            f"write the robot's own address like {DDS}192.168.1.5."
        ) from error
    except OSError as error:
        probe.close()
        raise CourseError(
            f"This computer has no route to {host} ({error.strerror or error}). Is it the "
            "robot's address, and are both in the same network?"
        ) from error
    return probe
