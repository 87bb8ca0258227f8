"""The Image display, and what the Camera display shares with it."""

from typing import Any

from course_lib.arrays import AnyArray, Pixels
from course_lib.displays.display import Interest
from course_lib.displays.images.pixels import (
    Range,
    UnsupportedEncodingError,
    reduced,
    rgb_of,
    unpacked,
)
from course_lib.displays.properties import Property, flag, integer, number
from course_lib.displays.topic_display import TopicDisplay
from course_lib.viewer.drawables import Inset

IMAGE, PACKED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
_COLUMNS = 480  # [px] that a page gets of a picture at most: more than its place in the view has


def info_topic(image_topic: str) -> str:
    """Return the topic on which the camera of an image is described: beside it."""
    return f"/{image_topic.removeprefix('/')}".rpartition("/")[0] + "/camera_info"


class PictureDisplay(TopicDisplay):
    """Takes raw images, or packed ones from a topic that ends so, and shows them in the view's corner."""

    type_name = IMAGE

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.message: Any = None  # the last one
        self._stale = False
        self._range = Range()

    def changed(self, label: str) -> None:
        """Draw anew in the next frame."""
        super().changed(label)
        self.redraw()

    def redraw(self) -> None:
        """Draw anew in the next frame."""
        self._stale = True

    def reset(self) -> None:
        """Forget the image."""
        super().reset()
        self.message, self._range = None, Range()

    def wanted(self) -> tuple[Interest, ...]:
        """Listen to the topic; its last part says how the images are packed."""
        packed = self["Topic"].rpartition("/")[2] == "compressed"
        return (self.interest(self["Topic"], PACKED if packed else IMAGE, self.take),)

    def process(self, message: Any) -> None:
        """Keep an image for the next frame; of several that come before, RViz shows the last."""
        self.message, self._stale = message, True

    def update(self) -> None:
        """Show the image that has come last."""
        super().update()
        message, stale, self._stale = self.message, self._stale, False
        if not stale or message is None or not len(message.data):
            return
        self.statuses.delete("Image")
        try:
            packed = hasattr(message, "format")
            pixels = unpacked(message, self.limits) if packed else rgb_of(message, self.limits)
        except UnsupportedEncodingError as error:
            self.statuses.set("error", "Image", str(error))
        except ValueError as error:
            self.statuses.hint("Image", f"RViz's log: Error loading image: {error}")
        else:
            self.show(reduced(pixels, _COLUMNS))

    def show(self, pixels: Pixels) -> None:
        """Show a picture."""
        self.context.scene.set_object(f"{self.path}/picture", Inset(pixels))

    def limits(self, values: AnyArray) -> tuple[float, float]:
        """Say which values are black and white: the least and the greatest of the last five images."""
        return self._range.found(values, 5)


class ImageDisplay(PictureDisplay):
    """Shows images as they are."""

    class_name = "rviz_default_plugins/Image"
    properties = (
        *PictureDisplay.properties,
        Property("Normalize Range", True, flag),
        Property("Min Value", 0.0, number()),
        Property("Max Value", 1.0, number()),
        Property("Median window", 5, integer(1)),
    )

    def limits(self, values: AnyArray) -> tuple[float, float]:
        """Say which values are black and white: those asked for, which RViz rounds down, or what is found."""
        if self["Normalize Range"]:
            return self._range.found(values, self["Median window"])
        return float(int(self["Min Value"])), float(int(self["Max Value"]))
