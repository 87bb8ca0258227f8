from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import FluidPressure, Illuminance, RelativeHumidity, Temperature

from course_lib.displays.clouds import rainbow
from course_lib.displays.display import Display
from tests.displays.bench import Bench
from tests.displays.clouds.clouds import points_of

# Class, a value, and the position of its color in RViz's rainbow: 1 is red, 0 is violet.
MEASURED: list[tuple[Any, str, float, float]] = [
    (Temperature, "temperature", 25.0, 0.25),
    (FluidPressure, "fluid_pressure", 101_500.0, 0.5),
    (Illuminance, "illuminance", 250.0, 0.75),
    (RelativeHumidity, "relative_humidity", 0.25, 0.75),
]


def show_value(kind: Any, field: str, value: float, **properties: Any) -> tuple[Bench, Display]:
    bench = Bench()
    bench.transform("map", "sensor", (1.0, 2.0, 3.0))
    name = kind.__name__
    display = bench.session.add(f"rviz_default_plugins/{name}", name, {"Topic": "/measured"}, **properties)
    message = kind(**{field: value})
    message.header.frame_id = "sensor"
    bench.publish("/measured", message)
    bench.update()
    return bench, display


@pytest.mark.parametrize(("kind", "field", "value", "place"), MEASURED, ids=lambda part: str(part))
def test_measurement_is_one_point_at_its_frame_colored_by_its_range(
    kind: Any, field: str, value: float, place: float
) -> None:
    bench, display = show_value(kind, field, value)
    (point,) = points_of(bench, display)
    np.testing.assert_allclose(point.colors[0, :3], rainbow([place])[0], atol=1e-6)
    (path,) = (path for path in bench.scene.objects() if path.startswith(f"{display.path}/"))
    assert bench.scene.world_transform(path)[:3, 3].tolist() == [1.0, 2.0, 3.0]
    assert bench.status(display, "Points") == ("ok", "Showing [1] points from [1] messages")


def test_room_temperature_is_violet_and_boiling_water_is_red() -> None:
    for temperature, place in ((-10.0, 0.0), (100.0, 1.0)):
        bench, display = show_value(Temperature, "temperature", temperature)
        np.testing.assert_allclose(points_of(bench, display)[0].colors[0, :3], rainbow([place])[0])


def test_decay_time_keeps_the_track_of_a_moving_sensor() -> None:
    bench, display = show_value(Temperature, "temperature", 20.0, **{"Decay Time": 10.0})
    bench.transform("map", "sensor", (5.0, 0.0, 0.0), at=1.0)
    message = Temperature(temperature=30.0)
    message.header.frame_id = "sensor"
    bench.publish("/measured", message, at=1.0)
    bench.update(1.0)
    assert len(points_of(bench, display)) == 2
