from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path

from course_lib.displays.display import INVALID, Display
from course_lib.viewer.drawables import Lines, Solids
from tests.displays.bench import Bench
from tests.displays.poses.test_poses import drawables_of, extent, pose

START = (0.0, 1.0, 2.0)


def add(bench: Bench, **properties: Any) -> Display:
    return bench.session.add("rviz_default_plugins/Path", "Shown", {"Topic": "/path"}, **properties)


def path(*xs: float, turned: bool = False) -> Path:
    message = Path(poses=[PoseStamped(pose=pose(x, turned)) for x in xs])
    message.header.frame_id = "map"
    for stamped in message.poses:
        stamped.header.frame_id = "nowhere"  # which RViz does not look at
    return message


def xs(bench: Bench) -> list[list[float]]:
    """Return the x coordinates of the points of each line."""
    lines = [drawable for name, drawable in sorted(drawables_of(bench).items()) if name.startswith("line")]
    return [line.points[:, 0].tolist() for line in lines]


def test_path_is_a_thin_line_or_a_strip_of_the_requested_width() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/path", path(*START))
    line = drawables_of(bench)["line 0"]
    assert isinstance(line, Lines)
    assert (line.width, line.strip, line.points[:, 0].tolist()) == (0.0, True, list(START))
    np.testing.assert_allclose(line.colors, [25 / 255, 1, 0, 1], atol=1e-6)
    display["Line Style"] = "Billboards"
    display["Line Width"] = 0.2
    assert drawables_of(bench)["line 0"].width == 0.2
    display["Offset"] = (1, 0, 0)
    assert xs(bench) == [[1, 2, 3]]


def test_buffer_length_limits_the_number_of_paths() -> None:
    bench = Bench()
    display = add(bench, buffer_length=2)
    for first in (0.0, 10.0, 20.0):
        bench.publish("/path", path(first, first + 1))
    assert xs(bench) == [[10, 11], [20, 21]]
    display["Buffer Length"] = 1
    assert xs(bench) == []


def test_non_finite_path_replaces_an_older_path() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/path", path(*START))
    bench.publish("/path", path(0.0, np.nan))
    assert bench.status(display, "Topic") == ("error", INVALID)
    assert not drawables_of(bench)
    bench.publish("/path", path())
    assert not drawables_of(bench)


def test_arrows_are_drawn_at_the_poses_in_their_own_color() -> None:
    bench = Bench()
    add(bench, pose_style="Arrows", pose_color=(0, 0, 255), alpha=0.1)
    bench.publish("/path", path(*START, turned=True))
    np.testing.assert_allclose(np.array(extent(bench, "shaft", 1)), [[1.0, 0, 0], [1.0, 0.1, 0]], atol=1e-6)
    np.testing.assert_allclose(np.array(extent(bench, "head", 2)), [[2.0, 0.1, 0], [2.0, 0.3, 0]], atol=1e-6)
    assert drawables_of(bench)["head"].colors.tolist() == [0, 0, 1, 1]


@pytest.mark.parametrize(
    ("style", "label", "part"),
    [
        ("Axes", "Length", "axes"),
        ("Axes", "Radius", "axes"),
        ("Arrows", "Shaft Length", "shaft"),
        ("Arrows", "Shaft Diameter", "shaft"),
        ("Arrows", "Head Length", "head"),
        ("Arrows", "Head Diameter", "head"),
    ],
)
def test_shapes_at_the_poses_have_the_requested_size(style: str, label: str, part: str) -> None:
    bench = Bench()
    display = add(bench, pose_style=style)
    bench.publish("/path", path(*START))
    before = drawables_of(bench)[part]
    display[label] = 2.0
    after = drawables_of(bench)[part]
    assert isinstance(before, Solids)
    assert isinstance(after, Solids)
    assert np.abs(after.placements - before.placements).max() > 0.5


@pytest.mark.parametrize(
    ("style", "part", "ahead"),
    # Ogre's product of the quaternion and x is (-1, 2, 0).
    [("Axes", "axes", (0, 1, 0)), ("Arrows", "shaft", np.array([-1, 2, 0]) / np.sqrt(5))],
)
def test_quaternion_without_unit_length_does_not_change_the_size_of_the_shapes(
    style: str, part: str, ahead: Any
) -> None:
    bench = Bench()
    display = add(bench, pose_style=style, shaft_length=1.0, length=1.0)
    message = path(0.0, 1.0)
    message.poses[0].pose.orientation.z = message.poses[0].pose.orientation.w = 1.0
    message.poses[1].pose.orientation.z, message.poses[1].pose.orientation.w = 2.0, 0.0
    bench.publish("/path", message)
    placements = drawables_of(bench)[part].placements
    assert isinstance(placements, np.ndarray)
    np.testing.assert_allclose(placements[0][:3, 2], ahead, atol=1e-6)
    second = placements[3 if part == "axes" else 1]
    np.testing.assert_allclose(second[:3, 2], (-1, 0, 0), atol=1e-6)
    assert bench.hints(display)[0].startswith("2 of 2 orientations do not have length 1")
    display["Pose Style"] = "None"
    bench.publish("/path", message)
    assert bench.hints(display) == []
