"""RViz's tools in a real page: clicks and drags are published."""

import pytest
from geometry_msgs.msg import PointStamped, PoseStamped, PoseWithCovarianceStamped

from tests.browser.bench import Bench

pytestmark = pytest.mark.browser


def test_dragged_goal_pose_is_published_as_in_rviz(bench: Bench) -> None:
    bench.viewer.view = type(bench.viewer.view)(yaw=-1.5707963, focal_point=(1.0, 2.0, 0.0))  # y is up
    bench.widget.flush()
    bench.host.carry()
    bench.page.locator("canvas").press("g")
    bench.drag((0, 0), (0, -20), (0, -60))
    goal = bench.message("/goal_pose", PoseStamped)
    assert goal.header.frame_id == "map"
    at, turn = goal.pose.position, goal.pose.orientation
    assert (at.x, at.y, at.z) == pytest.approx((1.0, 2.0, 0.0), abs=0.02)
    assert (turn.x, turn.y, turn.z, turn.w) == pytest.approx((0, 0, 0.5**0.5, 0.5**0.5), abs=0.02)
    assert bench.page.get_by_role("button", name="Interact (i)").get_attribute("aria-pressed") == "true"


def test_right_drag_zooms_without_the_menu_of_the_surrounding_page(bench: Bench) -> None:
    before = bench.viewer.view["Distance"]
    # As JupyterLab does.
    count = "() => (window.menus = 1)"
    bench.page.evaluate(f"document.addEventListener('contextmenu', {count})")
    bench.drag((200, 0), (200, 40), button="right")
    bench.host.wait_until(lambda: bench.viewer.view["Distance"] > before)
    assert bench.page.evaluate("window.menus") is None


@pytest.mark.slow
def test_pose_estimate_has_the_covariance_of_rviz(bench: Bench) -> None:
    bench.page.locator("canvas").press("p")
    bench.drag((0, 0), (40, 0))
    covariance = bench.message("/initialpose", PoseWithCovarianceStamped).pose.covariance
    assert {i: value for i, value in enumerate(covariance) if value} == {
        0: 0.25, 7: 0.25, 35: 0.06853891909122467,
    }  # fmt: skip


@pytest.mark.slow
def test_clicked_point_on_an_object_is_published(bench: Bench) -> None:
    bench.press("Publish Point (u)")
    bench.drag((0, 0))
    point = bench.message("/clicked_point", PointStamped)
    assert point.header.frame_id == "map"
    assert max(abs(point.point.x), abs(point.point.y), abs(point.point.z)) == pytest.approx(0.5, abs=0.01)


@pytest.mark.slow
def test_escape_returns_to_the_interact_tool(bench: Bench) -> None:
    canvas = bench.page.locator("canvas")
    canvas.press("n")
    assert bench.page.get_by_role("button", name="Measure (n)").get_attribute("aria-pressed") == "true"
    canvas.press("Escape")
    assert bench.page.get_by_role("button", name="Interact (i)").get_attribute("aria-pressed") == "true"


@pytest.mark.slow
def test_selected_object_shows_its_message_and_frame(bench: Bench) -> None:
    bench.press("Views panel")
    bench.page.locator("canvas").press("s")
    bench.drag((0, 0))
    assert "in frame 'map'" in bench.page.get_by_label("Selection").inner_text()
    assert "frame_id: map" in bench.page.get_by_label("Selection").inner_text()


@pytest.mark.slow
def test_selection_is_in_sight_in_a_narrow_view(bench: Bench) -> None:
    bench.page.evaluate("document.querySelector('.course-viewer').style.width = '500px'")
    bench.page.locator("canvas").press("s")
    bench.drag((0, 0))
    selection = bench.page.get_by_label("Selection")
    panel = bench.page.get_by_role("region", name="Views")
    top, above = (element.bounding_box() for element in (selection, panel))
    assert top is not None
    assert above is not None
    assert above["y"] - 1 <= top["y"] <= above["y"] + above["height"] / 2


@pytest.mark.slow
def test_measure_tool_reports_the_distance(bench: Bench) -> None:
    bench.page.locator("canvas").press("n")
    bench.drag((0, 0))
    bench.drag((10, 0))
    assert "[Length: 0." in bench.page.locator(".course-notice").inner_text()


@pytest.mark.slow
def test_measure_tool_shows_the_distance_to_the_pointer_after_the_first_click(bench: Bench) -> None:
    bench.page.locator("canvas").press("n")
    bench.drag((0, 0))
    notice = bench.page.locator(".course-notice")
    assert "Length" not in notice.inner_text()
    bench.hover((10, 0))
    near = float(notice.inner_text().split("m]")[0].removeprefix("[Length: "))
    bench.hover((30, 0))
    assert float(notice.inner_text().split("m]")[0].removeprefix("[Length: ")) > 2 * near > 0


@pytest.mark.slow
def test_goal_keeps_its_direction_when_the_pointer_leaves_the_ground(bench: Bench) -> None:
    bench.viewer.view = type(bench.viewer.view)(yaw=-1.5707963, pitch=0.1)  # the horizon is visible
    bench.widget.flush()
    bench.host.carry()
    bench.page.locator("canvas").press("g")
    bench.drag((0, 20), (0, 10), (0, -180))
    turn = bench.message("/goal_pose", PoseStamped).pose.orientation
    assert (turn.z, turn.w) == pytest.approx((0.5**0.5, 0.5**0.5), abs=0.02)


@pytest.mark.slow
def test_focus_tool_looks_in_the_direction_of_a_click_that_hits_no_object(bench: Bench) -> None:
    before = bench.viewer.view["Distance"]
    bench.page.locator("canvas").press("c")
    bench.drag((250, -130))
    bench.host.wait_until(lambda: bench.viewer.view["Distance"] == pytest.approx(1.0))
    assert before > 1


@pytest.mark.slow
def test_clicks_reach_python_and_the_canvas_has_a_text_description(bench: Bench) -> None:
    paths: list[str | None] = []
    bench.viewer.on_click(lambda click: paths.append(click.path))
    bench.drag((0, 0))
    assert [path and path.split("/")[1] for path in paths] == ["Marker"]
    described = bench.page.locator("canvas").get_attribute("aria-describedby")
    assert "Fixed frame map" in (bench.page.locator(f"#{described}").text_content() or "")


@pytest.mark.slow
def test_tool_properties_are_edited_in_the_views_panel(bench: Bench) -> None:
    bench.press("Views panel")
    bench.page.get_by_text("Tool Properties", exact=True).click()
    bench.row("2D Goal Pose").press("ArrowRight")
    field = bench.page.get_by_role("textbox", name="Topic")
    field.fill("/my_goal")
    field.press("Enter")
    bench.host.carry()
    assert bench.viewer.session.tools[6]["Topic"] == "/my_goal"
