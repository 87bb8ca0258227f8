"""Lines on what a link cannot do, each with what to do about it."""

from course_lib.errors import counted
from course_lib.ros.messages.hashes import is_known, type_hash
from course_lib.ros.qos import incompatible
from course_lib.ros.topics import EndpointInfo
from course_lib.ros.zenoh.tokens import Entity

HUMBLE = "TypeHashNotSupported"  # in the place of a hash
NO_SKEW = "not measured: no topic is heard yet"
MAX_SKEW = 0.5  # [s]
STOP_IS_DUE = "The link is down, and the robot may still move: it gets its stop when the link is back."
NO_STOP = "The link is down: the robot has not got its stop. If it moves, use its emergency stop."


def about_type(entity: Entity) -> str:
    """Return a line if messages of an entity cannot be understood here, or ""."""
    if entity.type_hash == HUMBLE:
        return (
            "The robot runs ROS 2 Humble, whose messages Jazzy does not hear over Zenoh. Install Jazzy on "
            "the robot, with ros-jazzy-rmw-zenoh-cpp."
        )
    if entity.topic == "/clock" and entity.kind == "MP":
        return (
            "The robot publishes /clock: its time is simulated. Set use_sim_time to true here as well, or "
            "stamps and tf do not fit: -p use_sim_time:=true behind --ros-args, Viewer(use_sim_time=True)."
        )
    if entity.kind == "NN" or not is_known(entity.type_name):
        return ""
    if entity.type_hash == type_hash(entity.type_name):
        return ""
    return (
        f"The robot has another definition of {entity.type_name} than this kit, so {entity.topic} stays "
        "silent. If the package is yours, copy its interface file from the robot. If it is ROS's, the robot "
        "needs ROS 2 Jazzy."
    )


def about_qos(offered: EndpointInfo, requested: EndpointInfo) -> str:
    """Return a line if DDS would keep a pair apart, or ""."""
    policy = incompatible(offered.qos, requested.qos)
    if policy is None:
        return ""
    return (
        f"{offered.topic}: publisher and subscription have incompatible QoS ({policy}). Zenoh delivers all "
        "the same; on a robot with DDS the topic would be silent."
    )


def about_old_rmw(count: int) -> str:
    """Return a line on messages with an attachment of another length."""
    return (
        f"{counted(count, 'message')} came in the form of an rmw_zenoh before 0.2.4, which the kit cannot "
        "read. Update ros-jazzy-rmw-zenoh-cpp on the robot."
    )


def about_clock(skew: float) -> str:
    """Return a line if the robot's clock is so many seconds ahead of ours, or behind it, or ""."""
    if abs(skew) < MAX_SKEW:
        return ""
    return (
        f"The robot's clock is {abs(skew):.1f} s {'ahead of' if skew > 0 else 'behind'} this computer's: "
        "stamps and tf do not fit together. Set both by NTP (timedatectl)."
    )


def about_domains(domain: int, others: list[int]) -> str:
    """Return a line on a domain without nodes."""
    if not others:
        return f"There are no nodes in domain {domain} yet."
    names = ", ".join(map(str, others))
    return f"There are no nodes in domain {domain}, but in domain {names}: connect with --domain {others[0]}."
