"""Displays of your own: a class that draws messages, registered like a plugin of RViz.

The charge of a battery, as a bar above the robot::

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

It is under Add with its topics, `save_rviz` keeps it, and a layout that is opened after the class was
registered finds it. RViz2 itself says of it, in such a layout, that it could not be loaded.
"""

from collections.abc import Mapping
from traceback import extract_tb
from typing import Any, TypeVar

import numpy as np

from course_lib.displays.display import Display
from course_lib.displays.marker.drawables import placement
from course_lib.displays.poses.shapes import rgba_of
from course_lib.displays.properties import Property, color, flag, integer, number, text, vector, words
from course_lib.displays.registry import PACKAGE, REGISTRY
from course_lib.displays.topic_display import DrawnDisplay, TopicDisplay
from course_lib.errors import CourseError
from course_lib.viewer.drawables import Drawable, Lines, Mesh, Points, Shape, Solids, Text

__all__ = [
    "Lines", "Mesh", "OwnDisplay", "Points", "Property", "Solids", "Text", "color", "flag", "integer",
    "number", "register", "rgba_of", "solid", "text", "vector", "words",
]  # fmt: skip
AnyDisplay = TypeVar("AnyDisplay", bound=type[Display])


class OwnDisplay(DrawnDisplay):
    """Base of displays of one's own: the last message, in the frame of its header or in the fixed frame.

    A subclass has a `class_name` like "my_package/Name", a `type_name` like "nav_msgs/msg/Path", a table
    of `properties`, and the method `drawing`. `Viewer.add` makes the object.
    """

    def drawing(self, message: Any) -> Mapping[str, Drawable]:
        """Return what is to be seen of a message, in the frame of its header; lengths in [m].

        Args:
            message: Of the type `type_name`.

        Returns:
            Drawables by names of your choice: `solid(...)`, `Lines`, `Points`, `Mesh`, `Text`.
        """
        raise NotImplementedError

    def take(self, message: Any) -> None:
        """Queue a message with a header until its transform is known."""
        taker = DrawnDisplay if hasattr(message, "header") else TopicDisplay
        taker.take(self, message)

    def process(self, message: Any) -> None:
        """Show a message, and remember where its frame was."""
        transform = self.transform_at(message.header) if hasattr(message, "header") else np.eye(4)
        if transform is not None:
            self.keep((message, transform))

    def parts(self) -> Mapping[str, Drawable]:
        """Return the drawing of the last message."""
        return self.drawing(self.kept[0][0]) if self.kept else {}

    def draw(self) -> None:
        """Redraw; an error of the student's code becomes a status."""
        if not self.kept:
            return
        self.context.scene.set_transform(f"{self.path}/drawn", self.kept[0][1])
        try:
            super().draw()
        except Exception as error:  # of a student's code, which may raise anything
            where = [step for step in extract_tb(error.__traceback__) if step.name == "drawing"][-1:]
            line = f", line {where[0].lineno} ({where[0].line})" if where else ""
            self.statuses.set("error", "Drawing", f"{type(error).__name__}: {error}{line}")
        else:
            self.statuses.delete("Drawing")

    def message_at(self, path: str) -> Any:
        """Return the message that is shown."""
        return self.kept[0][0] if self.kept and path.startswith(f"{self.path}/") else None


def register(display: AnyDisplay) -> AnyDisplay:
    """Add a class of displays to the registry, in place of an earlier one of its `class_name`.

    Args:
        display: A subclass of `OwnDisplay`; `@register` above the class is enough.

    Raises:
        CourseError: If it has no name of the form ``my_package/Name``, or one of RViz's.
    """
    package, _, short = display.class_name.partition("/")
    if not package or not short:
        raise CourseError(
            f"{display.__name__}.class_name is {display.class_name!r}; write one like "
            f"class_name = 'my_robot/{display.__name__.removesuffix('Display')}'."
        )
    if package == PACKAGE:
        raise CourseError(f"{display.class_name!r} is RViz's; take the name of a package of your own.")
    display.acts = True  # its code is not ours: messages may make it do anything
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
        at: Its centre, [m].
        color: RGBA, 0..1.
    """
    return Solids(shape, [placement(np.eye(3), size, at)], color)
