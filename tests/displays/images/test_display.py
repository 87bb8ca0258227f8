from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import Image

from course_lib.displays.display import Display
from course_lib.viewer.drawables import Inset
from tests.displays.bench import Bench
from tests.displays.images.test_pixels import COLORS, image

PATH = "displays/Image/picture"


def add(bench: Bench, **properties: Any) -> Display:
    return bench.session.add("rviz_default_plugins/Image", "Image", {"Topic": "/picture"}, **properties)


def pixels(bench: Bench) -> np.ndarray:
    drawable = bench.scene.objects()[PATH]
    assert isinstance(drawable, Inset)
    return drawable.pixels


def hear(bench: Bench, message: Image) -> None:
    bench.publish("/picture", message)
    bench.update()


def test_image_is_shown_regardless_of_its_frame() -> None:
    bench = Bench()
    add(bench)
    hear(bench, image(COLORS, "rgb8"))
    np.testing.assert_array_equal(pixels(bench), COLORS)


def test_unknown_encoding_is_an_error_and_the_next_image_is_shown() -> None:
    bench = Bench()
    display = add(bench)
    hear(bench, image(COLORS, "hsv9"))
    assert bench.status(display, "Image") == ("error", "Unsupported image encoding [hsv9]")
    hear(bench, image(COLORS, "rgb8"))
    assert bench.status(display, "Image") is None
    np.testing.assert_array_equal(pixels(bench), COLORS)


def test_truncated_image_is_reported_only_in_the_log_as_in_rviz() -> None:
    bench = Bench()
    display = add(bench)
    short = image(COLORS, "rgb8")
    short.height = 100
    hear(bench, short)
    assert bench.status(display, "Image") is None
    assert bench.hints(display)[0].startswith("RViz's log: Error loading image: the image has 72 bytes")


def test_image_without_data_is_ignored() -> None:
    bench = Bench()
    add(bench)
    hear(bench, image(COLORS, "rgb8"))
    hear(bench, Image(encoding="rgb8"))
    np.testing.assert_array_equal(pixels(bench), COLORS)


@pytest.mark.parametrize(
    ("properties", "expected"),
    [({}, [0, 127, 255]), ({"normalize_range": False, "min_value": 0.0, "max_value": 4.9}, [63, 127, 191])],
)
def test_value_range_is_computed_or_set_in_integers(
    properties: dict[str, object], expected: list[int]
) -> None:
    bench = Bench()
    add(bench, **properties)
    hear(bench, image(np.array([[1, 2, 3]], np.uint16)[..., None], "16UC1"))
    assert pixels(bench)[0, :, 0].tolist() == expected


def test_topic_suffix_selects_compressed_images() -> None:
    bench = Bench()
    display = bench.session.add("rviz_default_plugins/Image", "Packed", {"Topic": "/camera/image/compressed"})
    assert display.subscriptions[0].type_name == "sensor_msgs/msg/CompressedImage"


def test_image_is_removed_when_its_display_is_disabled() -> None:
    bench = Bench()
    display = add(bench)
    hear(bench, image(COLORS, "rgb8"))
    display["Enabled"] = False
    assert PATH not in bench.scene.objects()
