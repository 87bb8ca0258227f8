"""`course router` in its own process, with raw Zenoh on both sides."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import zenoh

from course_lib.errors import CourseError
from course_lib.gateway.gateway import GatewayUser, Settings, load_users, router
from tests.gateway.conftest import ROSTER, Opened, hears, wait_for
from tests.gateway.test_driving import AHEAD, KEY, STAND
from tests.patience import PATIENCE
from tests.ports import free_port
from tests.processes import Program

Started = Callable[..., Path]
OPEN = """
import sys, time, zenoh
config = zenoh.Config()
for line in sys.argv[3:]:
    config.insert_json5(*line.split("=", 1))
session = zenoh.open(config)
"""
DRIVING = f"""{OPEN}
while True:
    session.put(sys.argv[1], bytes.fromhex(sys.argv[2]))
    time.sleep(0.05)
"""
FLOODING = f"""{OPEN}
publisher = session.declare_publisher(sys.argv[1], congestion_control=zenoh.CongestionControl.BLOCK)
for number in range(10**9):
    publisher.put(bytes(900_000))
    if number == 100:
        print("floods", flush=True)
"""
LISTENING = f"""{OPEN}
heard = session.declare_subscriber(sys.argv[1], zenoh.handlers.Callback(lambda _: None, indirect=False))
print("listens", flush=True)
time.sleep(1000)
"""


@pytest.fixture
def started(tmp_path: Path) -> Iterator[Started]:
    processes: list[Program] = []

    def start(*words: str) -> Path:
        log = tmp_path / f"log{len(processes)}.txt"
        with log.open("wb") as out:
            command = [sys.executable, "-m", "course_lib", *words]
            environment = {**os.environ, "PYTHONFAULTHANDLER": "1"}
            processes.append(Program(command, cwd=tmp_path, stdout=out, stderr=out, env=environment))
        return log

    yield start
    assert [_interrupted(process) for process in processes] == [0] * len(processes), "".join(
        log.read_text() for log in sorted(tmp_path.glob("log*.txt"))
    )


def _interrupted(process: Program) -> int:
    """Return the exit code after Ctrl+C. A continuing process dumps its threads and is killed."""
    process.send_signal(signal.SIGINT)
    try:
        return process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGABRT)
        return process.wait(PATIENCE)


def says(log: Path, text: str) -> None:
    wait_for(lambda: text in log.read_text(), f"{text!r} in {log.read_text()!r}")


def course(folder: Path, *words: str) -> str:
    command = [sys.executable, "-m", "course_lib", *words]
    process = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    return process.stdout + process.stderr


def users_in(folder: Path) -> list[GatewayUser]:
    return load_users(folder / "course_router", None, "", "tcp/anywhere:1")


@pytest.fixture
def routed(tmp_path: Path, started: Started, opened: Opened) -> tuple[str, zenoh.Session, Path]:
    """Start a robot and `course router`; return the students' address, the robot's session and the log."""
    (tmp_path / "roster.csv").write_text(ROSTER)
    place, there = (f"tcp/127.0.0.1:{free_port()}" for _ in range(2))
    robot = opened(mode="router", **{"listen/endpoints": [there]})
    words = ("--listen", place, "--send", "/cmd_vel", "--students", "roster.csv", "--robot", there)
    log = started("router", *words)
    says(log, "router is linked")
    return place, robot, log


Routed = tuple[str, zenoh.Session, Path]


@pytest.mark.slow
def test_driver_command_changes_the_driver_and_the_page(
    tmp_path: Path, routed: Routed, opened: Opened
) -> None:
    place, _, log = routed
    assert "nobody drives" in log.read_text()
    assert "now has the driver 1234" in course(tmp_path, "router", "--driver", "1234")
    says(log, "1234 drives")
    reply = course(tmp_path, "router", "--driver", "zed")
    assert "zed: no such student" in reply
    assert "now has the driver" not in reply
    driver = tmp_path / "course_router" / "driver.txt"
    assert driver.read_text() == "1234"
    driver.write_text("zed")
    says(log, "zed: no such student")
    driver.unlink()
    course(tmp_path, "router", "--driver", "b.1")
    says(log, "b.1 drives")
    course(tmp_path, "router", "--driver", "1234")
    ann = opened(place, users_in(tmp_path)[1])
    alive = ann.liveliness().declare_token(f"@course/s1234/{ann.zid()}")
    address = (tmp_path / "course_router" / "page.txt").read_text()

    def page() -> str:
        with urllib.request.urlopen(address, timeout=PATIENCE) as answer:
            return str(answer.read().decode())

    wait_for(lambda: "yes, 1 kit" in page(), "the page has Ann's kit")
    wait_for(lambda: "<h1>Gateway: 1234 drives</h1>" in page(), "the page names the driver")
    with pytest.raises(urllib.error.HTTPError):
        urllib.request.urlopen(address.rsplit("/", 2)[0] + "/", timeout=PATIENCE)
    del alive  # until here it is there


def student_process(code: str, place: str, user: GatewayUser, key: str) -> Program:
    settings = {
        "mode": "client",
        "connect/endpoints": [place],
        "scouting/multicast/enabled": False,
        "transport/shared_memory/enabled": False,  # as over a network
        "transport/auth/usrpwd": {"user": user.name, "password": user.token},
    }
    lines = [f"{name}={json.dumps(value)}" for name, value in settings.items()]
    command = [sys.executable, "-c", code, key, AHEAD.hex(), *lines]
    return Program(command, stdout=subprocess.PIPE)


@pytest.mark.slow
def test_stuck_and_flooding_students_do_not_delay_others(
    tmp_path: Path, routed: Routed, opened: Opened
) -> None:
    place, robot, _ = routed
    _, ann, bob = users_in(tmp_path)
    session = opened(place, ann)
    scans = hears(session, "0/scan/**")
    stuck = student_process(LISTENING, place, bob, "0/students/**")
    assert stuck.read_line() == "listens\n"
    flood = student_process(FLOODING, place, bob, f"0/students/{bob.name}/flood/t/h")
    assert flood.read_line() == "floods\n"
    wait_for(lambda: robot.put("0/scan/t/h", b"first") or scans, "scans arrive")
    stuck.send_signal(signal.SIGSTOP)
    try:
        for number in range(60):  # its link is full after a few; Zenoh would wait 5 s for it
            session.put(f"0/students/{ann.name}/{KEY}", AHEAD)  # to the full link, too
            time.sleep(0.05)
            robot.put("0/scan/t/h", str(number).encode())
            wait_for(lambda n=number: scans[-1][1] == str(n).encode(), "a scan", patience=3.0)  # type: ignore[misc]
    finally:
        for process in (flood, stuck):
            process.kill()
            process.wait()


def test_robot_stops_when_the_driver_process_is_killed(tmp_path: Path, routed: Routed) -> None:
    place, robot, log = routed
    received = hears(robot, "0/cmd_vel/**")
    course(tmp_path, "router", "--driver", "b.1")
    bob = users_in(tmp_path)[2]
    process = student_process(DRIVING, place, bob, f"0/students/{bob.name}/{KEY}")
    wait_for(lambda: len(received) > 5, "Bob drives")
    process.kill()
    process.wait()
    wait_for(lambda: received[-1][1] == STAND, "the robot stops")
    assert "Traceback" not in log.read_text()


@pytest.mark.slow
def test_gateway_reconnects_to_a_restarted_robot_router(
    tmp_path: Path, started: Started, opened: Opened
) -> None:
    place, there = (f"tcp/127.0.0.1:{free_port()}" for _ in range(2))
    log = started("router", "--listen", place, "--robot", there)
    says(log, "guest drives")
    student = opened(place, users_in(tmp_path)[1])
    received = hears(student, "0/**")
    for times in range(1, 4):
        robot = opened(mode="router", **{"listen/endpoints": [there]})
        wait_for(lambda n=times: log.read_text().count("is linked") == n, "the link")  # type: ignore[misc]
        received.clear()

        def scanned(robot: zenoh.Session = robot) -> bool:
            robot.put("0/scan/t/h", b"scan")
            return len(received) > 0

        wait_for(scanned, "a scan arrives")
        robot.close()
        wait_for(lambda n=times: log.read_text().count("is lost") == n, "its loss")  # type: ignore[misc]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("openssl") is None, reason="no openssl on this machine")
def test_students_connect_only_by_tls_if_a_certificate_is_set(
    tmp_path: Path, started: Started, opened: Opened
) -> None:
    subject = (
        "-subj",
        "/CN=localhost",
        "-addext",
        "subjectAltName=DNS:localhost",
        "-addext",
        "basicConstraints=critical,CA:FALSE",
    )
    made = ("openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", *subject)
    files = ("-keyout", "key.pem", "-out", "cert.pem")
    subprocess.run([*made, *files], cwd=tmp_path, check=True, capture_output=True, timeout=PATIENCE)
    port = free_port()
    log = started(
        "router", "--listen", f"tls/127.0.0.1:{port}", "--certificate", "cert.pem", "--key", "key.pem",
        "--robot", f"tcp/127.0.0.1:{free_port()}",
    )  # fmt: skip
    says(log, "guest drives")
    guest = users_in(tmp_path)[1]
    trusted: dict[str, Any] = {"transport/link/tls": {"root_ca_certificate": str(tmp_path / "cert.pem")}}
    student = opened(f"tls/localhost:{port}", guest, **trusted)
    wait_for(lambda: [*student.info.routers_zid()], "the guest is in")
    with pytest.raises(zenoh.ZError):
        opened(f"tcp/127.0.0.1:{port}", guest)
    with pytest.raises(zenoh.ZError):
        opened(f"tls/localhost:{port}", guest)  # the certificate is not trusted


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--send", "cmd_vel"), "--send cmd_vel: expected a full ROS name"),
        (("--listen", "tls/127.0.0.1:1"), "use a certificate with tls"),
        (("--certificate", "cert.pem"), "TLS needs two files"),
        (("--driver", "zed"), "--driver zed: this folder has no class"),
        (("--listen", "tcp/203.0.113.1:7448"), "can't listen at tcp/203.0.113.1:7448"),
        (("--students", "missing.csv"), "missing.csv can't be read"),
    ],
)
def test_invalid_options_are_reported_in_one_line(
    tmp_path: Path, words: tuple[str, ...], message: str
) -> None:
    output = course(tmp_path, "router", "--robot-port", str(free_port()), *words)
    assert message in output
    assert output.count("\n") == 1


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (Settings("tcp/0.0.0.0:7448", "dds/127.0.0"), "an IPv4 address has four numbers"),
        (Settings("tcp/0.0.0.0:7448", "tcp/"), "'tcp/' is not an address of a robot"),
        (Settings("tcp/0.0.0.0:7448", "tcp/lab:99999"), "'tcp/lab:99999' is not an address of a robot"),
        (Settings("tcp/0.0.0.0:7448", "x y"), "'x y' is not an address of a robot"),
        (Settings("0.0.0.0:7448", "dds/127.0.0.1"), "write it like tcp/0.0.0.0:7448"),
        (Settings("tcp/", "dds/127.0.0.1"), "write it like tcp/0.0.0.0:7448"),
    ],
)
def test_malformed_address_is_reported_before_a_file_is_written(
    tmp_path: Path, settings: Settings, message: str
) -> None:
    with pytest.raises(CourseError, match=message):
        router(settings, tmp_path / "course_router", None, "", "", print)
    assert not any(tmp_path.iterdir())


@pytest.mark.slow
def test_robot_on_the_gateway_computer_connects_to_the_printed_port(
    tmp_path: Path, started: Started, opened: Opened
) -> None:
    place, port = f"tcp/127.0.0.1:{free_port()}", free_port()
    there = f"tcp/127.0.0.1:{port}"
    log = started("router", "--listen", place, "--robot-port", str(port))
    says(log, f"for its nodes:  export ZENOH_CONFIG_OVERRIDE='connect/endpoints=[\"{there}\"]'")
    says(log, "for rmw_zenohd:   export ZENOH_CONFIG_OVERRIDE='connect/endpoints=[\"tcp/")
    says(log, "guest drives")
    output = course(tmp_path, "router", "--listen", f"tcp/127.0.0.1:{free_port()}", "--robot-port", str(port))
    assert f"can't listen at {there}" in output
    assert "Choose another one with --robot-port" in output
    nodes = {"listen/endpoints": ["tcp/127.0.0.1:0"], "scouting/gossip/enabled": True}  # as rmw_zenoh has it
    sensor, controller = (opened(there, mode="peer", **nodes) for _ in range(2))
    student = opened(place, users_in(tmp_path)[1])
    beside, behind = hears(controller, "0/scan/**"), hears(student, "0/scan/**")

    def scanned() -> bool:
        sensor.put("0/scan/t/h", b"scan")
        return bool(beside and behind)

    wait_for(scanned, "a robot's node hears the other one, and so does the student")
