"""A view at rest in a page: nothing changes it, and it plays what was seen."""

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


def test_a_frozen_view_keeps_its_picture_and_plays_what_was_before(bench: Bench) -> None:
    host, graph, viewer = bench.host, bench.graph, bench.viewer
    for color in ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0)):
        publish(graph, "/m", cube(color))
        wait(graph, 1.0)
        viewer.look()
    host.hide()
    view = viewer.freeze()
    host.open(view)
    host.show(view, 780)
    publish(graph, "/m", cube((0.0, 1.0, 0.0)))
    viewer.look()
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


def test_its_panels_are_read_and_not_edited(bench: Bench) -> None:
    host, page = bench.host, bench.page
    host.hide()
    view = bench.viewer.freeze()
    host.open(view)
    host.show(view, 780)
    bench.press("Displays panel")
    expect(bench.row("Marker")).to_be_visible()
    expect(page.locator(".course-tree input")).to_have_count(0)
    expect(page.get_by_role("button", name="Add a display")).to_be_hidden()
    bench.row("Marker").press("Delete")
    expect(page.get_by_text("This view is at rest. Run its cell again to change it.")).to_be_visible()
    expect(bench.row("Marker")).to_be_visible()
