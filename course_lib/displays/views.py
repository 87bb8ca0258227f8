"""RViz's view controllers, which compute a camera from properties and the target frame."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace as dataclass_replace
from math import asin, atan2, cos, pi, sin, tan
from typing import Any, ClassVar

import numpy as np
from msgspec.structs import replace

from course_lib.arrays import Floats, Matrix
from course_lib.displays.frames import FIXED_FRAME, Frames
from course_lib.displays.layout import text_at
from course_lib.displays.properties import NEVER, Property, PropertyHolder, flag, frame, number, vector, words
from course_lib.errors import did_you_mean
from course_lib.viewer.drawables import Camera
from course_lib.viewer.encoding import Message
from course_lib.viewer.scene import Scene, bounds_of

# The maximum pitch [rad], because RViz excludes the poles.
PITCH_LIMIT = pi / 2 - 0.001

COMMON = (
    Property("Target Frame", FIXED_FRAME, frame),
    Property("Near Clip Distance", 0.01, number(0.001, 10_000.0)),  # [m]
    Property("Invert Z Axis", False, flag),
)
# The properties of views that RViz does not turn upside down.
_UPRIGHT = (*COMMON[:-1], Property("Invert Z Axis", False, flag, shown_if=NEVER))


class DragRules(Message, frozen=True):
    """The rules by which a page moves a view when the user drags it."""

    # Whether the view turns around the eye instead of the focal point.
    in_place: bool
    # Whether the up direction follows the target frame.
    aligned: bool
    locked: bool
    # See `ViewController.lift`.
    lift: float
    ground: float  # [m] height of the target frame
    # Diameter [m] of the disc at the focal point while the mouse turns the view; 0 without one.
    focal_size: float
    # Whether the disc has this diameter at any distance. Otherwise it has it at 1 m.
    focal_fixed: bool


class ViewController(PropertyHolder):
    """Base class of all view controllers. If the target frame is unknown, its last pose is used.

    Args:
        properties: Values by RViz's labels, or as Python names: ``Orbit(distance=6.0,
            focal_point=(0, 0, 0.5))``.
    """

    class_name: ClassVar[str]
    _expression = "viewer.view"
    properties: tuple[Property, ...] = COMMON

    # Upward shift of the camera in the image, as a fraction of the distance.
    lift: ClassVar[float] = 0.0

    def __init__(self, **properties: object) -> None:
        super().__init__()
        self._target: Matrix = np.eye(4)
        # Target frame of the last camera.
        self._followed = ""
        self.name = "Current View"
        # Called after a property has changed.
        self.on_change: Callable[[], None] = lambda: None
        for label, value in properties.items():
            self[label] = value

    def on_property_change(self, label: str) -> None:
        """Report the change of a property to `on_change`."""
        self.on_change()

    def __repr__(self) -> str:
        return self.class_name.rpartition("/")[2]

    def camera(self, frames: Frames) -> Camera:
        """Return the camera. It follows the target frame, as long as the transform is known."""
        name = self["Target Frame"]
        target = frames.transform(frames.fixed_frame if name == FIXED_FRAME else name)
        if target is not None:
            before, self._target = self._target, target
            if self._followed not in ("", name):
                self._keep_position(before[:3, 3] - target[:3, 3])
        self._followed = name
        return self._camera(self._target)

    def target_frame_hints(self, frames: Frames) -> tuple[str, ...]:
        """Return a hint about an unknown target frame, which RViz does not report."""
        name, frame_names = self["Target Frame"], frames.buffer.frames()
        if name == FIXED_FRAME or frames.transform(name) is not None:
            return ()
        suggestion = (
            did_you_mean(name, frame_names) or f"; tf2 has {', '.join(sorted(frame_names)) or 'no frame'}."
        )
        return (
            f"tf2 has no transform to the view's Target Frame {name!r}, so the view does not move"
            f"{suggestion}",
        )

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set properties from the view's part of a layout, and keep that part for saving."""
        self.config, self._followed = config, ""
        return super().load(config)

    def drag_rules(self) -> DragRules:
        """Return the rules by which a page turns the view."""
        return DragRules(
            "Position" in self._values,
            False,
            False,
            self.lift,
            float(self._target[2, 3]),
            self._values.get("Focal Shape Size", 0.0),
            self._values.get("Focal Shape Fixed Size", True),
        )

    def return_home(self) -> None:
        """Restore the defaults, like RViz's key Z."""
        kept_labels = ("Target Frame", "Near Clip Distance", "Invert Z Axis")
        self._values |= {p.label: p.default for p in self.properties if p.label not in kept_labels}
        self.on_change()

    def set_from_camera(self, camera: Camera) -> None:
        """Set the properties from a camera that the user moved, without sending it back to the page."""
        self.set_without_callback(
            self._values_for(camera, np.subtract(camera.target, camera.eye), self._target)
        )

    def set_without_callback(self, values: Mapping[str, Any]) -> None:
        """Set properties by label without calling `on_change`."""
        self._values |= {label: self._property(label).convert(value) for label, value in values.items()}

    def mimic(self, other: "ViewController", frames: Frames) -> None:
        """Move the camera to the position of another view, as far as this type of view permits."""
        self._values["Target Frame"] = other["Target Frame"]
        # This determines the pose of the target frame.
        self.camera(frames)
        self.set_from_camera(other.camera(frames))

    def _keep_position(self, shift: Floats) -> None:
        """Keep the camera's position when the target frame changes."""
        for label in ("Focal Point", "Position"):
            if label in self._values:
                self._values[label] = point(np.add(self[label], shift))

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        raise NotImplementedError

    def _values_for(
        self, camera: Camera, forward: Floats, transform_target_to_fixed: Matrix
    ) -> dict[str, Any]:
        """Return the property values for a camera, the inverse of `_camera`."""
        raise NotImplementedError


def direction(yaw: float, pitch: float) -> Floats:
    """Return the unit vector with a yaw and an upward pitch, [rad]."""
    return np.array([cos(yaw) * cos(pitch), sin(yaw) * cos(pitch), sin(pitch)])


def point(array: Floats) -> tuple[float, float, float]:
    """Convert a vector to a tuple of floats."""
    x, y, z = array.tolist()
    return x, y, z


__all__ = ["FPS", "FrameAligned", "Orbit", "ThirdPersonFollower", "TopDownOrtho", "ViewController", "XYOrbit"]

# A factor so small that adding this part of another vector does not change a direction.
_BARELY = 1e-9
# Height of the camera that looks down [m].
_TOP_HEIGHT = 500.0
# Height of an Orbit that replaces a view from above, as in RViz [m].
_ABOVE = 100.0
# Minimum distance of a new focal point [m].
_NEAREST_FOCUS = 0.001


class Orbit(ViewController):
    """A camera around a focal point, which follows the position of the target frame.

    Args:
        properties: Values by RViz's labels, `Orbit(distance=6.0)`, in [m] and [rad].
    """

    class_name = "rviz_default_plugins/Orbit"
    properties = (
        *COMMON,
        Property("Distance", 10.0, number(0.001)),  # [m]
        # The disc that is drawn at the focal point while the mouse turns the view, [m].
        Property("Focal Shape Size", 0.05, number(0.001)),
        Property("Focal Shape Fixed Size", True, flag),
        Property("Yaw", pi / 4, number()),
        Property("Pitch", pi / 4, number(-PITCH_LIMIT, PITCH_LIMIT)),  # [rad]
        Property("Focal Point", (0.0, 0.0, 0.0), vector),  # [m]
    )

    # Whether the view rotates about z with the target frame.
    follows_yaw = False

    def mimic(self, other: ViewController, frames: Frames) -> None:
        """Move the camera to the position of another view.

        A view without a focal point is turned about a point ahead that is as far away as the target
        frame, and a view from above about the point below it.
        """
        super().mimic(other, frames)
        if isinstance(other, TopDownOrtho):
            below = {"Distance": _ABOVE, "Focal Point": (other["X"], other["Y"], 0.0)}
            self.set_without_callback({**below, "Yaw": 1.5 * pi, "Pitch": PITCH_LIMIT})
        elif not isinstance(other, Orbit):
            camera = other.camera(frames)
            eye, ahead = np.array(camera.eye), np.subtract(camera.target, camera.eye)
            distance = max(float(np.linalg.norm(eye - self._target[:3, 3])), _NEAREST_FOCUS)
            target = point(eye + ahead / np.linalg.norm(ahead) * distance)
            self.set_from_camera(dataclass_replace(camera, target=target))

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        rotation, sign = self._target_rotation(transform_target_to_fixed), self._sign()
        outward = rotation @ direction(sign * self["Yaw"], sign * self["Pitch"])
        lifted = self._upward_shift(outward, self["Distance"])
        focus = transform_target_to_fixed[:3, 3] + rotation @ np.array(self["Focal Point"]) + lifted
        eye = focus + self["Distance"] * outward
        return Camera(point(eye), point(focus), (0.0, 0.0, sign), near=self["Near Clip Distance"])

    def _values_for(
        self, camera: Camera, forward: Floats, transform_target_to_fixed: Matrix
    ) -> dict[str, Any]:
        rotation, sign = self._target_rotation(transform_target_to_fixed), self._sign()
        distance = float(np.linalg.norm(forward))
        x, y, z = outward = rotation.T @ -forward / distance
        focus = (
            camera.target
            - self._upward_shift(rotation @ outward, distance)
            - transform_target_to_fixed[:3, 3]
        )
        yaw, pitch = sign * atan2(y, x) % (2 * pi), sign * asin(min(max(z, -1.0), 1.0))
        return {"Distance": distance, "Yaw": yaw, "Pitch": pitch, "Focal Point": point(rotation.T @ focus)}

    def _target_rotation(self, transform_target_to_fixed: Matrix) -> Floats:
        x, y = transform_target_to_fixed[:2, 0]
        yaw = atan2(y, x) if self.follows_yaw else 0.0
        return np.array([[cos(yaw), -sin(yaw), 0.0], [sin(yaw), cos(yaw), 0.0], [0.0, 0.0, 1.0]])

    def _sign(self) -> float:
        return -1.0 if self["Invert Z Axis"] else 1.0

    def _upward_shift(self, outward: Floats, distance: float) -> Floats:
        """Return the upward shift of the camera in the image."""
        up = np.array([0.0, 0.0, self._sign()])
        picture_up = up - outward * (outward @ up)
        lifted: Floats = picture_up * distance * self.lift / max(float(np.linalg.norm(picture_up)), 1e-9)
        return lifted


class XYOrbit(Orbit):
    """An Orbit whose focal point is on the ground and appears in the lower half of the image.

    Args:
        properties: Values by RViz's labels, `XYOrbit(distance=6.0)`, in [m] and [rad].
    """

    class_name = "rviz_default_plugins/XYOrbit"
    lift = 0.2

    def mimic(self, other: ViewController, frames: Frames) -> None:
        """Look from the position of another view if the ground is in front of it; else use the defaults."""
        super().mimic(other, frames)
        camera = other.camera(frames)
        eye = np.subtract(camera.eye, self._target[:3, 3])
        _, up, backward = camera.view_matrix()[:3, :3]
        if camera.orthographic_scale is None and eye[2] * backward[2] > 0 and eye[2] * up[2] > 0:
            # The distances to the ground, ahead and below, [m].
            distance_backward, distance_down = eye[2] / backward[2], eye[2] / up[2]
            distance = distance_backward * distance_down / (self.lift * distance_backward + distance_down)
            focus = (eye - self.lift * distance * up - distance * backward) * [1, 1, 0]
            rotation = self._target_rotation(self._target)
            self._values |= {"Distance": float(distance), "Focal Point": point(rotation.T @ focus)}
        elif camera.orthographic_scale is None:
            self.return_home()


class ThirdPersonFollower(XYOrbit):
    """An XYOrbit that rotates about z with the target frame.

    Args:
        properties: Values by RViz's labels, `ThirdPersonFollower(target_frame="base_link")`, in [m]
            and [rad].
    """

    class_name = "rviz_default_plugins/ThirdPersonFollower"
    follows_yaw = True


class TopDownOrtho(ViewController):
    """A camera that looks straight down, without perspective.

    Args:
        properties: Values by RViz's labels, `TopDownOrtho(scale=80.0)`; the scale is in [px/m].
    """

    class_name = "rviz_default_plugins/TopDownOrtho"
    properties = (
        *_UPRIGHT,
        Property("Scale", 10.0, number(1e-6)),  # [px / m]
        Property("Angle", 0.0, number()),  # [rad]
        Property("X", 0.0, number()),  # [m]
        Property("Y", 0.0, number()),  # [m]
    )

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        x, y, z = transform_target_to_fixed[:3, 3] + np.array([self["X"], self["Y"], 0.0])
        angle = self["Angle"]
        return Camera(
            eye=(x, y, z + _TOP_HEIGHT),
            target=(x, y, z),
            up=(-sin(angle), cos(angle), 0.0),
            near=self["Near Clip Distance"],
            orthographic_scale=self["Scale"],
        )

    def _values_for(
        self, camera: Camera, forward: Floats, transform_target_to_fixed: Matrix
    ) -> dict[str, Any]:
        right_x, right_y, _ = camera.view_matrix()[0, :3]
        x, y, _ = camera.target - transform_target_to_fixed[:3, 3]
        scale = camera.orthographic_scale or self["Scale"]
        return {"Scale": scale, "Angle": atan2(right_y, right_x), "X": x, "Y": y}

    def mimic(self, other: ViewController, frames: Frames) -> None:
        """Look at the focal point of another view, or at the point below it, from above."""
        self._values["Target Frame"] = other["Target Frame"]
        self.camera(frames)
        if isinstance(other, TopDownOrtho):
            self._values |= {label: other[label] for label in ("Scale", "Angle", "X", "Y")}
            return
        position = np.subtract(other.camera(frames).eye, self._target[:3, 3])
        x, y, _ = other["Focal Point"] if isinstance(other, Orbit) else point(position)
        self._values |= {"X": x, "Y": y}

    def _keep_position(self, shift: Floats) -> None:
        self._values |= {"X": self["X"] + float(shift[0]), "Y": self["Y"] + float(shift[1])}


_AXES = {
    "+x axis": (1, 0, 0), "-x axis": (-1, 0, 0), "+y axis": (0, 1, 0),
    "-y axis": (0, -1, 0), "+z axis": (0, 0, 1), "-z axis": (0, 0, -1),
}  # fmt: skip


class FPS(ViewController):
    """A camera that looks around from a point.

    Args:
        properties: Values by RViz's labels, `FPS(position=(2.0, 0.0, 1.0))`, in [m] and [rad].
    """

    class_name = "rviz_default_plugins/FPS"
    properties: tuple[Property, ...] = (
        *_UPRIGHT,
        Property("Yaw", 1.25 * pi, number()),
        Property("Pitch", atan2(10.0, 50.0**0.5), number(-PITCH_LIMIT, PITCH_LIMIT)),  # [rad] downward
        Property("Position", (5.0, 5.0, 10.0), vector),  # [m]
    )

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        rotation = self._target_rotation(transform_target_to_fixed)
        eye = transform_target_to_fixed[:3, 3] + rotation @ np.array(self["Position"])
        target = eye + rotation @ direction(self["Yaw"], -self["Pitch"])
        return Camera(point(eye), point(target), point(rotation[:, 2]), near=self["Near Clip Distance"])

    def _values_for(
        self, camera: Camera, forward: Floats, transform_target_to_fixed: Matrix
    ) -> dict[str, Any]:
        rotation = self._target_rotation(transform_target_to_fixed)
        position = point(rotation.T @ (camera.eye - transform_target_to_fixed[:3, 3]))
        # A camera that looks straight down has its heading from the image's upward direction.
        heading = forward + _BARELY * np.linalg.norm(forward) * np.array(camera.up)
        return {"Position": position, **_angles(rotation.T @ heading)}

    def _target_rotation(self, transform_target_to_fixed: Matrix) -> Floats:
        """Return the rotation of the view with the target frame, shape (3, 3)."""
        return np.eye(3)


class FrameAligned(FPS):
    """A camera that looks around from a point of the target frame, and follows its whole motion.

    RViz has it since Jazzy 14.1.11. It starts at the frame's origin and looks along one of its
    axes.

    Args:
        properties: Values by RViz's labels, `FrameAligned(target_frame="camera")`, in [m] and
            [rad].
    """

    class_name = "rviz_default_plugins/FrameAligned"
    properties = (
        *_UPRIGHT,
        Property("Point towards", "-z axis", words("arbitrary", *_AXES)),
        Property("Yaw", 0.0, number()),
        Property("Pitch", PITCH_LIMIT, number(-PITCH_LIMIT, PITCH_LIMIT)),  # [rad] downward
        Property("Position", (0.0, 0.0, 0.0), vector),  # [m]
        Property("Lock Camera", False, flag),
    )

    def on_property_change(self, label: str) -> None:
        """Look along the chosen axis, or determine the axis from yaw and pitch."""
        axis = _AXES.get(self["Point towards"])
        if label == "Point towards" and axis:
            self._values |= {"Position": (0.0, 0.0, 0.0), **_angles(np.array(axis))}
        elif label in ("Yaw", "Pitch"):
            self._name_axis()
        super().on_property_change(label)

    def set_from_camera(self, camera: Camera) -> None:
        """Set the properties from a camera that the user has moved."""
        super().set_from_camera(camera)
        self._name_axis()

    def drag_rules(self) -> DragRules:
        """Return the rules by which a page turns the view."""
        return replace(super().drag_rules(), aligned=True, locked=self["Lock Camera"])

    def _name_axis(self) -> None:
        forward = direction(self["Yaw"], -self["Pitch"])
        axis_names = (name for name, axis in _AXES.items() if forward @ axis > 0.999)
        self._values["Point towards"] = next(axis_names, "arbitrary")

    def _target_rotation(self, transform_target_to_fixed: Matrix) -> Floats:
        return transform_target_to_fixed[:3, :3]

    def _keep_position(self, shift: Floats) -> None:
        """Do nothing: the camera moves with the new frame."""


def _angles(forward: Floats) -> dict[str, float]:
    """Return yaw and downward pitch of a direction, [rad]."""
    x, y, z = forward / np.linalg.norm(forward)
    return {
        "Yaw": atan2(y, x) % (2 * pi),
        "Pitch": min(max(-asin(min(max(z, -1.0), 1.0)), -PITCH_LIMIT), PITCH_LIMIT),
    }


class FailedView(Orbit):
    """A view controller of an unknown class, which keeps its configuration unchanged."""


VIEWS: dict[str, type[ViewController]] = {
    view.class_name.rpartition("/")[2]: view
    for view in (Orbit, XYOrbit, ThirdPersonFollower, FPS, TopDownOrtho, FrameAligned)
}


def view_of(config: Mapping[str, Any]) -> "tuple[ViewController, *tuple[str, ...]]":
    """Return the view configured in a layout, followed by error messages."""
    class_name = text_at(config, "Class") or Orbit.class_name
    package, _, short = class_name.rpartition("/")
    # ROS 1 calls the package `rviz`.
    is_known = short in VIEWS and package in ("", "rviz", "rviz_default_plugins")
    view = VIEWS[short]() if is_known else FailedView()
    view.name = text_at(config, "Name") or view.name
    unknown = f"{class_name} is not one of {', '.join(VIEWS)}: Orbit is used, and the settings are kept."
    return view, *(() if is_known else (unknown,)), *view.load(config)


# Half the height of a picture at a distance of 1 m.
_SLOPE = tan(pi / 8)
# Aspect ratio (width / height) into which objects have to fit: views in cells are wider, and views
# next to the notebook may be slightly narrower.
_ASPECT = 1.0
# The maximum fraction of the picture that the drawn objects fill.
_FILLED_SHARE = 0.85
# Half the side of the cube around the origin that is always in the picture, [m].
_AROUND_ORIGIN = 0.5
# Size of the drawn objects, as a multiple of their distance to the origin, below which the origin
# is left out.
_FAR_AWAY = 0.03
# [m] smallest and largest distance of a view.
_NEAREST, _FARTHEST = 2.0, 500.0


class Framing:
    """Moves a view that no program, layout or user has set, so that it shows all objects.

    RViz starts 10 m from the origin, whatever is drawn. Here, the default view is moved so that all
    drawn objects and the origin are in the image: when something is drawn for the first time, and
    when a display draws for the first time, or a cell shows the view, while an object is outside
    the image. It does not follow motion: a robot that drives away leaves the image, as in RViz.

    Args:
        scene: The drawn objects.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        # Paths of displays, and of objects added by programs, that have drawn something.
        self._known_paths: set[str] = set()

    def choose(self, view: Orbit, camera: Camera, references: set[str], *, is_opened: bool) -> bool:
        """Move a view to the drawn objects if one of the conditions of this class is met.

        Args:
            view: The view to move.
            camera: The current camera of the view.
            references: Paths of grids and axes, which have no place of their own.
            is_opened: Whether a cell is about to show the view.

        Returns:
            Whether the view has changed.
        """
        with self._scene.lock:
            is_first = not self._known_paths
            new = [
                node.path
                for root in self._scene.node("").children.values()
                for node in root.children.values()
                if node.path not in self._known_paths
                and node.path not in references
                and any(inner.object is not None for inner in node.subtree())
            ]
            self._known_paths.update(new)
            if not new and (is_first or not is_opened):
                return False
            bounds = self._bounds_in(self._scene)
        if bounds is None:
            # Only overlays were drawn before, so the next drawable is the first one with a
            # position.
            self._known_paths.difference_update(new)
            return False
        corners = _corners_to_show(bounds)
        return (is_first or not _are_in_view(camera, corners)) and _move(view, corners)

    def include(self, view: Orbit, camera: Camera, scenes: Iterable[Scene]) -> bool:
        """Move a view so that it shows all objects in scenes, for example of a recording.

        Args:
            view: The view to move.
            camera: The current camera of the view.
            scenes: Copies of the scene at several times.

        Returns:
            Whether the view has changed.
        """
        found = [bounds for scene in scenes if (bounds := self._bounds_in(scene)) is not None]
        if not found:
            return False
        lows, highs = zip(*found, strict=True)
        corners = _corners_to_show(np.stack([np.min(lows, axis=0), np.max(highs, axis=0)]))
        return not _are_in_view(camera, corners) and _move(view, corners)

    def _bounds_in(self, scene: Scene) -> Floats | None:
        """Return the bounds of the visible objects of the known paths in a scene, or None."""
        below = (scene.find(path) for path in self._known_paths)
        nodes = [inner for node in below if node is not None for inner in node.subtree()]
        visible_paths = [node.path for node in nodes if node.object and scene.is_visible(node.path)]
        return bounds_of(scene, visible_paths)


def _corners_to_show(bounds: Floats) -> Floats:
    """Return the corners of a box, shape (8, 3).

    The box is extended by the origin, unless the drawn objects are small and far away from it.
    """
    low, high = bounds
    distance = np.linalg.norm(np.maximum(0, np.maximum(low, -high)))
    if np.linalg.norm(high - low) >= _FAR_AWAY * distance:
        bounds = np.stack([np.minimum(low, -_AROUND_ORIGIN), np.maximum(high, _AROUND_ORIGIN)])
    return np.stack(np.meshgrid(*bounds.T, indexing="ij"), axis=-1).reshape(-1, 3)


def _are_in_view(camera: Camera, corners: Floats) -> bool:
    """Return whether all corners are in the picture of a camera."""
    focal_distance = np.linalg.norm(np.subtract(camera.eye, camera.target))
    needed = _distance_to_fit(corners, camera, np.array(camera.target), filled_share=1.0)
    return bool(needed <= focal_distance)


def _move(view: Orbit, corners: Floats) -> bool:
    """Move a view so that it shows all corners. Return whether it has changed."""
    focus = np.round((corners.min(axis=0) + corners.max(axis=0)) / 2, 2)
    camera = Camera(tuple(focus + direction(view["Yaw"], view["Pitch"])), tuple(focus))
    distance = _distance_to_fit(corners, camera, focus, filled_share=_FILLED_SHARE)
    x, y, z = (focus + 0.0).tolist()
    values = {"Distance": min(max(round(distance, 1), _NEAREST), _FARTHEST), "Focal Point": (x, y, z)}
    is_changed = any(view[label] != value for label, value in values.items())
    view.set_without_callback(values)
    return is_changed


def _distance_to_fit(corners: Floats, camera: Camera, focus: Floats, filled_share: float) -> float:
    """Return the distance [m] to a focal point from which all corners are in the picture."""
    right, up, depths = ((corners - focus) @ camera.view_matrix()[:3, :3].T).T
    distances = np.maximum(np.abs(up), np.abs(right) / _ASPECT) / (_SLOPE * filled_share)
    return float((distances + depths).max())
