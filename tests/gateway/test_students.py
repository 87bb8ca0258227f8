import csv
import stat
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.gateway.gateway import PASSWORDS, TOKENS, find_student, load_users, relative_names

PLACE = "tls/lab.example:7448"


def with_roster(folder: Path, *ids: str) -> Path:
    path = folder / "roster.csv"
    path.write_text("Full name,ID number\n" + "".join(f"Somebody,{one}\n" for one in ids))
    return path


def test_every_student_has_a_unique_token_and_ros_name(tmp_path: Path) -> None:
    roster = with_roster(tmp_path, "1234", "a.b", "a-b", "robot", "é1")
    users = load_users(tmp_path, roster, "", PLACE)
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


def test_tokens_are_kept_when_the_gateway_restarts_or_a_student_is_added(tmp_path: Path) -> None:
    before = load_users(tmp_path, with_roster(tmp_path, "a1", "b2"), "", PLACE)
    assert load_users(tmp_path, None, "", PLACE) == before
    assert load_users(tmp_path, with_roster(tmp_path, "a1", "b2", "c3"), "", PLACE)[:3] == before


def test_token_file_is_readable_only_by_its_owner(tmp_path: Path) -> None:
    (tmp_path / TOKENS).write_text("student,name,token,address\n")
    (tmp_path / TOKENS).chmod(0o644)
    load_users(tmp_path, None, "", PLACE)
    assert {stat.S_IMODE((tmp_path / name).stat().st_mode) for name in (TOKENS, PASSWORDS)} == {0o600}


def test_gateway_without_a_roster_has_one_guest(tmp_path: Path) -> None:
    assert [user.student for user in load_users(tmp_path, None, "", PLACE)] == ["(robot)", "guest"]


def test_unknown_driver_without_a_class_is_an_error_before_a_file_is_written(tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="this folder has no class"):
        load_users(tmp_path / "router", None, "", PLACE, "ann")
    assert not (tmp_path / "router").exists()


@pytest.mark.parametrize("student", ["robot", "(robot)", "zed", ""])
def test_unknown_student_cannot_drive(tmp_path: Path, student: str) -> None:
    users = load_users(tmp_path, with_roster(tmp_path, "a1"), "", PLACE)
    with pytest.raises(CourseError, match="no such student"):
        find_student(users, student)
    assert find_student(users, " A1 ").student == "a1"


@pytest.mark.parametrize("ids", [[], ["a1", "A1"]])
def test_empty_roster_and_duplicate_student_are_rejected(tmp_path: Path, ids: list[str]) -> None:
    with pytest.raises(CourseError, match="ID number"):
        load_users(tmp_path, with_roster(tmp_path, *ids), "ID number", PLACE)


@pytest.mark.parametrize("name", ["cmd_vel", "/", "/a/", "/a//b", "/*", "/a/**", "/1a", "/@adv", ""])
def test_relative_ros_name_is_rejected(name: str) -> None:
    with pytest.raises(CourseError, match="full ROS name"):
        relative_names([name], "--send")
    assert relative_names(["/robot1/cmd_vel"], "--send") == ["robot1/cmd_vel"]
