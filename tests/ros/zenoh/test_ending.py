"""The end of a link: no thread may be in Zenoh, or in a handler of it, when Python exits."""

import threading
from collections.abc import Callable

import pytest

from course_lib.ros.robot.sending import OutgoingTraffic
from course_lib.ros.time import wall
from course_lib.ros.zenoh.link import Handlers, ZenohLink, open_session
from tests.patience import PATIENCE, join
from tests.ros.zenoh.conftest import Kits
from tests.ros.zenoh.test_two_kits import client, listener, serve

LONG = 0.3  # [s]


def wait_for(state: Callable[[], object]) -> None:
    end = wall.monotonic() + PATIENCE
    while not state():
        assert wall.monotonic() < end
        wall.sleep(0.01)


@pytest.mark.slow
def test_end_of_a_session_waits_for_a_running_handler(router: str) -> None:
    handlers, done = Handlers(), list[str]()

    def handle(_: object) -> None:
        done.append("begun")
        wall.sleep(LONG)
        done.append("ended")

    session = open_session(router)
    kept = session.declare_subscriber("a", handlers.wrap(handle))
    with open_session(router) as other:

        def begun() -> bool:
            if not done:
                other.put("a", b"x")
                wall.sleep(0.05)
            return bool(done)

        wait_for(begun)
        session.close()
        handlers.wait()
    assert done.count("begun") == done.count("ended")
    del kept


def test_all_handlers_have_ended_when_a_link_is_closed(kits: Kits) -> None:
    student = kits.join(send="/chatter", call="/reset")
    listener(student, "/chatter")
    client(student, "/reset")
    serve(student, "/reset")
    kits.leave(student)
    assert isinstance(student.link, ZenohLink)
    assert student.link.handlers.alive_count == 0


def test_second_close_of_a_link_waits_for_the_first() -> None:
    sending, begun, ended = OutgoingTraffic(), threading.Event(), list[str]()

    def end() -> None:
        begun.set()
        wall.sleep(LONG)
        ended.append("ended")

    first = threading.Thread(target=sending.close, args=(end,), daemon=True)
    first.start()
    assert begun.wait(PATIENCE)
    sending.close(lambda: None)
    assert ended == ["ended"]
    join(first)
