"""The table of displays by RViz's class names, and displays that students register.

A class that draws messages is registered like a plugin of RViz. This one draws the charge of a
battery as a bar above the robot::

    from course_lib.displays import OwnDisplay, Property, number, register, solid

    @register
    class BatteryDisplay(OwnDisplay):
        class_name = "my_robot/Battery"
        type_name = "sensor_msgs/msg/BatteryState"
        properties = (*OwnDisplay.properties, Property("Height", 1.0, number(0.01)))  # [m]

        def drawing(self, message):
            charge = message.percentage  # 0..1
            high = charge * self["Height"]  # [m]
            color = (1 - charge, charge, 0, 1)  # RGBA, from red to green
            return {"bar": solid("box", size=(0.1, 0.1, high), at=(0, 0, high / 2), color=color)}

    viewer.add("my_robot/Battery", "/battery", height=0.5)

The display is listed under Add with its topics, `save_rviz` saves it, and layouts that are opened
after the registration can contain it. RViz2 itself reports that a display of this class could not
be loaded.
"""

from collections.abc import Mapping
from difflib import get_close_matches
from traceback import extract_tb
from typing import Any, TypeVar

import numpy as np

from course_lib.displays import clouds, images, simple
from course_lib.displays.display import GROUP, Context, Display, DrawnDisplay
from course_lib.displays.interactive import InteractiveMarkersDisplay
from course_lib.displays.map import MapDisplay
from course_lib.displays.markers import MarkerArrayDisplay, MarkerDisplay
from course_lib.displays.properties import (
    Property,
    color,
    descriptions,
    flag,
    integer,
    number,
    text,
    vector,
    words,
)
from course_lib.displays.robot_model import RobotModelDisplay
from course_lib.displays.shapes import placement, rgba_of
from course_lib.displays.tf import AxesDisplay, GridDisplay, TfDisplay
from course_lib.errors import CourseError
from course_lib.viewer.drawables import Drawable, Lines, Mesh, Points, Shape, Solids, Text

PACKAGE = "rviz_default_plugins"

REGISTRY: dict[str, type[Display]] = {
    display.class_name: display
    for display in (
        simple.AccelStampedDisplay,
        AxesDisplay,
        images.CameraDisplay,
        images.CameraInfoDisplay,
        clouds.DepthCloudDisplay,
        simple.EffortDisplay,
        clouds.FluidPressureDisplay,
        simple.GridCellsDisplay,
        GridDisplay,
        clouds.IlluminanceDisplay,
        images.ImageDisplay,
        InteractiveMarkersDisplay,
        clouds.LaserScanDisplay,
        MapDisplay,
        MarkerArrayDisplay,
        MarkerDisplay,
        simple.OdometryDisplay,
        simple.PathDisplay,
        clouds.PointCloudDisplay,
        clouds.PointCloud2Display,
        simple.PointStampedDisplay,
        simple.PolygonDisplay,
        RobotModelDisplay,
        clouds.TemperatureDisplay,
        TfDisplay,
        simple.PoseArrayDisplay,
        simple.PoseDisplay,
        simple.PoseWithCovarianceDisplay,
        simple.RangeDisplay,
        clouds.RelativeHumidityDisplay,
        simple.TwistStampedDisplay,
        simple.WrenchDisplay,
    )
}


class FailedDisplay(Display):
    """A display of an unknown class, which keeps its configuration unchanged."""

    def __init__(self, context: Context, name: str, path: str, required: str) -> None:
        super().__init__(context, name, path)
        self.required = required

    def reset(self) -> None:
        """Set RViz's status that explains why nothing is drawn."""
        super().reset()
        self.statuses.set(
            "error",
            "Class",
            f"The class required for this display, '{self.required}', could not be "
            "loaded.<br><b>Error:</b><br>According to the loaded plugin descriptions the class "
            f"{self.required} with base class type rviz_common::Display does not exist. Declared "
            f"types are  {' '.join(sorted(REGISTRY))}",
        )
        names = {short_name(name): name for name in sorted([GROUP, *REGISTRY])}
        package, _, short = self.required.rpartition("/")
        # Another package may have a display of the same short name.
        similar = [
            names[match]
            for match in get_close_matches(short, names, 1, 0.8)
            if package in ("", "rviz", "rviz_common")
            or get_close_matches(package, [names[match].rpartition("/")[0]], 1, 0.8)
        ]
        ros_1 = f"{self.required} is ROS 1's name. " if package == "rviz" else ""
        self.statuses.hint("Class", *(f"{ros_1}RViz2 has the class {name}." for name in similar))


def make_display(context: Context, class_name: str, name: str, path: str) -> Display:
    """Create a display by its class name, ``rviz_default_plugins/Marker``."""
    display_class = REGISTRY.get(class_name)
    return (
        display_class(context, name, path)
        if display_class
        else FailedDisplay(context, name, path, class_name)
    )


def full_name(class_name: str) -> str:
    """Return a class name with its package, which `name` may omit."""
    full_names = (name for name in REGISTRY if short_name(name) == class_name)
    return class_name if "/" in class_name else next(full_names, f"{PACKAGE}/{class_name}")


def known_name(class_name: str) -> str:
    """Return a class name with its package.

    Raises:
        CourseError: The display does not exist.
    """
    if not isinstance(class_name, str):
        name = getattr(class_name, "__name__", "Marker")
        raise CourseError(
            f"{class_name!r} is not the name of a display: write its name in quotes, add({name!r})."
        )
    required = full_name(class_name)
    if required not in REGISTRY:
        if class_name.startswith("/"):
            raise CourseError(
                f"There is no display {class_name!r}: the class comes first and then the topic, "
                f"add('Marker', {class_name!r})."
            )
        names = [short_name(name) for name in REGISTRY]
        same = [name for name in names if name.lower() == short_name(class_name).lower()]
        # RViz2's class of a Path is PathDisplay.
        same = same or [name for name in names if f"{name}display".lower() == class_name.lower()]
        near = same or get_close_matches(short_name(class_name), names, 3) or names
        suggestions = near[0] if len(near) == 1 else f"one of {', '.join(near)}"
        raise CourseError(f"There is no display {class_name!r}; use {suggestions}.")
    return required


def short_name(class_name: str) -> str:
    """Return a class name without its package, which RViz uses as the name of a new display."""
    return class_name.rpartition("/")[2]


def describe_class(class_name: str) -> str:
    """Return RViz's description of a display, or the first paragraph of its docstring."""
    display = REGISTRY.get(class_name)
    docstring = (display.__doc__ or "").strip().partition("\n\n")[0] if display else ""
    return descriptions()["classes"].get(class_name, " ".join(docstring.split()))


__all__ = [
    "Lines", "Mesh", "OwnDisplay", "Points", "Property", "Solids", "Text", "color", "flag", "integer",
    "number", "register", "rgba_of", "solid", "text", "vector", "words",
]  # fmt: skip
AnyDisplay = TypeVar("AnyDisplay", bound=type[Display])


class OwnDisplay(DrawnDisplay):
    """Base class of custom displays: the last message, in the frame of its header or the fixed frame.

    A subclass has a `class_name` like "my_package/Name", a `type_name` like "nav_msgs/msg/Path", a
    table of `properties`, and the method `drawing`. `Viewer.add` creates the object.

    Example:
        >>> from course_lib.displays import OwnDisplay, solid
        >>> class Target(OwnDisplay):
        ...     class_name = "my_robot/Target"
        ...     type_name = "geometry_msgs/msg/PointStamped"
        ...
        ...     def drawing(self, message):
        ...         center = (message.point.x, message.point.y, message.point.z)
        ...         return {"ball": solid("sphere", size=(0.2, 0.2, 0.2), at=center)}

    Put `@register` above the class before it is added to a viewer.
    """

    def drawing(self, message: Any) -> Mapping[str, Drawable]:
        """Return the drawables of a message, in the frame of its header; lengths in [m].

        Args:
            message: A message of the type `type_name`.

        Returns:
            Drawables by name (any names): `solid(...)`, `Lines`, `Points`, `Mesh`, `Text`.
        """
        raise NotImplementedError

    def process(self, message: Any) -> None:
        """Keep a message with the transform of its frame."""
        transform = self.transform_at(message.header) if hasattr(message, "header") else np.eye(4)
        if transform is not None:
            self.keep((message, transform))

    def drawables(self) -> Mapping[str, Drawable]:
        """Return the drawables of the last message."""
        return self.drawing(self.history[0][0]) if self.history else {}

    def draw(self) -> None:
        """Redraw; an exception in the student's code becomes a status."""
        if not self.history:
            return
        self.context.scene.set_transform(f"{self.path}/drawn", self.history[0][1])
        try:
            with np.errstate(all="warn"):
                super().draw()
        except Exception as error:
            # The student's `drawing` may raise any exception.
            where = [step for step in extract_tb(error.__traceback__) if step.name == "drawing"][-1:]
            line = f", line {where[0].lineno} ({where[0].line})" if where else ""
            self.statuses.set("error", "Drawing", f"{type(error).__name__}: {error}{line}")
        else:
            self.statuses.delete("Drawing")

    def message_at(self, path: str) -> Any:
        """Return the displayed message."""
        return self.history[0][0] if self.history and path.startswith(f"{self.path}/") else None


def register(display: AnyDisplay) -> AnyDisplay:
    """Add a display class to the registry, replacing one with the same `class_name`.

    Args:
        display: A subclass of `OwnDisplay`; use `@register` above the class.

    Raises:
        CourseError: Its name does not have the form ``my_package/Name``, or belongs to RViz.
    """
    package, _, short = display.class_name.partition("/")
    if not package or not short:
        raise CourseError(
            f"{display.__name__}.class_name is {display.class_name!r}; write one like "
            f"class_name = 'my_robot/{display.__name__.removesuffix('Display')}'."
        )
    if package == PACKAGE:
        raise CourseError(f"{display.class_name!r} belongs to RViz; use a package name of your own.")
    # A student's code may have any side effects, so its messages cannot be postponed.
    display.has_side_effects = True
    REGISTRY[display.class_name] = display
    return display


def solid(
    shape: Shape,
    *,
    size: tuple[float, float, float],
    at: tuple[float, float, float] = (0.0, 0.0, 0.0),
    color: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0),
) -> Solids:
    """Draw one box, sphere, cylinder or cone.

    Args:
        shape: "box", "sphere", "cylinder" or "cone", both along z.
        size: Along x, y and z, [m].
        at: Its center, [m].
        color: RGBA, 0..1.
    """
    return Solids(shape, [placement(np.eye(3), size, at)], color)
