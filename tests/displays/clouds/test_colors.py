import colorsys
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from course_lib.displays.clouds import TRANSFORMERS, Cloud, best_transformer, channels_of, rainbow
from tests.displays.bench import Bench
from tests.displays.clouds.clouds import TOPIC, Order, add, cloud, plain, points_of

ORDERS: tuple[Order, ...] = ("<", ">")
LINE = [[0, 0, 0], [0, 0, 1], [0, 0, 2], [0, 0, 4]]


def known(**channels: Any) -> Cloud:
    made: dict[str, Any] = {name: np.asarray(values) for name, values in channels.items()}
    return Cloud(channels_of(cloud(plain(LINE, **made)))[0], np.eye(4), 0)


def colors(bench: Bench, **properties: Any) -> np.ndarray:
    display = add(bench, **properties)
    intensity = np.array([0, 1, 2, 4], np.float32)
    bench.publish(TOPIC, cloud(plain(LINE, intensity=intensity)))
    bench.update()
    return points_of(bench, display)[0].colors


@settings(deadline=None)  # machines may be busy
@given(st.floats(0, 1))
def test_rainbow_is_the_hsv_circle_from_violet_to_red(value: float) -> None:
    hue = 5 / 6 * (1 - value)  # rviz: "hue values going only from 0.0 to 0.833333"
    np.testing.assert_allclose(rainbow([value])[0], colorsys.hsv_to_rgb(hue, 1, 1), atol=2e-6)


def test_values_beyond_the_rainbow_are_clamped() -> None:
    np.testing.assert_array_equal(rainbow([-1, 2, np.nan]), rainbow([0, 1, 0]))


@pytest.mark.parametrize(
    ("channels", "wanted", "taken"),
    [
        ({}, "", "Intensity"),
        ({}, "AxisColor", "AxisColor"),
        ({}, "RGB8", "Intensity"),
        ({"rgb": np.zeros(4, "f4")}, "", "RGB8"),
        ({"rgba": np.zeros(4, "u4")}, "", "RGB8"),
        ({"rgb": np.zeros(4, "u2")}, "", "Intensity"),
        ({"r": np.zeros(4, "f4"), "g": np.zeros(4, "f4"), "b": np.zeros(4, "f4")}, "RGBF32", "RGBF32"),
    ],
)
def test_color_transformer_is_chosen_as_in_rviz(channels: dict[str, Any], wanted: str, taken: str) -> None:
    assert best_transformer(known(**channels), wanted) == taken


def test_intensity_is_colored_from_red_to_violet_and_its_bounds_are_shown() -> None:
    bench = Bench()
    point_colors = colors(bench)
    np.testing.assert_allclose(point_colors[:, :3], rainbow([1, 0.75, 0.5, 0]))
    (display,) = (d for d in bench.session.displays if d.name == "Cloud")
    assert (display["Min Intensity"], display["Max Intensity"]) == (0.0, 4.0)
    assert display["Color Transformer"] == "Intensity"


def test_rainbow_can_be_inverted_or_two_colors_and_have_bounds() -> None:
    inverted = colors(Bench(), invert_rainbow=True)
    np.testing.assert_allclose(inverted[:, :3], rainbow([0, 0.25, 0.5, 1]))
    bounds = {"autocompute_intensity_bounds": False, "min_intensity": 1.0, "max_intensity": 2.0}
    two = colors(Bench(), use_rainbow=False, min_color=(0, 0, 255), max_color=(255, 0, 0), **bounds)
    assert two[:, :3].tolist() == [[0, 0, 1], [0, 0, 1], [1, 0, 0], [1, 0, 0]]


def test_bounds_of_coordinates_have_one_limit_and_of_intensities_two() -> None:
    bench = Bench()
    display = add(bench, color_transformer="AxisColor", axis="Y")
    # Coordinates of UTM, [m].
    bench.publish(TOPIC, cloud(plain([[0, y, 0] for y in (5e6, 5.5e6, 6e6)])))
    bench.update()
    assert (display["Min Value"], display["Max Value"]) == (9999.0, 6e6)
    shares = (np.array([5e6, 5.5e6, 6e6]) - 9999) / (6e6 - 9999)
    point_colors = points_of(bench, display)[0].colors
    np.testing.assert_allclose(point_colors[:, :3], rainbow(1 - shares), atol=1e-6)
    display["Color Transformer"] = "Intensity"
    intensity = np.array([-2e6, 0, 1, 2e6], np.float32)
    bench.publish(TOPIC, cloud(plain(LINE, intensity=intensity)), at=1.0)
    bench.update(1.0)
    assert (display["Min Intensity"], display["Max Intensity"]) == (-999999.0, 999999.0)


def test_missing_channel_leaves_points_white() -> None:
    assert (colors(Bench(), channel_name="heat") == 1).all()


def test_axis_colors_vary_along_the_axis_of_the_fixed_frame_or_of_the_cloud() -> None:
    for fixed, expected in ((True, [1, 1, 1, 1]), (False, [1, 0.75, 0.5, 0])):
        bench = Bench()
        bench.transform("map", "laser", (3.0, 0.0, 0.0))
        display = add(bench, color_transformer="AxisColor", axis="X", use_fixed_frame=fixed)
        turned = np.roll(LINE, 1, axis=1) if not fixed else LINE
        bench.publish(TOPIC, cloud(plain(turned), "laser"))
        bench.update()
        np.testing.assert_allclose(points_of(bench, display)[0].colors[:, :3], rainbow(expected))
        if fixed:
            assert display["Min Value"] == display["Max Value"] == 3.0


def test_packed_colors_are_read_from_integers_and_floats() -> None:
    packed = np.array([0xFF0000, 0x00FF00, 0x0000FF, 0x336699], np.uint32)
    expected = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.2, 0.4, 0.6]])
    for values in (packed, packed.view(np.float32)):
        for order in ORDERS:
            channels, _ = channels_of(cloud(plain(LINE, order, rgb=values.astype(values.dtype))))
            point_colors, _ = TRANSFORMERS["RGB8"].colors(Cloud(channels, np.eye(4), 0), Bench().marker)
            np.testing.assert_allclose(point_colors, expected, rtol=1e-6)


def test_alpha_of_points_is_used_if_the_channel_is_named_rgba() -> None:
    for name, alpha in (("rgb", 1.0), ("rgba", 0x80 / 255)):
        bench = Bench()
        display = add(bench)
        tinted: dict[str, Any] = {name: np.full(4, 0x80FF0000, np.uint32)}
        bench.publish(TOPIC, cloud(plain(LINE, **tinted)))
        bench.update()
        # RViz draws points twice, see marker/drawables.py
        np.testing.assert_allclose(points_of(bench, display)[0].colors[:, 3], 1 - (1 - alpha) ** 2, atol=1e-6)
