import csv
import stat
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.gateway.access import checked_names
from course_lib.gateway.students import PASSWORDS, TOKENS, class_of, named

PLACE = "tls/lab.example:7448"


def with_roster(folder: Path, *ids: str) -> Path:
    path = folder / "roster.csv"
    path.write_text("Full name,ID number\n" + "".join(f"Somebody,{one}\n" for one in ids))
    return path


def test_every_student_has_a_token_and_a_ros_name_of_their_own(tmp_path: Path) -> None:
    roster = with_roster(tmp_path, "1234", "a.b", "a-b", "robot", "é1")
    users = class_of(tmp_path, roster, "", PLACE)
    assert [user.student for user in users] == ["(robot)", "1234", "a.b", "a-b", "robot", "é1"]
    assert [user.name for user in users] == ["robot", "s1234", "a_b", "a_bx", "robotx", "s1"]
    assert len({user.token for user in users}) == len(users)
    rows = list(csv.DictReader((tmp_path / TOKENS).open(encoding="utf-8")))
    assert rows[1] == {
        "student": "1234",
        "name": "s1234",
        "token": users[1].token,
        "address": f"tls/s1234:{users[1].token}@lab.example:7448",
    }


def test_tokens_stay_when_the_gateway_starts_again_and_when_a_student_joins(tmp_path: Path) -> None:
    before = class_of(tmp_path, with_roster(tmp_path, "a1", "b2"), "", PLACE)
    assert class_of(tmp_path, None, "", PLACE) == before
    assert class_of(tmp_path, with_roster(tmp_path, "a1", "b2", "c3"), "", PLACE)[:3] == before


def test_only_their_owner_can_read_the_tokens(tmp_path: Path) -> None:
    (tmp_path / TOKENS).write_text("student,name,token,address\n")
    (tmp_path / TOKENS).chmod(0o644)
    class_of(tmp_path, None, "", PLACE)
    assert {stat.S_IMODE((tmp_path / name).stat().st_mode) for name in (TOKENS, PASSWORDS)} == {0o600}


def test_without_a_roster_there_is_one_guest(tmp_path: Path) -> None:
    assert [user.student for user in class_of(tmp_path, None, "", PLACE)] == ["(robot)", "guest"]


@pytest.mark.parametrize("who", ["robot", "(robot)", "zed", ""])
def test_who_is_no_student_cannot_drive(tmp_path: Path, who: str) -> None:
    users = class_of(tmp_path, with_roster(tmp_path, "a1"), "", PLACE)
    with pytest.raises(CourseError, match="no such student"):
        named(users, who)
    assert named(users, " A1 ").student == "a1"


@pytest.mark.parametrize("ids", [[], ["a1", "A1"]])
def test_a_roster_that_names_nobody_or_somebody_twice_is_refused(tmp_path: Path, ids: list[str]) -> None:
    with pytest.raises(CourseError, match="ID number"):
        class_of(tmp_path, with_roster(tmp_path, *ids), "ID number", PLACE)


@pytest.mark.parametrize("name", ["cmd_vel", "/", "/a/", "/a//b", "/*", "/a/**", "/1a", "/@adv", ""])
def test_names_that_are_not_full_ros_names_are_refused(name: str) -> None:
    with pytest.raises(CourseError, match="full ROS name"):
        checked_names([name], "--send")
    assert checked_names(["/robot1/cmd_vel"], "--send") == ["robot1/cmd_vel"]
