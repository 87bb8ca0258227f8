"""A view after its kernel has ended: it plays its recording, and nothing changes it."""

import pytest
from playwright.sync_api import expect
from visualization_msgs.msg import Marker

from tests.browser.bench import Bench
from tests.browser.fake_host import count
from tests.browser.waiting import wait_until
from tests.displays.bench import marker
from tests.displays.stage import publish, wait

pytestmark = pytest.mark.browser
RED, GREEN = (180, 0, 0), (0, 180, 0)


def cube(color: tuple[float, float, float]) -> Marker:
    made = marker()
    made.scale.x = made.scale.y = made.scale.z = 3.0
    made.color.r, made.color.g, made.color.b = color
    return made


def show_green_then_red(bench: Bench) -> None:
    """Show a cube that is green for 1 s and then red for 1 s, and hide the live view."""
    for color in ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0)):
        publish(bench.graph, "/m", cube(color))
        wait(bench.graph, 1.0)
        bench.viewer.refresh()
    bench.host.hide()


@pytest.mark.slow
def test_frozen_view_keeps_its_image_and_plays_earlier_frames(bench: Bench) -> None:
    host, graph, viewer = bench.host, bench.graph, bench.viewer
    show_green_then_red(bench)
    view = viewer.freeze()
    host.open(view)
    host.show(view, 780)
    publish(graph, "/m", cube((0.0, 1.0, 0.0)))
    viewer.refresh()
    host.carry()
    assert count(host.pixels(), RED) > 1000
    assert count(host.pixels(), GREEN) == 0
    page = host.page
    slider = page.get_by_role("slider", name="Time")
    slider.fill("1.5")
    host.carry()
    assert count(host.pixels(), GREEN) > 1000
    page.get_by_role("button", name="Play (Space)").click()
    wait_until(lambda: count(host.pixels(), RED) > 1000, page)


@pytest.mark.slow
def test_panels_of_a_frozen_view_are_read_only(bench: Bench) -> None:
    host, page = bench.host, bench.page
    host.hide()
    view = bench.viewer.freeze()
    host.open(view)
    host.show(view, 780)
    bench.press("Displays panel")
    bench.row("Marker").wait_for()
    expect(page.locator(".course-tree input")).to_have_count(0)
    page.get_by_role("button", name="Add a display").wait_for(state="hidden")
    bench.row("Marker").press("Delete")
    page.get_by_text("This view is at rest. Run its cell again to change it.").wait_for()
    bench.row("Marker").wait_for()


def test_replay_plays_from_the_start_and_again_without_a_click(bench: Bench) -> None:
    host = bench.host
    show_green_then_red(bench)
    view = bench.viewer.replay(2.0)
    host.open(view)
    host.show(view, 780)
    host.carry()
    wait_until(lambda: count(host.pixels(), GREEN) > 1000, host.page)
    wait_until(lambda: count(host.pixels(), RED) > 1000, host.page)
    wait_until(lambda: count(host.pixels(), GREEN) > 1000, host.page)
