"""Messages about a link for users: problems between this kit and the robot, and the next step."""

import errno
import re

from course_lib.ros.messages.definitions import is_known, type_hash
from course_lib.ros.robot.link import Entity, Link

HUMBLE_HASH = "TypeHashNotSupported"
MAX_SKEW = 0.5  # [s]
SECONDS_PER_DAY, DAYS_PER_YEAR = 86_400, 365.25
SIMULATED_TIME = (
    "The robot publishes /clock: its time is simulated. Set use_sim_time to true here as well, or "
    "stamps and tf do not fit: -p use_sim_time:=true behind --ros-args, Viewer(use_sim_time=True)."
)
STOP_IS_DUE = "The link is down, and the robot may still move: it gets its stop when the link is back."
NO_STOP = "The link is down: the robot has not got its stop. If it moves, use its emergency stop."


def type_warning(entity: Entity) -> str:
    """Return a message if the kit cannot read an entity's messages, else ""."""
    if entity.type_hash == HUMBLE_HASH:
        return (
            "The robot runs ROS 2 Humble, whose messages Jazzy does not receive over Zenoh. "
            "Install Jazzy on the robot, with ros-jazzy-rmw-zenoh-cpp."
        )
    # Humble and Cyclone DDS transmit no hash.
    if not entity.type_hash or not is_known(entity.type_name):
        return ""
    if entity.type_hash == type_hash(entity.type_name):
        return ""
    return (
        f"The robot has another definition of {entity.type_name} than this kit, so {entity.topic} "
        "stays silent. If the package is yours, copy its interface file from the robot. If it is "
        "ROS's, the robot needs ROS 2 Jazzy."
    )


def qos_warning(topic: str, policy: str, publisher: str, subscriber: str, *, is_enforced: bool) -> str:
    """Return a message about a publisher and a subscription of different nodes with incompatible QoS."""
    line = (
        f"{topic}: the publisher of {publisher} and the subscription of {subscriber} have "
        f"incompatible QoS ({policy})."
    )
    if is_enforced:
        return f"{line} DDS does not connect them, so no message arrives. Give both the same {policy}."
    return f"{line} Zenoh delivers all the same; on a robot with DDS the topic would be silent."


def second_driver_warning(topic: str, node: str) -> str:
    """Return a message about another node that publishes velocity commands."""
    return (
        f"{topic}: {node} can drive the robot as well, and the robot obeys the newest command of "
        "either. Let only one of them publish."
    )


def clock_warning(skew: float) -> str:
    """Return a message if the robot's clock is `skew` [s] ahead of this computer's, else ""."""
    if abs(skew) < MAX_SKEW:
        return ""
    days = abs(skew) / SECONDS_PER_DAY
    # A computer without a clock battery starts years ago if it has no internet.
    if days >= 2 * DAYS_PER_YEAR:
        offset = f"{days / DAYS_PER_YEAR:.0f} years"
    elif days >= 2:
        offset = f"{days:.0f} days"
    else:
        offset = f"{abs(skew):.1f} s"
    return (
        f"The robot's clock is {offset} {'ahead of' if skew > 0 else 'behind'} this computer's: "
        "stamps and tf do not fit together. Set both by NTP (timedatectl)."
    )


def no_answer_message(link: Link) -> str:
    """Return a message about a robot that does not answer."""
    seconds = link.silent_seconds()
    return f"{link.address} has not answered " + (f"for {seconds:.0f} s." if seconds else "yet.")


def silence_message(address: str, domain: int, error: int) -> str:
    """Return a message for a robot from which nothing is received.

    Args:
        address: The robot, like `dds/192.168.1.5`.
        domain: ROS_DOMAIN_ID.
        error: The error number with which datagrams to it are rejected, or 0.
    """
    start = f"Nothing comes from {address} in domain {domain}."
    if error == errno.ECONNREFUSED:
        return (
            f"{start} The computer is there, but no ROS 2 program has opened a port of this "
            "domain: start one, or pass its domain (ROS_DOMAIN_ID on the robot, --domain here). A "
            "firewall that rejects UDP looks the same."
        )
    return (
        f"{start} Is the robot on, does a ROS 2 program run there in this domain (ROS_DOMAIN_ID), "
        "and are both in the same network? Firewalls and WSL2 often let no UDP in. A robot with a "
        "Fast DDS discovery server, or with ROS_AUTOMATIC_DISCOVERY_RANGE=OFF, does not answer. A "
        "link over Zenoh (tcp/HOST:7447) needs only an outgoing TCP connection."
    )


def moved_message(address: str, host: str) -> str:
    """Return a message for a robot that was linked at `address` and now sends from `host`."""
    # A name still leads to the robot.
    has_number = re.fullmatch(r"dds/[\d.]+", address) is not None
    return (
        f"The robot {address} now has the address {host}, and the link follows it."
        + f" Next time connect to dds/{host}." * has_number
    )


def incomplete_message(topic: str, count: int, size: int) -> str:
    """Return a message for a topic of which `count` messages of `size` bytes arrived in part."""
    return (
        f"{topic}: {count} messages of {size / 1e6:.1f} MB have arrived only in part, more than "
        "whole ones. They are too large for this network: use a compressed topic, a smaller image "
        "or a reliable publisher."
    )
