import contextlib
import http.client
import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page
from visualization_msgs.msg import Marker

from course_lib.recording import Recording, write_bag
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize, type_name
from course_lib.viewer.page_server import PageServer
from tests.browser.fake_host import count
from tests.browser.test_page import BLUE, RED, colored, pixels_of
from tests.browser.test_playback import READING, TIME, at_x, scrub
from tests.browser.waiting import wait_until
from tests.patience import PATIENCE
from tests.processes import Program

pytestmark = pytest.mark.browser

LAYOUT = """\
Visualization Manager:
  Global Options: {Fixed Frame: map, Background Color: 0; 0; 0}
  Displays:
    - {Class: rviz_default_plugins/Marker, Name: Marker, Enabled: true, Topic: {Value: /m}}
  Views: {Current: {Class: rviz_default_plugins/TopDownOrtho, Scale: 40}}
"""


def is_free(port: int) -> bool:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        with contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return True
    return False


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    page = browser.new_page(viewport={"width": 900, "height": 600})
    page.set_default_timeout(PATIENCE * 1000)
    yield page
    page.close()


def shows(page: Page, color: tuple[int, int, int]) -> bool:
    page.evaluate(TIME)
    return count(pixels_of(page.screenshot()), color) > 1000


def answer(url: str, headers: dict[str, str]) -> int:
    host, path = url.removeprefix("http://").split("/", 1)
    connection = http.client.HTTPConnection(host, timeout=PATIENCE)
    with contextlib.closing(connection):
        connection.request("GET", f"/{path}", headers=headers)
        return connection.getresponse().status


UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
}
REFUSED: dict[str, tuple[str, dict[str, str]]] = {
    "no token": ("//", {}),
    "a wrong token": ("/wrong/", {}),
    "a wrong token for the socket": ("/wrong/socket", UPGRADE),
    "another name of this machine": ("/secret/", {"Host": "evil.example"}),
    "a page of elsewhere": ("/secret/socket", {**UPGRADE, "Origin": "http://evil.example"}),
}


@pytest.mark.parametrize("who", REFUSED)
def test_request_without_the_printed_address_is_rejected(who: str) -> None:
    server = PageServer(colored(RED), token="secret")
    server.start()
    path, headers = REFUSED[who]
    wait_until(lambda: answer(server.url, {}) == 200)
    assert answer(server.url.removesuffix("/secret/") + path, headers) == 403
    server.close()


@pytest.mark.parametrize("who", [who for who in REFUSED if who != "another name of this machine"])
def test_foreign_host_header_alone_is_accepted_behind_a_hub(
    who: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("JUPYTERHUB_SERVICE_PREFIX", "/user/ada/")
    monkeypatch.setattr("course_lib.host.find_spec", lambda name: name)
    server = PageServer(colored(RED), token="secret")
    server.start()
    here = f"http://127.0.0.1:{server.port}"
    path, headers = REFUSED[who]
    wait_until(lambda: answer(f"{here}/secret/", {"Host": "hub.example"}) == 200)
    assert answer(here + path, headers) == 403
    server.close()


def test_servers_have_different_tokens_and_free_their_ports_when_closed() -> None:
    servers = [PageServer(colored(RED)) for _ in range(2)]
    for server in servers:
        server.start()
    first, second = servers
    assert first.port != second.port
    assert first.token != second.token
    assert not is_free(first.port)
    wait_until(lambda: answer(first.url, {}) == 200)
    for server in servers:
        server.close()
    wait_until(lambda: is_free(first.port) and is_free(second.port))


@pytest.mark.slow
def test_server_closed_before_its_first_response_frees_its_port() -> None:
    for _ in range(20):
        server = PageServer(colored(RED))
        server.start()
        server.close()
        wait_until(partial(is_free, server.port))


def test_occupied_port_is_reported() -> None:
    from course_lib.errors import CourseError

    server = PageServer(colored(RED))
    server.listen()
    with pytest.raises(CourseError, match=f"Port {server.port} is not available"):
        PageServer(colored(RED), port=server.port).listen()


def test_page_updates_with_the_scene_reports_the_end_of_its_program_and_reconnects(page: Page) -> None:
    scene = colored(RED)
    server = PageServer(scene)
    server.start()
    page.goto(server.url)
    wait_until(lambda: shows(page, RED))
    scene.set_transform("box", at_x(30))
    wait_until(lambda: not shows(page, RED))
    server.close()
    page.get_by_role("status").get_by_text("has ended or cannot be reached").wait_for()
    again = PageServer(colored(BLUE), port=server.port, token=server.token)
    again.start()
    page.get_by_text("has ended or cannot be reached").wait_for(state="detached")
    wait_until(lambda: shows(page, BLUE))
    wait_until(lambda: again.link.is_ready)
    again.close()


@pytest.mark.slow
def test_click_and_page_close_are_reported_to_the_program(page: Page) -> None:
    server = PageServer(colored(RED))
    clicks: list[str | None] = []
    server.link.on_click.append(lambda click: clicks.append(click.path))
    server.start()
    page.goto(server.url)
    wait_until(lambda: shows(page, RED))
    page.mouse.click(450, 300)
    wait_until(lambda: clicks == ["box"], page)  # received on the event loop of this thread
    page.goto("about:blank")
    wait_until(lambda: not server.link.is_ready)
    server.close()


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    """A recording in which a red cube moves from left to right in 4 s."""
    samples = []
    for number in range(81):
        marker = Marker(type=Marker.CUBE)
        marker.header.frame_id = "map"
        marker.pose.position.x = -4 + number / 10  # [m]
        marker.scale.x = marker.scale.y = marker.scale.z = 2.0  # [m]
        marker.color.r = marker.color.a = 1.0
        stamp_ns = 10**18 + number * 50_000_000
        samples.append(Sample(stamp_ns, "/m", type_name(marker), serialize(marker), Qos(), 1))
    write_bag(Recording(samples), tmp_path / "bag")
    (tmp_path / "view.rviz").write_text(LAYOUT)
    return tmp_path / "bag"


def course_view(bag: Path, *options: str) -> tuple[Program, str]:
    layout = str(bag.parent / "view.rviz")
    command = [
        sys.executable,
        "-m",
        "course_lib",
        "view",
        "--bag",
        str(bag),
        "--rviz",
        layout,
        "--no-browser",
    ]
    process = Program([*command, *options], stdout=subprocess.PIPE)
    return process, process.find(r"http://\S+")


def sides(page: Page) -> tuple[bool, bool]:
    page.evaluate(TIME)
    red = np.abs(pixels_of(page.screenshot()) - RED).max(axis=-1) < 120
    return bool(red[:, :450].sum() > 500), bool(red[:, 450:].sum() > 500)


def begins_at_the_left(page: Page) -> bool:
    scrub(page, 0.0)  # it continues playing
    return sides(page) == (True, False)


@pytest.mark.slow
def test_course_view_plays_a_bag_with_seeking(page: Page, bag: Path) -> None:
    process, url = course_view(bag)
    try:
        page.goto(url)
        page.get_by_role("button", name="Play (Space)").wait_for()  # it has reached the end
        assert "Elapsed: 4.00 of 4.00" in page.locator(READING).inner_text()
        wait_until(lambda: sides(page) == (False, True))
        scrub(page, 0.0)
        wait_until(lambda: sides(page) == (True, False))
        page.get_by_role("button", name="Loop").click()
        page.get_by_role("button", name="Play (Space)").click()
        page.get_by_role("button", name="Pause").wait_for()
        wait_until(lambda: sides(page) == (False, True))
        wait_until(lambda: sides(page) == (True, False))
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 0
        assert process.stdout is not None
        assert process.stdout.read().splitlines() == ["Ctrl+C ends it.", "", "The viewer has ended."]
        assert is_free(int(url.split(":")[2].split("/")[0]))
    finally:
        process.kill()


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="kills a process as only POSIX can")
def test_page_reconnects_to_a_restarted_course_view_at_the_same_address(page: Page, bag: Path) -> None:
    process, url = course_view(bag)
    port, token = re.findall(r":(\d+)/([^/]+)/", url)[0]
    try:
        page.goto(url)
        page.locator(READING).wait_for()
        process.kill()
        page.get_by_role("status").get_by_text("has ended or cannot be reached").wait_for()
        process, same = course_view(bag, "--port", port, "--token", token)
        assert same == url
        page.get_by_text("has ended or cannot be reached").wait_for(state="detached")
        wait_until(lambda: begins_at_the_left(page))
    finally:
        process.kill()
