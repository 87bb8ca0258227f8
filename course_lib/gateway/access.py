"""Zenoh's access rules for a class: permissions of the students' links and of the robot's link.

Zenoh checks the rules for each link. The robot is protected by two routers: students connect to one
of them, and its rules let only queries through to the robot: of the allowed services and of
publishers' caches. The driver's commands are forwarded by the gateway's own session.
"""

import csv
import io
import re
import secrets
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.grading.submissions.roster import read_class
from course_lib.ros.zenoh.link import ADMIN, PRESENCE, ROBOT, STUDENTS

# The protocol between both routers. Students can neither listen nor connect with it.
INNER = "unixsock-stream"
ROS_NAME = re.compile(r"(/[A-Za-z_]\w*)+", re.ASCII)
LOOK = ["declare_subscriber", "declare_liveliness_subscriber", "liveliness_query"]
MESSAGES = [*LOOK, "put", "delete", "declare_queryable", "query", "reply", "liveliness_token"]
# ** does not match chunks of a key that begin with @.
EVERYWHERE = ["**", "**/@adv/**", f"{ADMIN}/**", f"{PRESENCE}/**"]
# The domain IDs of ROS 2.
DOMAINS = range(233)


def relative_names(names: Iterable[str], option: str) -> list[str]:
    """Return topic or service names without their leading slash.

    Raises:
        CourseError: A name is not an absolute ROS name.
    """
    for name in names:
        if not ROS_NAME.fullmatch(name):
            raise CourseError(f"{option} {name}: expected a full ROS name, like {option} /cmd_vel")
    return [name[1:] for name in names]


def access_control(students: Sequence[str], calls: Sequence[str], domain: int) -> dict[str, Any]:
    """Return Zenoh's `access_control`, which denies everything that no rule allows.

    Students receive all messages. They publish and serve below /students/<name> and in domains
    other than the robot's, and may call `calls`. No put passes to the robot, because the gateway's
    own session forwards those of the driver.

    Args:
        students: User names, valid as parts of ROS names.
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
    # The caches of publishers.
    latched = f"{domain}/**/@adv/**"
    questions = [latched, *(f"{domain}/{name}/*/*" for name in calls)]
    clients = [_tokens(domain, "SC", name.replace("/", "%")) for name in calls]
    listeners = [_tokens(domain, "NN"), _tokens(domain, "MS"), *clients]
    read_topics = [
        key
        for one in DOMAINS
        if one != domain
        for key in [f"{one}/**", f"{one}/**/@adv/**", f"{ADMIN}/{one}/**"]
    ]
    return [
        _rule("look", ["ingress", "egress"], LOOK, EVERYWHERE),
        _rule("hear", ["egress"], MESSAGES, EVERYWHERE),
        _rule("ask", ["ingress"], ["query"], questions),
        _rule("listen", ["ingress"], ["liveliness_token"], listeners),
        _rule("others", ["ingress"], MESSAGES, read_topics),
        *(_rule(f"own {name}", ["ingress"], MESSAGES, _student_keys(domain, name)) for name in students),
        _rule("robot", ["ingress"], MESSAGES, EVERYWHERE),
        _rule("asked", ["egress"], ["query"], questions),
        _rule("heard", ["egress"], ["liveliness_token"], listeners),
    ]


def _rule(name: str, flows: list[str], messages: list[str], keys: list[str]) -> dict[str, Any]:
    return {"id": name, "permission": "allow", "flows": flows, "messages": messages, "key_exprs": keys}


def _tokens(domain: int, kind: str, topic: str = "") -> str:
    """Return the key expression for ROS's liveliness tokens of one kind.

    `topic` is mangled and without its first %.
    """
    name = f"/*/*/*/%{topic}" if topic else ""
    return f"{ADMIN}/{domain}/*/*/*/{kind}{name}/**"


def _student_keys(domain: int, name: str) -> list[str]:
    below = f"{domain}/{STUDENTS}/{name}/**"
    topics = f"{STUDENTS}%{name}%$*"
    return [
        below,
        f"{below}/@adv/**",
        f"{PRESENCE}/{name}/**",
        *(_tokens(domain, kind, topics) for kind in ("MP", "SS", "SC")),
    ]


# Names of the files in the gateway's folder.
TOKENS, PASSWORDS, DRIVER = "tokens.csv", "passwords.txt", "driver.txt"
PRIVATE = 0o600
# The user's name if the gateway has no roster.
GUEST = "guest"
# Replaces the student's ID. No ID contains parentheses.
THE_ROBOT = f"({ROBOT})"


@dataclass(frozen=True)
class GatewayUser:
    """A user of the gateway.

    Args:
        student: The ID in the roster.
        name: The ID as a part of ROS names, which is the user's name on the link.
        token: The password on the link.
    """

    student: str
    name: str
    token: str

    def address(self, place: str) -> str:
        """Return the address for a student to connect to, like tcp/ann:TOKEN@lab.example:7448."""
        protocol, _, host = place.partition("/")
        return f"{protocol}/{self.name}:{self.token}@{host}"


def load_users(
    folder: Path, roster: Path | None, id_column: str, place: str, driver: str = ""
) -> list[GatewayUser]:
    """Return the robot and the class, whose tokens are kept, and write the private files.

    Args:
        folder: The folder of the tokens.
        roster: A platform's CSV; None for the class stored in the folder, or for one guest.
        id_column: The heading of the IDs; "" to find the column.
        place: The address for students, which is listed together with the token.
        driver: A student who must be in the class; "" for none.

    Raises:
        CourseError: The driver is not in the class. No file is written then.
    """
    tokens: dict[str, str] = {}
    if (folder / TOKENS).exists():
        with (folder / TOKENS).open(encoding="utf-8", newline="") as file:
            stored_tokens = {row.get("student", ""): row.get("token", "") for row in csv.DictReader(file)}
        tokens = {
            student: token
            for student, token in stored_tokens.items()
            if re.fullmatch(r"[\w-]{16,}", token or "")
        }
    before = [student for student in tokens if student != THE_ROBOT]
    ids = [THE_ROBOT, *(read_class(roster, id_column) if roster else before or [GUEST])]
    names = _ros_names(ids)
    users = [GatewayUser(one, names[one], tokens.get(one) or secrets.token_urlsafe(18)) for one in ids]
    if driver:
        find_student(users, driver)
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(("student", "name", "token", "address"))
    rows.writerows((user.student, user.name, user.token, user.address(place)) for user in users)
    write_atomically(folder / TOKENS, text.getvalue().encode(), PRIVATE)
    lines = "".join(f"{user.name}:{user.token}\n" for user in users)
    write_atomically(folder / PASSWORDS, lines.encode(), PRIVATE)
    return users


def find_student(users: Sequence[GatewayUser], query: str) -> GatewayUser:
    """Return the student with an ID or a name.

    Raises:
        CourseError: The student does not exist.
    """
    folded_query = query.strip().casefold()
    for user in users:
        if user.name != ROBOT and folded_query in (user.student.casefold(), user.name):
            return user
    if [user.student for user in users if user.name != ROBOT] == [GUEST]:
        raise CourseError(
            f"--driver {query}: this folder has no class, and no gateway runs in it. Start the gateway "
            "with --students CSV, or pass the --folder of the one that runs"
        )
    raise CourseError(
        f"--driver {query}: no such student. The file {TOKENS} in the gateway's folder lists all "
        "IDs in its column `student`."
    )


def _ros_names(ids: Iterable[str]) -> dict[str, str]:
    """Return a unique ROS name for each ID, from lower-case letters, digits and single underscores."""
    names: dict[str, str] = {}
    for one in ids:
        plain = re.sub(r"[^a-z0-9]+", "_", one.casefold()).strip("_")
        name = plain if plain[:1].isalpha() else f"s{plain}"
        while name in names.values():
            name += "x"
        names[one] = name
    return names
