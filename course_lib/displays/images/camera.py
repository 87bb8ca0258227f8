"""RViz's Camera and CameraInfo displays."""

from collections.abc import Mapping
from math import atan
from typing import Any

import numpy as np

from course_lib.arrays import Matrix, Pixels
from course_lib.displays.display import Interest, node_name
from course_lib.displays.images.display import PictureDisplay, info_topic, zoomed
from course_lib.displays.poses.shapes import rgba_of
from course_lib.displays.properties import Property, booleans, color, flag, number, words
from course_lib.displays.statuses import Level
from course_lib.displays.topic_display import DrawnDisplay, FilteredDisplay
from course_lib.ros.qos import Qos
from course_lib.viewer.camera import Camera
from course_lib.viewer.drawables import Drawable, Inset, Lines, Mesh

INFO = "sensor_msgs/msg/CameraInfo"
_BOTH, _BACK, _OVER = "background and overlay", "background", "overlay"
_STATUS = "Camera Info"
_NO_POSITION = "CameraInfo/P resulted in an invalid position calculation (nans or infs)"
_CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])  # of the picture: x right, y down
_EDGES = np.array([(0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1)])  # the camera is point 0
_SIDES = np.array([(0, 2, 1), (0, 3, 2), (0, 4, 3), (0, 1, 4)])
_WIDTH = 0.01  # [m], of the edges


class CameraDisplay(PictureDisplay, FilteredDisplay):
    """The scene as a camera sees it, in front of its image, behind it, or both."""

    class_name = "rviz_default_plugins/Camera"
    properties = (
        *FilteredDisplay.properties,
        Property("Visibility", {}, booleans),  # of displays by name; of all others True
        Property("Image Rendering", _BOTH, words(_BACK, _OVER, _BOTH)),
        Property("Overlay Alpha", 0.5, number(0.0, 1.0)),
        Property("Zoom Factor", 1.0, number(0.00001, 100000.0)),
        Property("Far Plane Distance", 100.0, number(0.02, 100000.0)),  # [m]
    )
    _info: Any = None  # the last one

    @property
    def info_topic(self) -> str:
        """Topic of the camera's CameraInfo, beside that of its image."""
        return info_topic(self["Topic"].removesuffix("/compressed"))

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set properties from a layout, in which Visibility has a Value among the displays."""
        seen = config.get("Visibility")
        if isinstance(seen, Mapping):
            flat = {name: on for name, on in seen.items() if name != "Value" and not isinstance(on, Mapping)}
            config = {**config, "Visibility": {"Value": flat}}
        return super().load(config)

    def reset(self) -> None:
        """Forget the image and the camera."""
        super().reset()
        self._info = None
        text = f"No CameraInfo received on [{self.info_topic}]. Topic may not exist."
        self.statuses.set("warn", _STATUS, text)

    def wanted(self) -> tuple[Interest, ...]:
        """Listen to the images and to what describes their camera."""
        self.statuses.set("ok", _STATUS, "OK")
        qos = Qos(depth=5, reliability="best_effort")
        info = Interest(self.info_topic, INFO, qos, self._take_info, self.statuses)
        return (*super().wanted(), info)

    def show(self, pixels: Pixels) -> None:
        """Show the scene with an image."""
        level, text = self._problem_of_info()
        camera = None
        transform = None if text else self.transform_at(self.message.header)
        if transform is not None:
            height, width = self._info.height or len(pixels), self._info.width or pixels.shape[1]
            camera = self._camera(transform, width, height)
            level, text = ("ok", "ok") if camera else ("error", _NO_POSITION)
        if text:
            self.statuses.set(level, _STATUS, text)
        if camera is None:
            self.context.scene.delete(f"{self.path}/picture")
            return
        self.statuses.set("ok", "Time", "ok")
        self.context.scene.set_object(f"{self.path}/picture", self._inset(pixels, camera, width / height))

    def _inset(self, pixels: Pixels, camera: Camera, columns_per_row: float) -> Inset:
        rendering, p = self["Image Rendering"], self._info.p
        over = 0.0 if rendering == _BACK else self["Overlay Alpha"]
        hidden = tuple(f"displays/{node_name(name)}" for name, on in self["Visibility"].items() if not on)
        aspect = columns_per_row * p[5] / p[0]  # pixels need not be square
        zoomed_in = zoomed(pixels, self["Zoom Factor"])
        return Inset(zoomed_in, aspect, camera, rendering != _OVER, over, hidden)

    def _take_info(self, message: Any) -> None:
        self._info = message
        self.redraw()

    def _problem_of_info(self) -> tuple[Level, str]:
        """Return RViz's reason for rejecting a CameraInfo; an empty text if it is valid."""
        info = self._info
        if info is None:
            return "warn", (
                f"Expecting Camera Info on topic [{self.info_topic}]. "
                "No CameraInfo received. Topic may not exist."
            )
        if not all(np.isfinite(numbers).all() for numbers in (info.d, info.k, info.r, info.p)):
            return "error", "Contains invalid floating point values (nans or infs)"
        return "ok", ""

    def _camera(self, transform_optical_to_fixed: Matrix, width: int, height: int) -> Camera | None:
        """Return the view of a camera whose z is ahead, x to the right, y down; None without focal length."""
        fx, cx, tx = self._info.p[[0, 2, 3]]
        fy, cy, ty = self._info.p[[5, 6, 7]]
        if fx <= 0 or fy <= 0:
            return None
        right, down, ahead, place = transform_optical_to_fixed[:3].T
        eye = place - right * tx / fx + down * ty / fy  # of a pair, relative to its left camera
        zoom = self["Zoom Factor"]
        return Camera(
            eye=tuple(eye),
            target=tuple(eye + ahead),
            up=tuple(-down),
            vertical_fov=2 * atan(height / 2 / fy / zoom),
            shift=((cx - width / 2) / height * fy / fx * zoom, (cy - height / 2) / height * zoom),
            far=self["Far Plane Distance"],
        )


class CameraInfoDisplay(DrawnDisplay):
    """The field of view of a camera as a pyramid: its tip is the camera, which looks along z."""

    class_name = "rviz_default_plugins/CameraInfo"
    type_name = "sensor_msgs/msg/CameraInfo"
    in_frame = True
    properties = (
        *DrawnDisplay.properties,
        Property("Far clip", 1.0, number()),  # [m], height of the pyramid
        Property("Show edges", True, flag),
        Property("Show polygons", True, flag),
        Property("Not show side polygons", True, flag),  # and RViz has no others
        Property("Color", (85, 255, 255), color),
        Property("Edge color", (125, 125, 125), color),
        Property("Alpha", 0.5, number()),
    )

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix | None:
        """Keep the directions of the corners, shape (4, 3), one metre ahead."""
        rays = _rays(message)
        if rays is None:
            self.statuses.set("error", "Camera Info", "Invalid intrinsic matrix")
        else:
            self.statuses.set("ok", "Camera Info", "OK")
        return rays

    def parts(self) -> Mapping[str, Drawable]:
        """Return the edges and sides that are asked for."""
        parts: dict[str, Drawable] = {}
        if not self.kept or self.kept[0] is None:
            return parts
        points = np.vstack([np.zeros(3), self.kept[0] * self["Far clip"]])
        if self["Show edges"]:
            rgba = rgba_of(self, "Edge color")
            parts["edges"] = Lines(points[_EDGES].reshape(-1, 3), rgba, _WIDTH, strip=False)
        if self["Show polygons"] and not self["Not show side polygons"]:
            *rgb, alpha = rgba_of(self)
            squared = (*(channel**2 for channel in rgb), alpha)  # a texture and vertices of the same colour
            parts["sides"] = Mesh(points, _SIDES, squared, lit=False)
        return parts


def _rays(info: Any) -> Matrix | None:
    """Return the directions of the corners of a sensor_msgs/msg/CameraInfo; None without a focal length."""
    fx, cx, tx = info.p[[0, 2, 3]]
    fy, cy, ty = info.p[[5, 6, 7]]
    if not (np.isfinite(info.p).all() and fx and fy):
        return None
    width = (info.roi.width or info.width) // (info.binning_x or 1)
    height = (info.roi.height or info.height) // (info.binning_y or 1)
    x, y = (_CORNERS * (width, height)).T
    return np.column_stack([(x - cx - tx) / fx, (y - cy - ty) / fy, np.ones(4)])
