"""Zenoh's access rules for a class: what a student's link and the robot's link may carry."""

import re
from collections.abc import Iterable, Sequence
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.zenoh.login import PRESENCE, ROBOT, STUDENTS
from course_lib.ros.zenoh.tokens import ADMIN

INNER = "unixsock-stream"  # the protocol of the link between both sides; no student can listen or dial there
ROS_NAME = re.compile(r"(/[A-Za-z_]\w*)+", re.ASCII)
LOOK = ["declare_subscriber", "declare_liveliness_subscriber", "liveliness_query"]
MESSAGES = [*LOOK, "put", "delete", "declare_queryable", "query", "reply", "liveliness_token"]
EVERYWHERE = ["**", "**/@adv/**", f"{ADMIN}/**", f"{PRESENCE}/**"]  # ** matches no part that begins with @
DOMAINS = range(233)  # of ROS 2


def checked_names(names: Iterable[str], option: str) -> list[str]:
    """Return names of topics or services without their first slash.

    Raises:
        CourseError: One is not an absolute ROS name.
    """
    for name in names:
        if not ROS_NAME.fullmatch(name):
            raise CourseError(f"{option} {name}: expected a full ROS name, like {option} /cmd_vel")
    return [name[1:] for name in names]


def access_control(students: Sequence[str], calls: Sequence[str], domain: int) -> dict[str, Any]:
    """Return Zenoh's `access_control`, which denies what no rule allows.

    Students hear all. They publish and serve below /students/<name>, in domains other than the robot's, and
    call `calls`. Towards the robot no put passes: the gateway's own session forwards the driver's.

    Args:
        students: Names of users, valid as parts of ROS names.
        calls: Services without their first slash.
        domain: The robot's ROS_DOMAIN_ID.
    """
    subjects: list[dict[str, Any]] = [{"id": name, "usernames": [name]} for name in (ROBOT, *students)]
    subjects.append({"id": INNER, "link_protocols": [INNER]})
    common = ["look", "hear", "ask", "listen", "others"]
    policies: list[dict[str, Any]] = [
        {"rules": ["look", "robot", "asked", "heard"], "subjects": [ROBOT, INNER]},
        *({"rules": [*common, f"own {name}"], "subjects": [name]} for name in students),
    ]
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": _rules(students, calls, domain),
        "subjects": subjects,
        "policies": policies,
    }


def _rules(students: Sequence[str], calls: Sequence[str], domain: int) -> list[dict[str, Any]]:
    latched = f"{domain}/**/@adv/**"  # the caches of publishers
    questions = [latched, *(f"{domain}/{name}/*/*" for name in calls)]
    clients = [_tokens(domain, "SC", name.replace("/", "%")) for name in calls]
    listeners = [_tokens(domain, "NN"), _tokens(domain, "MS"), *clients]
    others = [key for one in DOMAINS if one != domain for key in _domain(one)]
    return [
        _rule("look", ["ingress", "egress"], LOOK, EVERYWHERE),
        _rule("hear", ["egress"], MESSAGES, EVERYWHERE),
        _rule("ask", ["ingress"], ["query"], questions),
        _rule("listen", ["ingress"], ["liveliness_token"], listeners),
        _rule("others", ["ingress"], MESSAGES, others),
        *(_rule(f"own {name}", ["ingress"], MESSAGES, _own(domain, name)) for name in students),
        _rule("robot", ["ingress"], MESSAGES, EVERYWHERE),
        _rule("asked", ["egress"], ["query"], questions),
        _rule("heard", ["egress"], ["liveliness_token"], listeners),
    ]


def _rule(name: str, flows: list[str], messages: list[str], keys: list[str]) -> dict[str, Any]:
    return {"id": name, "permission": "allow", "flows": flows, "messages": messages, "key_exprs": keys}


def _tokens(domain: int, kind: str, topic: str = "") -> str:
    """Return the keys of ROS's tokens of one kind; `topic` is mangled, without its first %."""
    name = f"/*/*/*/%{topic}" if topic else ""
    return f"{ADMIN}/{domain}/*/*/*/{kind}{name}/**"


def _domain(number: int) -> list[str]:
    return [f"{number}/**", f"{number}/**/@adv/**", f"{ADMIN}/{number}/**"]


def _own(domain: int, name: str) -> list[str]:
    below = f"{domain}/{STUDENTS}/{name}/**"
    topics = f"{STUDENTS}%{name}%$*"
    return [
        below,
        f"{below}/@adv/**",
        f"{PRESENCE}/{name}/**",
        *(_tokens(domain, kind, topics) for kind in ("MP", "SS", "SC")),
    ]
