from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Pose, PoseArray, PoseStamped

from course_lib.displays.display import INVALID, Display
from course_lib.viewer.drawables import Lines, Solids
from tests.displays.bench import Bench

QUARTER = float(np.sqrt(0.5))  # of a turn around z: z and w of the quaternion


def pose(x: float = 0.0, turned: bool = False) -> Pose:
    pose = Pose()
    pose.position.x = x
    pose.orientation.z, pose.orientation.w = (QUARTER, QUARTER) if turned else (0.0, 1.0)
    return pose


def stamped(one: Pose, frame: str = "map") -> PoseStamped:
    message = PoseStamped(pose=one)
    message.header.frame_id = frame
    return message


def array(*poses: Pose) -> PoseArray:
    message = PoseArray(poses=list(poses))
    message.header.frame_id = "map"
    return message


def add(bench: Bench, name: str, **properties: Any) -> Display:
    return bench.session.add(f"rviz_default_plugins/{name}", "Shown", {"Topic": "/pose"}, **properties)


def drawables_of(bench: Bench) -> dict[str, Any]:
    """Return the drawables by name."""
    objects = bench.scene.objects().items()
    return {
        path.rpartition("/")[2]: drawable for path, drawable in objects if path.startswith("displays/Shown/")
    }


def extent(bench: Bench, name: str, number: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return the ends of a solid's axis in the fixed frame."""
    solids = drawables_of(bench)[name]
    assert isinstance(solids, Solids)
    transform = bench.scene.world_transform(f"displays/Shown/drawn/{name}") @ solids.placements[number]
    low, high = ((transform @ (0, 0, z, 1))[:3] for z in (-0.5, 0.5))
    return np.round(low, 6), np.round(high, 6)


def test_pose_arrow_points_along_its_x_axis() -> None:
    bench = Bench()
    bench.transform("map", "base", (0.0, 0.0, 1.0))
    add(bench, "Pose")
    bench.publish("/pose", stamped(pose(2.0, turned=True), "base"))
    bench.update()
    (back, middle), (base, tip) = extent(bench, "shaft"), extent(bench, "head")
    assert back.tolist() == [2, 0, 1]
    assert middle.tolist() == base.tolist() == [2, 1, 1]
    np.testing.assert_allclose(tip, [2, 1.3, 1], atol=1e-6)


def test_changed_property_redraws_the_pose() -> None:
    bench = Bench()
    display = add(bench, "Pose")
    bench.publish("/pose", stamped(pose()))
    display["Shape"] = "Axes"
    assert list(drawables_of(bench)) == ["axes"]
    display["Shape"] = "Arrow"
    assert sorted(drawables_of(bench)) == ["head", "shaft"]


@pytest.mark.parametrize(
    ("name", "wrong", "right"),
    [
        ("Pose", stamped(pose(np.nan)), stamped(pose(1.0))),
        ("PoseArray", array(pose(), pose(np.inf)), array(pose(1.0))),
    ],
)
def test_non_finite_poses_are_an_error_and_the_next_ones_are_shown(name: str, wrong: Any, right: Any) -> None:
    bench = Bench()
    display = add(bench, name)
    bench.publish("/pose", wrong)
    bench.update()
    assert bench.status(display, "Topic") == ("error", INVALID)
    assert not drawables_of(bench)
    bench.publish("/pose", right, at=0.1)
    bench.update(0.1)
    assert bench.status(display, "Topic") == ("ok", "2 messages received at 20.0 hz.")
    assert drawables_of(bench)


@pytest.mark.parametrize(
    ("shape", "parts"), [("Arrow (Flat)", ["arrows"]), ("Arrow (3D)", ["head", "shaft"]), ("Axes", ["axes"])]
)
def test_pose_array_is_shown_in_its_shape(shape: str, parts: list[str]) -> None:
    bench = Bench()
    add(bench, "PoseArray", shape=shape)
    bench.publish("/pose", array(*(pose(float(x)) for x in range(5))))
    bench.update()
    assert sorted(drawables_of(bench)) == parts


def test_flat_arrows_start_at_their_poses_and_have_the_requested_length() -> None:
    bench = Bench()
    add(bench, "PoseArray", arrow_length=2.0)
    bench.publish("/pose", array(pose(1.0), pose(5.0, turned=True)))
    bench.update()
    lines = drawables_of(bench)["arrows"]
    assert isinstance(lines, Lines)
    ends = np.round(lines.points.reshape(2, 6, 3), 5)
    assert ends[0, :2].tolist() == [[1, 0, 0], [3, 0, 0]]
    assert ends[1, :2].tolist() == [[5, 0, 0], [5, 2, 0]]


def test_solid_arrows_and_axes_of_an_array_are_drawn_at_each_pose() -> None:
    bench = Bench()
    display = add(bench, "PoseArray", shape="Arrow (3D)")
    bench.publish("/pose", array(pose(1.0), pose(5.0, turned=True)))
    bench.update()
    assert extent(bench, "shaft", 1)[0].tolist() == [5, 0, 0]
    np.testing.assert_allclose(extent(bench, "head", 1)[1], [5, 0.3, 0], atol=1e-6)
    display["Shape"] = "Axes"
    np.testing.assert_allclose(extent(bench, "axes", 3)[1], [5, 0.3, 0], atol=1e-6)  # x of the second


def test_quaternions_without_unit_length_have_a_hint_until_they_are_corrected() -> None:
    bench = Bench()
    display = add(bench, "PoseArray")
    wrong = pose()
    wrong.orientation.z = wrong.orientation.w = 1.0
    bench.publish("/pose", array(pose(), wrong, wrong))
    (hint,) = bench.hints(display)
    assert hint.startswith("2 of 3 orientations do not have length 1, (0, 0, 1, 1): RViz2 may")
    bench.publish("/pose", array(pose()))
    assert bench.hints(display) == []
    single = bench.session.add("rviz_default_plugins/Pose", "Single", {"Topic": "/single"})
    bench.publish("/single", stamped(wrong))
    assert bench.hints(single)[0].startswith("orientation does not have length 1, (0, 0, 1, 1)")


@pytest.mark.parametrize(
    ("shape", "part"), [("Arrow (Flat)", "arrows"), ("Arrow (3D)", "shaft"), ("Axes", "axes")]
)
def test_only_flat_arrows_depend_on_the_length_of_a_quaternion(shape: str, part: str) -> None:
    bench = Bench()
    add(bench, "PoseArray", shape=shape, arrow_length=1.0, shaft_length=1.0, axes_length=1.0)
    wrong = pose()
    wrong.orientation.z = wrong.orientation.w = 1.0
    bench.publish("/pose", array(wrong))
    drawn = drawables_of(bench)[part]
    ahead = drawn.points[1] if shape == "Arrow (Flat)" else drawn.placements[0][:3, 2]
    expected = (-1, 2, 0) if shape == "Arrow (Flat)" else (0, 1, 0)
    np.testing.assert_allclose(ahead, expected, atol=1e-6)


def test_empty_array_is_not_drawn() -> None:
    bench = Bench()
    add(bench, "PoseArray")
    bench.publish("/pose", array(pose()))
    bench.publish("/pose", array())
    bench.update()
    assert not drawables_of(bench)
