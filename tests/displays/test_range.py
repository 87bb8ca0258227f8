from math import inf, nan, tan
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import Range

from course_lib.displays.display import Display
from course_lib.viewer.drawables import Solids
from tests.displays.bench import Bench

PATH = "displays/Range/drawn/cones"


def add(bench: Bench, **properties: Any) -> Display:
    return bench.session.add("rviz_default_plugins/Range", "Range", {"Topic": "/range"}, **properties)


def measured(distance: float, low: float = 0.5, high: float = 4.0) -> Range:
    message = Range(range=distance, min_range=low, max_range=high, field_of_view=0.5)
    message.header.frame_id = "map"
    return message


def cones(bench: Bench) -> np.ndarray:
    drawable = bench.scene.objects()[PATH]
    assert isinstance(drawable, Solids)
    return drawable.placements


def test_cone_opens_along_x_from_the_sensor_with_the_field_of_view() -> None:
    bench = Bench()
    add(bench)
    bench.publish("/range", measured(2.0))
    bench.update()
    (cone,) = cones(bench)
    tip, base, rim = ((cone @ (*point, 1.0))[:3] for point in ((0, 0, 0.5), (0, 0, -0.5), (0.5, 0, -0.5)))
    assert np.linalg.norm(tip) < 0.01 * 2.0  # RViz draws it slightly nearer
    np.testing.assert_allclose(base - tip, [2.0, 0, 0], atol=1e-6)
    assert np.linalg.norm(rim - base) == pytest.approx(2.0 * tan(0.25))
    assert np.linalg.det(cone[:3, :3]) > 0


@pytest.mark.parametrize(
    ("message", "length"),
    [
        (measured(0.5), 0.5),
        (measured(4.0), 4.0),
        (measured(4.5), 0.0),
        (measured(0.1), 0.0),
        (measured(nan), 0.0),
        (measured(inf), 0.0),
        (measured(-inf), 0.0),
        (measured(-inf, 1.5, 1.5), 1.5),
        (measured(inf, 1.5, 1.5), 0.0),
    ],
)
def test_out_of_range_measurement_has_zero_length(message: Range, length: float) -> None:
    bench = Bench()
    add(bench)
    bench.publish("/range", message)
    bench.update()
    assert np.linalg.norm(cones(bench)[0, :3, 2]) == pytest.approx(length)


def test_buffer_length_limits_the_number_of_measurements() -> None:
    bench = Bench()
    display = add(bench, buffer_length=3)
    for distance in (1.0, 1.5, 2.0, 2.5):
        bench.publish("/range", measured(distance))
    bench.update()
    np.testing.assert_allclose(np.linalg.norm(cones(bench)[:, :3, 2], axis=1), [1.5, 2.0, 2.5])
    display["Buffer Length"] = 1
    assert PATH not in bench.scene.objects()


def test_color_and_alpha_equal_the_properties() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/range", measured(1.0))
    bench.update()
    display["Color"] = (255, 0, 0)
    drawable = bench.scene.objects()[PATH]
    assert isinstance(drawable, Solids)
    assert drawable.colors.tolist() == [1.0, 0.0, 0.0, 0.5]
