"""The Camera display: the scene from a camera's place, with the camera's image."""

from collections.abc import Mapping
from math import atan
from typing import Any

import numpy as np

from course_lib.displays.display import Subscription, node_name
from course_lib.displays.frames import Matrix
from course_lib.displays.images.display import PictureDisplay, info_topic
from course_lib.displays.images.pixels import Pixels, zoomed
from course_lib.displays.properties import Property, booleans, number, words
from course_lib.displays.statuses import Level
from course_lib.displays.topic_display import FilteredDisplay
from course_lib.ros.qos import Qos
from course_lib.viewer.camera import Camera
from course_lib.viewer.drawables import Inset

INFO = "sensor_msgs/msg/CameraInfo"
_BOTH, _BACK, _OVER = "background and overlay", "background", "overlay"
_STATUS = "Camera Info"
_NO_POSITION = "CameraInfo/P resulted in an invalid position calculation (nans or infs)"


class CameraDisplay(PictureDisplay, FilteredDisplay):
    """Shows what a camera would see of the scene, in front of its image, behind it, or both."""

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
        """Where the camera is described: beside its image."""
        return info_topic(self["Topic"].removesuffix("/compressed"))

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Take the properties of a layout, where Visibility has a Value of its own among the displays."""
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

    def wanted(self) -> tuple[Subscription, ...]:
        """Listen to the images and to what describes their camera."""
        self.statuses.set("ok", _STATUS, "OK")
        qos = Qos(depth=5, reliability="best_effort")
        info = Subscription(self.info_topic, INFO, qos, self._take_info, self.statuses)
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
        """Say in RViz's words why the description of the camera is of no use; no text if it is."""
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
