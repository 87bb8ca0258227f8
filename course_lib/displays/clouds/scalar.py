"""RViz's Temperature, FluidPressure, Illuminance and RelativeHumidity displays: clouds of one point."""

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from course_lib.displays.clouds.cloud import Cloud
from course_lib.displays.clouds.display import CLOUD_PROPERTIES, CloudDisplay
from course_lib.displays.properties import Property
from course_lib.displays.topic_display import FilteredDisplay


def _properties(
    channel: str, lowest: float, highest: float, *, inverted: bool = False
) -> tuple[Property, ...]:
    """Return the properties of a cloud with the defaults of a measurement's range.

    Args:
        channel: Name of the message's field, which is that of the cloud's channel, too.
        lowest: Violet or red from here down, in the message's unit.
        highest: The other end of the rainbow.
        inverted: Whether red is the highest value.
    """
    defaults: dict[str, Any] = {
        "Channel Name": channel,
        "Autocompute Intensity Bounds": False,
        "Invert Rainbow": inverted,
        "Min Intensity": lowest,
        "Max Intensity": highest,
    }
    changed = (replace(prop, default=defaults.get(prop.label, prop.default)) for prop in CLOUD_PROPERTIES)
    return (*FilteredDisplay.properties, *changed)


class ScalarDisplay(CloudDisplay, FilteredDisplay):
    """One measured number as a coloured point at the origin of its frame (RViz's PointCloudScalarDisplay)."""

    field: ClassVar[str]  # of the message

    def process(self, message: Any) -> None:
        """Show a measurement."""
        transform = self.transform_at(message.header)
        if transform is None:
            return
        channels = {axis: np.zeros(1, np.float32) for axis in "xyz"}
        measured = np.array([getattr(message, self.field)], np.float64)
        self.keep(Cloud({**channels, self.field: measured}, transform, self.context.now_ns))


class TemperatureDisplay(ScalarDisplay):
    """Temperatures, [°C]."""

    class_name = "rviz_default_plugins/Temperature"
    type_name = "sensor_msgs/msg/Temperature"
    field = "temperature"
    properties = _properties(field, 0.0, 100.0, inverted=True)


class FluidPressureDisplay(ScalarDisplay):
    """Pressures of air or water, [Pa]."""

    class_name = "rviz_default_plugins/FluidPressure"
    type_name = "sensor_msgs/msg/FluidPressure"
    field = "fluid_pressure"
    properties = _properties(field, 98000.0, 105000.0)


class IlluminanceDisplay(ScalarDisplay):
    """Illuminances, [lx]."""

    class_name = "rviz_default_plugins/Illuminance"
    type_name = "sensor_msgs/msg/Illuminance"
    field = "illuminance"
    properties = _properties(field, 0.0, 1000.0)


class RelativeHumidityDisplay(ScalarDisplay):
    """Relative humidities, 0..1."""

    class_name = "rviz_default_plugins/RelativeHumidity"
    type_name = "sensor_msgs/msg/RelativeHumidity"
    field = "relative_humidity"
    properties = _properties(field, 0.0, 1.0)
