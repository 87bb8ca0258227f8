"""One interactive marker in the scene: drawn, dragged, and reported to its server."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from course_lib.arrays import Floats, Matrix
from course_lib.displays.display import Context, node_name
from course_lib.displays.frames import NS, nanoseconds, placed, quaternion_of
from course_lib.displays.interactive.client import FEEDBACK
from course_lib.displays.interactive.handles import (
    BUTTON,
    FIXED,
    INHERIT,
    MOVE_AXIS,
    MOVE_ROTATE,
    ROTATE_AXIS,
    VIEW_FACING,
    Message,
    make,
    rotation_of,
    title,
)
from course_lib.displays.interactive.motion import Drag, Pointer, axes_of, facing, rotation
from course_lib.displays.marker.drawables import DRAW
from course_lib.displays.reference_display import axes
from course_lib.displays.statuses import Statuses
from course_lib.robots.rigid_motions import inverse
from course_lib.viewer.camera import Camera
from course_lib.viewer.drawables import Lines

POSE_UPDATE, MENU_SELECT, BUTTON_CLICK, MOUSE_DOWN, MOUSE_UP = range(1, 6)
_CLIENT = "/rviz2"
_IDENTITY: Matrix = np.eye(4)
_AID = 10_000.0  # [m], half the length of the line along an axis
_HELPED = (MOVE_AXIS, ROTATE_AXIS, MOVE_ROTATE)  # modes with such a line


@dataclass
class ShownControl:
    """A control in the scene."""

    message: Message
    path: str  # its node
    axes: Matrix  # its own orientation: columns are x, y and z
    turned: float = 0.0  # by hand, about its x, [rad]

    def orientation(self, pose: Matrix, camera: Matrix) -> Matrix:
        """Return the orientation of its frame in the reference frame, shape (3, 3)."""
        mode = self.message.orientation_mode
        if mode == INHERIT:
            return pose[:3, :3]
        if mode == FIXED:
            return rotation(self.axes[:, 0], self.turned)
        return facing(self.axes, camera, self.turned)

    def drawn(self, pose: Matrix, camera: Matrix) -> Matrix:
        """Return the pose of what is drawn of it, shape (4, 4)."""
        placed = pose.copy()
        is_apart = (
            self.message.orientation_mode == VIEW_FACING and self.message.independent_marker_orientation
        )
        if not is_apart:
            placed[:3, :3] = self.orientation(pose, camera)
        return placed


class ShownMarker:
    """An interactive marker below a node of its own.

    Args:
        context: Of the display.
        path: Its node.
        statuses: Of the display.
        send: Publishes feedback.
    """

    def __init__(
        self, context: Context, path: str, statuses: Statuses, send: Callable[[Message], None]
    ) -> None:
        self._context, self.path, self._statuses, self._send = context, path, statuses, send
        self.message: Message = None
        self.controls: list[ShownControl] = []
        self.aids = False  # whether a line shows the axis of a drag
        self._frame = ""  # the reference frame
        self._locked = False  # moves with its frame
        self._reference: Matrix = np.eye(4)  # transform from the reference frame to the fixed frame
        self._pose: Matrix = np.eye(4)  # in the reference frame
        self._camera: Matrix = np.eye(3)  # that controls face: rows are right, up and ahead
        self._held: ShownControl | None = None
        self._drag: Drag | None = None
        self._seen: tuple[Matrix | None, Camera] | None = (
            None  # the reference and the camera of the last frame
        )
        self._requested: tuple[Message, Message] | None = None  # header and pose that came during a drag
        self._asked: tuple[str, Floats | None] = ("", None)  # the control and the point of the last menu

    def show(self, message: Message) -> None:
        """Draw a message, in place of an earlier one."""
        turned = {control.message.name: control.turned for control in self.controls}
        self.message = message
        self._context.scene.delete(self.path)
        self._take_pose(message.header, message.pose)
        scene = self._context.scene
        scene.set_object(f"{self.path}/axes", axes(message.scale, 0.05 * message.scale))
        above = f"{self.path}/controls"
        self.controls = [
            self._made(control, f"{above}/{node_name(control.name)}", turned.get(control.name, 0.0))
            for control in message.controls
        ]
        self.controls.append(self._made(title(message), f"{self.path}/title", 0.0))
        held = {control.message.name: control for control in self.controls[:-1]}
        if self._held is not None:
            self._held = held.get(self._held.message.name)
        said = f"Locked to frame {self._frame}" if self._locked else "Position is fixed."
        self._statuses.set("ok", message.name, said)
        self._follow(changed=True)

    def move(self, header: Message, pose: Message) -> None:
        """Move to a pose that the server sends; during a drag only after its end."""
        if self._drag is not None:
            self._requested = header, pose
            return
        self._take_pose(header, pose)
        self._follow(changed=True)

    def update(self) -> None:
        """Follow the reference frame and the camera."""
        self._follow(changed=False)

    def control_at(self, path: str) -> ShownControl | None:
        """Return the control that is drawn at a path of the scene."""
        return next((c for c in self.controls if f"{path}/".startswith(f"{c.path}/")), None)

    def press(self, control: ShownControl, pointer: Pointer, point: Floats | None) -> None:
        """Begin a drag; points and rays are in the fixed frame, [m]."""
        inward = inverse(self._reference)
        local = pointer.seen_from(inward)
        grab = self._pose[:3, 3] if point is None else _at(inward, point)
        self._camera = local.axes
        turned = control.orientation(self._pose, local.axes) @ control.axes
        mode = control.message.interaction_mode
        self._held = control
        self._drag = Drag(mode, turned, grab, self._pose, local, self._pose)
        if self.aids and mode in _HELPED and control.message.orientation_mode != VIEW_FACING:
            ends = np.outer((1, -1), control.axes[:, 0] * _AID)
            self._context.scene.set_object(f"{control.path}/aid", Lines(ends, (1.0, 1.0, 1.0, 1.0)))
        for event in (POSE_UPDATE, MOUSE_DOWN):
            self.report(event, control, point)

    def drag(self, pointer: Pointer, shift: bool, ctrl: bool) -> None:
        """Move the marker as its control allows."""
        if self._drag is None or self._held is None:
            return
        before = self._drag
        self._drag = before.to(pointer.seen_from(inverse(self._reference)), shift, ctrl)
        if self._drag.pose is before.pose:
            return
        self._pose = self._drag.pose
        self._held.turned += self._drag.turned - before.turned
        self._place()
        self.report(POSE_UPDATE, self._held, None)

    def release(self, control: ShownControl, point: Floats | None) -> None:
        """End a drag; a button is clicked with that."""
        if control.message.interaction_mode == BUTTON:
            self.report(BUTTON_CLICK, control, point)
        for event in (POSE_UPDATE, MOUSE_UP):
            self.report(event, control, point)
        self._context.scene.delete(f"{control.path}/aid")
        self._held = self._drag = None
        if self._requested is not None:
            requested, self._requested = self._requested, None
            self.move(*requested)

    def ask(self, control: ShownControl, point: Floats | None) -> None:
        """Remember where the menu was asked for."""
        self._asked = control.message.name, point

    def choose(self, entry: int) -> None:
        """Report the choice of an entry of the menu."""
        name, point = self._asked
        known = next((c for c in self.controls if c.message.name == name), self.controls[-1])
        self.report(MENU_SELECT, known, point, menu_entry_id=entry)

    def report(self, event: int, control: ShownControl, point: Floats | None, menu_entry_id: int = 0) -> None:
        """Send feedback: in the reference frame of a marker that is locked to it, else in the fixed frame."""
        feedback = make(
            FEEDBACK, event_type=event, marker_name=self.message.name, control_name=control.message.name,
            client_id=_CLIENT, menu_entry_id=menu_entry_id, mouse_point_valid=point is not None,
        )  # fmt: skip
        frames, fixed = self._context.frames, self._context.frames.fixed_frame
        feedback.header.frame_id = self._frame if self._locked else fixed
        frame = self._frame.removeprefix("/")
        if self._locked and frame != fixed and frames.transform(frame) is not None:
            stamp_ns = frames.buffer.lookup(fixed, frame).stamp_ns
            feedback.header.stamp.sec, feedback.header.stamp.nanosec = divmod(stamp_ns, NS)
        outward = np.eye(4) if self._locked else self._reference
        _write_pose(feedback.pose, outward @ self._pose)
        if point is not None:
            inward = inverse(self._reference) if self._locked else np.eye(4)
            _write_point(feedback.mouse_point, _at(inward, point))
        self._send(feedback)

    def _made(self, message: Message, path: str, turned: float) -> ShownControl:
        """Draw a control."""
        scene = self._context.scene
        control = ShownControl(message, path, rotation_of(message.orientation), turned)
        for number, part in enumerate(part for part in message.markers if part.type in DRAW):
            node = f"{path}/{number}"
            scene.set_transform(node, self._part_pose(control, part))
            for name, drawable in DRAW[part.type](part).parts.items():
                scene.set_object(f"{node}/{name}", drawable)
        return control

    def _part_pose(self, control: ShownControl, part: Message) -> Matrix:
        """Return the pose of a part in its control: one with a frame of its own is there now."""
        if not part.header.frame_id:
            return placed(np.eye(4), part.pose)
        there = self._context.frames.transform(part.header.frame_id, nanoseconds(part.header.stamp))
        above = self._reference @ control.drawn(self._pose, self._camera)
        return inverse(above) @ placed(np.eye(4) if there is None else there, part.pose)

    def _take_pose(self, header: Message, pose: Message) -> None:
        """Accept a pose: with a stamp it stays where it is, without one it moves with its frame."""
        frames, stamp_ns = self._context.frames, nanoseconds(header.stamp)
        self._frame, self._locked = header.frame_id, not stamp_ns
        there = np.eye(4) if self._locked else frames.transform(header.frame_id, stamp_ns)
        self._pose = placed(np.eye(4) if there is None else there, pose)
        reference = self._reference_now()
        self._reference = np.eye(4) if reference is None else reference

    def _reference_now(self) -> Matrix | None:
        """Return the transform from the reference frame to the fixed frame; None if it is not known."""
        frames = self._context.frames
        is_fixed = not self._locked or self._frame.removeprefix("/") == frames.fixed_frame
        return _IDENTITY if is_fixed else frames.transform(self._frame)

    def _follow(self, changed: bool) -> None:
        """Place the reference frame, and everything in it if that or the camera has changed."""
        scene, frames = self._context.scene, self._context.frames
        reference = self._reference_now()
        before, self._seen = self._seen, (reference, scene.camera)
        if not changed and before and before[0] is reference and before[1] is scene.camera:
            return
        if changed or before is None or (before[0] is None) != (reference is None):
            scene.set_visible(self.path, reference is not None)
        if reference is None:
            problem = f"Error getting time of latest transform between {self._frame} and {frames.fixed_frame}"
            self._statuses.set("error", self.message.name, problem)
            return
        camera = axes_of(scene.camera) @ reference[:3, :3]
        if changed or not np.array_equal(reference, self._reference):
            scene.set_transform(self.path, reference)
            changed = True
        if changed or not np.array_equal(camera, self._camera):
            self._reference, self._camera = reference, camera
            self._place()

    def _place(self) -> None:
        """Put the controls where the pose and the camera have them."""
        scene = self._context.scene
        scene.set_transform(f"{self.path}/axes", self._pose)
        for control in self.controls:
            scene.set_transform(control.path, control.drawn(self._pose, self._camera))


def _at(transform: Matrix, point: Floats) -> Floats:
    """Return a point in another frame."""
    moved: Floats = transform[:3, :3] @ point + transform[:3, 3]
    return moved


def _write_point(point: Message, numbers: Floats) -> None:
    point.x, point.y, point.z = map(float, numbers)


def _write_pose(pose: Message, matrix: Matrix) -> None:
    _write_point(pose.position, matrix[:3, 3])
    q = quaternion_of(matrix)
    pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w = map(float, q)
