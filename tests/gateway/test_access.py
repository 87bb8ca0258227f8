"""Raw Zenoh code of a student: only permitted messages reach the robot."""

import random

import pytest
import zenoh
from zenoh.handlers import Callback

from tests.gateway.conftest import Classroom, Opened, hears, sees_tokens, wait_for

TYPE = "geometry_msgs::msg::dds_::Twist_/RIHS01_" + "0" * 64
ATTEMPTS = 1000
KEYS = (
    "0/cmd_vel/{t}", "0/arm/{t}", "0/scan/{t}", "0/tf/{t}", "0/**", "**", "*/cmd_vel/**", "0/cmd_vel/**",
    "0/students/b_1/cmd_vel/{t}", "0/students/*/cmd_vel/{t}", "0/students/s1234/cmd_vel/{t}/@adv/pub/x/1/_",
    "0/cmd_vel/{t}/@adv/pub/x/1/_", "0/map/{t}/@adv/**", "@ros2_lv/0/x/0/0/NN/%/%/base", "@/**",
    "@course/b_1/x", "1/cmd_vel/{t}", "cmd_vel", "0/cmd_vel", "0$*/cmd_vel/{t}", "0/students/s1234/**",
    "0/students/s1234/cmd_vel/{t}",
)  # fmt: skip
SERVICES = ("0/arm/t/h", "0/reset_all/t/h", "0/*/t/h", "0/**", "**", "*/arm/t/h", "@/**", "0/reset/**")
TOKENS = (
    "@ros2_lv/0/z/0/1/MP/%/%/evil/%cmd_vel/t/h/q",
    "@ros2_lv/0/z/0/1/MP/%/%/evil/%arm/t/h/q",
    "@ros2_lv/0/z/0/1/MP/%/%/evil/%students%b_1%cmd_vel/t/h/q",
    "@ros2_lv/0/z/0/1/SS/%/%/evil/%reset/t/h/q",
    "@ros2_lv/0/z/0/1/SC/%/%/evil/%arm/t/h/q",
    "0/cmd_vel/t/h/@adv/pub/z/1/_",
    "@course/b_1/z",
)


def ignore(reply: zenoh.Reply) -> None:
    """Do nothing."""


@pytest.mark.sample(1)
@pytest.mark.parametrize("mode", ["client", "peer", "router"])
def test_messages_of_a_student_without_driving_rights_do_not_reach_the_robot(
    classroom: Classroom, mode: str
) -> None:
    chance = random.Random(mode)
    received = hears(classroom.robot, "**", "**/@adv/**", "@ros2_lv/**", "@course/**")
    tokens = sees_tokens(classroom.robot)
    asked: list[str] = []

    def note(query: zenoh.Query) -> None:
        asked.append(str(query.key_expr))

    serving = [
        classroom.robot.declare_queryable(key, Callback(note, indirect=False))
        for key in ("0/arm/t/h", "0/reset_all/t/h", "0/reset/t/h", "1/arm/t/h")
    ]
    student = classroom.student(classroom.ann, mode)
    marker = classroom.robot.liveliness().declare_token("@ros2_lv/0/r/0/0/NN/%/%/base")
    wait_for(lambda: "@ros2_lv/0/r/0/0/NN/%/%/base" in tokens, "the robot sees tokens")
    before = len(tokens)
    kept = []
    for _ in range(ATTEMPTS):
        attempt = chance.choice(("put", "put", "delete", "get", "token"))
        if attempt == "token":
            kept.append(student.liveliness().declare_token(chance.choice(TOKENS)))
        elif attempt == "get":
            student.get(chance.choice(SERVICES), Callback(ignore, indirect=False), payload=b"go", timeout=5)
        else:
            key = chance.choice(KEYS).format(t=TYPE)
            student.put(key, b"go") if attempt == "put" else student.delete(key)
    end_of_queue(classroom, student, asked)
    assert received == []
    assert set(asked) == {"0/reset/t/h"}
    assert [key for key in tokens[before:] if "evil" in key or "@adv" in key or "@course" in key] == []
    del marker, serving, kept  # until here they are there


def end_of_queue(classroom: Classroom, student: zenoh.Session, asked: list[str]) -> None:
    """Wait until an allowed call has passed, behind all attempts on the same link."""
    asked_before = len(asked)

    def arrives() -> bool:
        list(student.get("0/reset/t/h", payload=b"go", timeout=0.4))
        return len(asked) > asked_before

    wait_for(arrives, "an allowed call arrives")


@pytest.mark.slow
def test_student_receives_robot_topics_and_latched_messages(classroom: Classroom, opened: Opened) -> None:
    from zenoh import ext

    latched = ext.declare_advanced_publisher(
        classroom.robot, "0/map/t/h", cache=ext.CacheConfig(max_samples=1), publisher_detection=True
    )
    latched.put(b"map")
    student = classroom.student(classroom.ann)
    live, late = hears(student, "0/scan/**"), list[bytes]()
    history = ext.HistoryConfig(detect_late_publishers=True, max_samples=1)

    def keep(sample: zenoh.Sample) -> None:
        late.append(bytes(sample.payload))

    callback = Callback(keep, indirect=False)
    kept = ext.declare_advanced_subscriber(student, "0/map/t/h", callback, history=history)

    def scanned() -> bool:
        classroom.robot.put("0/scan/t/h", b"scan")
        return len(live) > 0

    wait_for(scanned, "a scan arrives")
    wait_for(lambda: late == [b"map"], "the map arrives")
    assert kept


@pytest.mark.slow
def test_students_may_publish_in_their_namespace_and_other_domains_but_not_as_the_robot(
    classroom: Classroom,
) -> None:
    ann, bob = classroom.student(classroom.ann), classroom.student(classroom.bob)
    received = hears(bob, "**")
    keys = ["0/students/s1234/note/t/h", "7/note/t/h"]

    def talk() -> bool:
        for key in ("0/scan/t/h", "0/students/b_1/note/t/h", *keys):
            ann.put(key, b"hello")
        return {key for key, _ in received} >= set(keys)

    wait_for(talk, "Bob hears Ann")
    assert {key for key, _ in received} == set(keys)


@pytest.mark.slow
@pytest.mark.parametrize("token", ["", "wrong"])
def test_wrong_token_is_rejected(classroom: Classroom, opened: Opened, token: str) -> None:
    from dataclasses import replace

    with pytest.raises(zenoh.ZError):
        opened(classroom.place, replace(classroom.ann, token=token))
    with pytest.raises(zenoh.ZError):
        opened(classroom.place)
