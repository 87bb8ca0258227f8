import pytest

from course_lib.errors import CourseError
from course_lib.ros.zenoh.login import Login, Wheel, gateway_key, parted, read_gateway_key
from course_lib.ros.zenoh.session import open_session
from tests.ros.zenoh.conftest import free_port


@pytest.mark.parametrize(
    ("address", "place", "login"),
    [
        ("tcp/192.168.1.5:7447", "tcp/192.168.1.5:7447", Login()),
        ("tcp/ann:a-B_1@lab.example:7448", "tcp/lab.example:7448", Login("ann", "a-B_1")),
        ("tls/s12:x@[::1]:7448", "tls/[::1]:7448", Login("s12", "x")),
        ("tcp/:x@lab:1", "tcp/:x@lab:1", Login()),
    ],
)
def test_an_address_is_parted_from_its_login(address: str, place: str, login: Login) -> None:
    assert parted(address) == (place, login)


def test_what_a_student_sends_goes_below_the_students_name() -> None:
    ann = Login("ann", "x")
    assert ann.outward("/cmd_vel") == "/students/ann/cmd_vel"
    assert ann.outward("/students/ann/cmd_vel") == "/students/ann/cmd_vel"
    assert Login().outward("/cmd_vel") == Login("robot", "x").outward("/cmd_vel") == "/cmd_vel"


def test_only_a_login_is_shown_to_the_gateway_and_only_tls_needs_certificates() -> None:
    assert Login().settings("tcp/a:1") == {}
    assert Login().presence("z") == ""
    ann = Login("ann", "x")
    assert ann.presence("z") == "@course/ann/z"
    assert ann.settings("tcp/a:1") == {"transport/auth/usrpwd": {"user": "ann", "password": "x"}}


def test_a_gateway_that_refuses_a_login_is_not_called_a_robot() -> None:
    with pytest.raises(CourseError, match="No gateway lets ann in at tcp/"):
        open_session(f"tcp/127.0.0.1:{free_port()}", Login("ann", "x"))


@pytest.mark.parametrize(
    ("driver", "topics", "key"),
    [
        ("ann", ["cmd_vel", "arm/goal"], "@course/GATEWAY/ann/cmd_vel,arm%goal"),
        ("", [], "@course/GATEWAY/-/-"),
    ],
)
def test_a_gateways_token_has_the_driver_and_the_topics(driver: str, topics: list[str], key: str) -> None:
    assert gateway_key(driver, topics) == key
    assert read_gateway_key(key) == (driver, [f"/{topic}" for topic in topics])


def test_a_student_learns_once_for_each_driver_what_is_not_passed_on() -> None:
    lines: list[str] = []
    wheel = Wheel(Login("bob", "x"), lines.append)
    wheel.sent("/cmd_vel")  # before the gateway has told
    for driver in ("ann", "", "bob"):
        for _ in range(3):
            wheel.change(driver, ["/cmd_vel"])
            wheel.sent("/cmd_vel")
            wheel.sent("/note")
            wheel.sent("/students/bob/own")
    assert lines == [
        "ann drives: your /cmd_vel is not passed on to the robot. The instructor chooses the driver.",
        "The gateway does not pass /note on to the robot: others hear it as /students/bob/note.",
        "Nobody drives: your /cmd_vel is not passed on to the robot. The instructor chooses the driver.",
        "You drive now: your /cmd_vel goes to the robot.",
    ]
    assert wheel.rows() == [("driver", "you")]


def test_the_driver_and_a_link_without_a_gateway_learn_nothing() -> None:
    lines: list[str] = []
    driver, direct = Wheel(Login("ann", "x"), lines.append), Wheel(Login(), lines.append)
    driver.change("ann", ["/cmd_vel"])
    for wheel in (driver, direct):
        wheel.sent("/cmd_vel")
    assert not lines
    assert not direct.rows()
