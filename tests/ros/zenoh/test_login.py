import pytest

from course_lib.errors import CourseError
from course_lib.ros.zenoh.link import (
    DriverReport,
    Login,
    gateway_key,
    open_session,
    read_gateway_key,
    split_login,
)
from tests.ports import free_port


@pytest.mark.parametrize(
    ("address", "place", "login"),
    [
        ("tcp/192.168.1.5:7447", "tcp/192.168.1.5:7447", Login()),
        ("tcp/ann:a-B_1@lab.example:7448", "tcp/lab.example:7448", Login("ann", "a-B_1")),
        ("tls/s12:x@[::1]:7448", "tls/[::1]:7448", Login("s12", "x")),
        ("tcp/:x@lab:1", "tcp/:x@lab:1", Login()),
    ],
)
def test_address_is_split_into_host_and_login(address: str, place: str, login: Login) -> None:
    assert split_login(address) == (place, login)


def test_topics_of_a_student_are_published_under_the_student_namespace() -> None:
    ann = Login("ann", "x")
    assert ann.network_topic("/cmd_vel") == "/students/ann/cmd_vel"
    assert ann.network_topic("/students/ann/cmd_vel") == "/students/ann/cmd_vel"
    assert Login().network_topic("/cmd_vel") == Login("robot", "x").network_topic("/cmd_vel") == "/cmd_vel"


def test_login_is_sent_only_to_the_gateway_and_only_tls_requires_certificates() -> None:
    assert Login().settings("tcp/a:1") == {}
    assert Login().presence_key("z") == ""
    ann = Login("ann", "x")
    assert ann.presence_key("z") == "@course/ann/z"
    assert ann.settings("tcp/a:1") == {"transport/auth/usrpwd": {"user": "ann", "password": "x"}}


@pytest.mark.slow
def test_gateway_that_rejects_a_login_is_not_reported_as_a_robot() -> None:
    with pytest.raises(CourseError, match=r"No gateway at tcp/.* accepts the login of ann"):
        open_session(f"tcp/127.0.0.1:{free_port()}", Login("ann", "x"))


@pytest.mark.parametrize(
    ("driver", "topics", "key"),
    [
        ("ann", ["cmd_vel", "arm/goal"], "@course/GATEWAY/ann/cmd_vel,arm%goal"),
        ("", [], "@course/GATEWAY/-/-"),
    ],
)
def test_gateway_token_contains_the_driver_and_the_topics(driver: str, topics: list[str], key: str) -> None:
    assert gateway_key(driver, topics) == key
    assert read_gateway_key(key) == (driver, [f"/{topic}" for topic in topics])


def test_student_is_notified_once_per_driver_about_topics_not_forwarded() -> None:
    lines: list[str] = []
    report = DriverReport(Login("bob", "x"), lines.append)
    report.on_send("/cmd_vel")  # before the gateway has announced it
    for driver in ("ann", "", "bob"):
        for _ in range(3):
            report.change(driver, ["/cmd_vel"])
            report.on_send("/cmd_vel")
            report.on_send("/note")
            report.on_send("/students/bob/own")
    assert lines == [
        "ann drives: your /cmd_vel is not passed on to the robot. The instructor chooses the driver.",
        "The gateway does not pass /note on to the robot: others hear it as /students/bob/note.",
        "Nobody drives: your /cmd_vel is not passed on to the robot. The instructor chooses the driver.",
        "You drive now: your /cmd_vel goes to the robot.",
    ]
    assert report.status_rows() == [("driver", "you")]


def test_driver_and_link_without_a_gateway_receive_no_notice() -> None:
    lines: list[str] = []
    driver, direct = DriverReport(Login("ann", "x"), lines.append), DriverReport(Login(), lines.append)
    driver.change("ann", ["/cmd_vel"])
    for report in (driver, direct):
        report.on_send("/cmd_vel")
    assert not lines
    assert not direct.status_rows()
