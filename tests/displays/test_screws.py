from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import AccelStamped, TwistStamped, Vector3, WrenchStamped

from course_lib.displays.display import INVALID, Display
from tests.displays.bench import Bench

Make = Callable[..., Any]
Numbers = tuple[float, float, float]
NONE = (0.0, 0.0, 0.0)


def in_map(message: Any, field: str, names: tuple[str, str], vectors: tuple[Numbers, ...]) -> Any:
    message.header.frame_id = "map"
    for name, (x, y, z) in zip(names, vectors, strict=True):
        setattr(getattr(message, field), name, Vector3(x=x, y=y, z=z))
    return message


def wrench(*vectors: Numbers) -> Any:
    return in_map(WrenchStamped(), "wrench", ("force", "torque"), vectors)


def twist(*vectors: Numbers) -> Any:
    return in_map(TwistStamped(), "twist", ("linear", "angular"), vectors)


def accel(*vectors: Numbers) -> Any:
    return in_map(AccelStamped(), "accel", ("linear", "angular"), vectors)


KINDS = [("Wrench", wrench, "Force", "Torque"), ("TwistStamped", twist, "Linear", "Angular")]
each_kind = pytest.mark.parametrize(
    ("name", "make", "straight", "turning"), [*KINDS, ("AccelStamped", accel, "Linear", "Angular")]
)


def add(bench: Bench, name: str, **properties: Any) -> Display:
    return bench.session.add(f"rviz_default_plugins/{name}", "Shown", {"Topic": "/screw"}, **properties)


def drawables_of(bench: Bench) -> dict[str, Any]:
    objects = bench.scene.objects().items()
    return {
        path.rpartition("/")[2]: drawable for path, drawable in objects if path.startswith("displays/Shown/")
    }


def ends(solids: Any, number: int = 0) -> np.ndarray:
    """Return the ends of a solid's axis, shape (2, 3)."""
    return np.array([(solids.placements[number] @ (0, 0, z, 1))[:3] for z in (-0.5, 0.5)])


@each_kind
def test_arrows_have_the_scaled_length_of_both_vectors(
    name: str, make: Make, straight: str, turning: str
) -> None:
    bench = Bench()
    display = add(bench, name)
    bench.publish("/screw", make((0.0, 3.0, 0.0), (0.0, 0.0, -1.0)))
    parts = drawables_of(bench)
    np.testing.assert_allclose(ends(parts[f"{straight} shaft"]), [[0, 0, 0], [0, 6, 0]], atol=1e-6)
    np.testing.assert_allclose(ends(parts[f"{straight} head"])[1], [0, 7.8, 0], atol=1e-6)
    np.testing.assert_allclose(ends(parts[f"{turning} shaft"]), [[0, 0, 0], [0, 0, -2]], atol=1e-6)
    for row, label in enumerate((straight, turning)):
        display[f"{label} Arrow Scale"] = 1.0
        display[f"{label} Color"] = (0, 0, 255)
        shaft = drawables_of(bench)[f"{label} shaft"]
        assert np.abs(ends(shaft)[1]).max() == pytest.approx((3, 1)[row])
        assert shaft.colors.tolist() == [0, 0, 1, 1]


@each_kind
@pytest.mark.parametrize("axis", [(1.0, 2.0, 3.0), (0.0, 0.0, 4.0), (0.0, 0.0, -4.0), (-4.0, 0.0, 0.0)])
def test_circle_around_the_rotation_vector_follows_the_right_hand_rule(
    name: str, make: Make, straight: str, turning: str, axis: Numbers
) -> None:
    bench = Bench()
    add(bench, name, **{f"{turning.lower()}_arrow_scale": 1.0})
    bench.publish("/screw", make(NONE, axis))
    assert f"{straight} shaft" not in drawables_of(bench)
    length = np.linalg.norm(axis)
    along, points = np.array(axis) / length, drawables_of(bench)["circle 0"].points
    np.testing.assert_allclose(points @ along, length / 2, rtol=1e-5)
    from_axis = points - np.outer(points @ along, along)
    np.testing.assert_allclose(np.linalg.norm(from_axis, axis=1), length / 4, rtol=1e-5)
    assert (np.cross(from_axis[:-1], from_axis[1:]) @ along > 0).all()
    base, tip = ends(drawables_of(bench)["tips"])
    np.testing.assert_allclose(base, points[-1], atol=1e-5)
    assert np.dot(np.cross(from_axis[-1], tip - base), along) > 0


@each_kind
def test_history_keeps_the_newest_screws(name: str, make: Make, straight: str, turning: str) -> None:
    bench = Bench()
    display = add(bench, name, history_length=2)
    for size in (1.0, 2.0, 3.0):
        bench.publish("/screw", make((size, 0.0, 0.0), (size, 0.0, 0.0)))
    shafts = drawables_of(bench)[f"{straight} shaft"]
    assert [ends(shafts, i)[1, 0] for i in range(2)] == pytest.approx([4, 6])
    display["History Length"] = 1
    assert [key for key in drawables_of(bench) if key.startswith("circle")] == ["circle 0"]
    display["Alpha"] = 0.25
    assert drawables_of(bench)[f"{turning} head"].colors[3] == 0.25


@each_kind
def test_arrows_shorter_than_their_width_are_not_drawn(
    name: str, make: Make, straight: str, turning: str
) -> None:
    bench = Bench()
    display = add(bench, name)
    bench.publish("/screw", make((0.2, 0.0, 0.0), (0.2, 0.0, 0.0)))
    assert not drawables_of(bench)
    display["Arrow Width"] = 0.3
    assert {f"{straight} shaft", f"{turning} shaft"} <= drawables_of(bench).keys()


def test_small_velocities_are_shown_on_request() -> None:
    bench = Bench()
    display = add(bench, "TwistStamped")
    bench.publish("/screw", twist((0.1, 0.0, 0.0), NONE))
    display["Hide Small Values"] = False
    assert sorted(drawables_of(bench)) == ["Linear head", "Linear shaft"]


def test_nan_values_are_an_error_or_zero_if_a_wrench_accepts_them() -> None:
    bench = Bench()
    display = add(bench, "Wrench")
    wrong = wrench((np.nan, 0.0, 2.0), NONE)
    bench.publish("/screw", wrong)
    assert bench.status(display, "Topic") == ("error", INVALID)
    assert not drawables_of(bench)
    display["Accept NaN Values"] = True
    bench.publish("/screw", wrong)
    message = "Message might contain floating point values (nans or infs)"
    assert bench.status(display, "Topic") == ("ok", message)
    np.testing.assert_allclose(ends(drawables_of(bench)["Force shaft"])[1], [0, 0, 4], atol=1e-6)


@each_kind
def test_known_transform_is_not_a_status_of_screws(
    name: str, make: Make, straight: str, turning: str
) -> None:
    bench = Bench()
    display = add(bench, name)
    bench.publish("/screw", make((0.0, 3.0, 0.0), NONE))
    assert [row.name for row in display.rows()] == ["Topic"]
