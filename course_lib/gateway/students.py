"""The students of a gateway and their tokens, in a folder that nobody else can read."""

import csv
import io
import re
import secrets
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.handin.roster import read_class
from course_lib.ros.zenoh.login import ROBOT

TOKENS, PASSWORDS, DRIVER = "tokens.csv", "passwords.txt", "driver.txt"  # the files of the folder
PRIVATE = 0o600
GUEST = "guest"  # who connects where there is no roster
THE_ROBOT = f"({ROBOT})"  # instead of an ID; no ID has parentheses


@dataclass(frozen=True)
class Access:
    """One user of the gateway.

    Args:
        student: The ID of the roster.
        name: The ID as a part of ROS names; the user's name on the link.
        token: The password on the link.
    """

    student: str
    name: str
    token: str

    def address(self, place: str) -> str:
        """Return what the student connects to, like tcp/ann:TOKEN@lab.example:7448."""
        protocol, _, host = place.partition("/")
        return f"{protocol}/{self.name}:{self.token}@{host}"


def class_of(folder: Path, roster: Path | None, id_column: str, place: str) -> list[Access]:
    """Return the robot and the class, with tokens that stay the same; write the private files.

    Args:
        folder: Where tokens are kept.
        roster: A platform's CSV; None for the class that is in the folder, or for one guest.
        id_column: The heading of the IDs; "" to find the column.
        place: Where students connect, to be handed out with the token.
    """
    known = _kept_tokens(folder / TOKENS)
    before = [student for student in known if student != THE_ROBOT]
    ids = [THE_ROBOT, *(read_class(roster, id_column) if roster else before or [GUEST])]
    names = _ros_names(ids)
    users = [Access(one, names[one], known.get(one) or secrets.token_urlsafe(18)) for one in ids]
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(("student", "name", "token", "address"))
    rows.writerows((user.student, user.name, user.token, user.address(place)) for user in users)
    write_whole(folder / TOKENS, text.getvalue().encode(), PRIVATE)
    lines = "".join(f"{user.name}:{user.token}\n" for user in users)
    write_whole(folder / PASSWORDS, lines.encode(), PRIVATE)
    return users


def named(users: Sequence[Access], who: str) -> Access:
    """Return the student of an ID or a name.

    Raises:
        CourseError: There is none.
    """
    wanted = who.strip().casefold()
    for user in users:
        if user.name != ROBOT and wanted in (user.student.casefold(), user.name):
            return user
    raise CourseError(f"--driver {who}: no such student here. The column `student` of {TOKENS} has all IDs.")


def _kept_tokens(path: Path) -> dict[str, str]:
    if not path.exists():
        return {}
    with path.open(encoding="utf-8", newline="") as file:
        kept = {row.get("student", ""): row.get("token", "") for row in csv.DictReader(file)}
    return {student: token for student, token in kept.items() if re.fullmatch(r"[\w-]{16,}", token or "")}


def _ros_names(ids: Iterable[str]) -> dict[str, str]:
    """Return a ROS name for each ID: small letters, digits, single underscores; none twice."""
    names: dict[str, str] = {}
    for one in ids:
        plain = re.sub(r"[^a-z0-9]+", "_", one.casefold()).strip("_")
        name = plain if plain[:1].isalpha() else f"s{plain}"
        while name in names.values():
            name += "x"
        names[one] = name
    return names
