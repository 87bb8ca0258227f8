import pytest

from course_lib.ros.zenoh.login import Login, parted


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
