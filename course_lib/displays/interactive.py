"""RViz's InteractiveMarkers display.

`MarkerClient` is connected to a server of interactive markers (interactive_marker_client.cpp of
rolling). `SceneMarker` keeps one marker in the scene, moves it while it is dragged, and reports the
motion to the server. The geometry of a drag is in `interactive_motion.py`.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from math import isfinite
from typing import Any, Literal

import numpy as np

from course_lib.arrays import Floats, Matrix
from course_lib.displays import interactive_motion as motion
from course_lib.displays.display import Context, Display, Subscription, node_name
from course_lib.displays.frames import NS, nanoseconds, pose_in_fixed_frame, quaternion_of
from course_lib.displays.markers import DRAW
from course_lib.displays.panel.protocol import MenuItem, UseControl
from course_lib.displays.properties import Property, flag, text
from course_lib.displays.shapes import axes
from course_lib.displays.statuses import Level, Statuses, exceptions_as_status
from course_lib.errors import CourseError
from course_lib.robots.kinematics import inverse
from course_lib.ros.graph.topics import Qos
from course_lib.viewer.drawables import Camera, Lines

# Name of RViz's status of the connection to the server.
LABEL = "Interactive Marker Client"
FEEDBACK = "visualization_msgs/msg/InteractiveMarkerFeedback"
QOS = Qos(depth=100)
_SERVICE = "visualization_msgs/srv/GetInteractiveMarkers"
_PATIENCE_NS = NS  # [ns] timeout of a response
_KEEP_ALIVE = 0
_NOT_SPUN = "The server answers while its node is spun, for instance by spin_for(1.0, node)."


@dataclass(frozen=True)
class ClientCallbacks:
    """Callbacks of a client."""

    # Draws markers.
    show: Callable[[Iterable[motion.Message]], None]
    # Applies an InteractiveMarkerUpdate.
    apply_update: Callable[[motion.Message], None]
    clear: Callable[[], None]


class MarkerClient:
    """A connection to a server.

    It requests all markers, then applies updates; a recording has only updates.

    Args:
        context: The context of the display.
        namespace: The namespace of the server, with a leading slash.
        statuses: The statuses of the display.
        actions: The effects on markers.
        transparent: Whether handles may be transparent.
    """

    def __init__(
        self,
        context: Context,
        namespace: str,
        statuses: Statuses,
        actions: ClientCallbacks,
        transparent: bool,
    ) -> None:
        self._context, self._namespace, self._statuses = context, namespace, statuses
        self._actions, self._transparent = actions, transparent
        self._state: Literal["idle", "asking", "running", "stopped"] = "idle"
        self._queue: deque[motion.Message] = deque()
        # Number of the last update.
        self._last_sequence: int | None = None
        self._response: motion.Message = None
        # Number of requests.
        self._request_count = 0
        self._requested_ns = 0
        self._set_status("ok", f"Connected on namespace: {namespace}")
        if context.node is not None:
            context.node.publisher(f"{namespace}/feedback", FEEDBACK, QOS)

    def send(self, feedback: motion.Message) -> None:
        """Publish feedback, unless this is a recording."""
        if self._context.node is not None:
            self._context.node.publish(f"{self._namespace}/feedback", FEEDBACK, QOS, feedback)

    def queue_update(self, update: motion.Message) -> None:
        """Queue an update. A wrong sequence number restarts the connection."""
        if update.type == _KEEP_ALIVE or self._state == "stopped":
            return
        expected = update.seq_num if self._last_sequence is None else self._last_sequence + 1
        if update.seq_num != expected and self._context.node is not None:
            self._restart()
            numbers = f"{expected} (expected) vs. {update.seq_num} (received)"
            self._set_status("warn", f"Update sequence number is out of order. {numbers}")
            return
        self._set_status("ok", f"Received update with sequence number {update.seq_num}")
        self._last_sequence = update.seq_num
        for marker in update.markers:
            motion.complete(marker, self._transparent)
        self._queue.append(update)
        if self._state == "idle":
            # An update shows that the server exists.
            self.step()

    def step(self) -> None:
        """Advance: request markers, show the response, and apply the updates that tf2 can place."""
        node = self._context.node
        if self._state == "stopped":
            return
        if node is None:
            self._state = "running"
        elif not node.has_service(f"{self._namespace}/get_interactive_markers"):
            if self._state != "idle":
                when = "during initialization" if self._state == "asking" else "while running"
                self._restart()
                self._set_status("warn", f"Server not available {when}, resetting")
            self._statuses.hint(LABEL, f"There is no server of interactive markers in {self._namespace}.")
        elif self._state == "idle":
            self._request_markers()
        if self._state == "asking":
            self._show_response()
        if self._state == "running":
            self._apply_updates()

    def stop(self, reason: str) -> None:
        """Remove all markers and ignore all further messages, as RViz does after some errors."""
        self._restart()
        self._state = "stopped"
        self._statuses.hint(LABEL, f"RViz has disconnected: {reason} Untick the display and tick it again.")

    def _set_status(self, level: Level, text: str) -> None:
        self._statuses.set(level, LABEL, text)

    def _restart(self) -> None:
        self._state, self._last_sequence, self._response = "idle", None, None
        # Responses to earlier requests are ignored.
        self._request_count += 1
        self._queue.clear()
        self._actions.clear()

    def _request_markers(self) -> None:
        self._state, self._requested_ns = "asking", self._context.now_ns
        self._request_count += 1
        number = self._request_count
        self._set_status("ok", "Sending request for interactive markers")
        self._statuses.hint(LABEL, _NOT_SPUN)

        def take(response: motion.Message) -> None:
            if number == self._request_count:
                with exceptions_as_status(self._statuses, "Response"):
                    for marker in response.markers:
                        motion.complete(marker, self._transparent)
                    self._response = response
                self._context.on_change()

        if self._context.node is not None:
            self._context.node.call(f"{self._namespace}/get_interactive_markers", _SERVICE, take)

    def _show_response(self) -> None:
        """Show the markers of the response, once it has arrived and tf2 can place them."""
        if self._response is None:
            if self._context.now_ns - self._requested_ns > _PATIENCE_NS:
                self._request_markers()
                problem = "Did not receive response with interactive markers, resending request..."
                self._set_status("warn", problem)
            return
        error, waits = self._transform_problem(self._response.markers)
        self._statuses.hint(LABEL, *([f"RViz repeats its request: {error}"] if error else []))
        if error or waits:
            text = f"Resetting due to transform error: {error}"
            self._set_status("ok", text if error else "Initialization: Waiting for TF info")
            return
        response, self._response = self._response, None
        while self._queue and self._queue[0].seq_num <= response.sequence_number:
            self._queue.popleft()
        self._state = "running"
        self._set_status("ok", "Initialized")
        self._actions.clear()
        self._actions.show(response.markers)

    def _apply_updates(self) -> None:
        """Apply the updates that tf2 can place, in order."""
        while self._queue and self._state == "running":
            update = self._queue[0]
            error, waits = self._transform_problem(chain(update.markers, update.poses))
            if error and self._context.node is not None:
                self._restart()
            if error:
                self._set_status("error", f"Resetting due to transform error: {error}")
            if error or waits:
                return
            self._queue.popleft()
            self._set_status("ok", f"Pushing update with sequence number {update.seq_num}")
            self._actions.apply_update(update)

    def _transform_problem(self, items: Iterable[Any]) -> tuple[str, bool]:
        """Return an error if tf2 cannot place markers or poses, and whether to wait for transforms."""
        waits = False
        headers = []
        for item in items:
            headers.append(item.header)
            controls = getattr(item, "controls", ())
            headers += [m.header for control in controls for m in control.markers if m.header.frame_id]
        frames = self._context.frames
        for header in headers:
            frame, stamp_ns = header.frame_id.removeprefix("/"), nanoseconds(header.stamp)
            if frame == frames.fixed_frame or frames.transform(frame, stamp_ns) is not None:
                continue
            if frames.transform(frame) is None:
                error = frames.buffer.can_transform(frames.fixed_frame, frame, stamp_ns)
                if error:
                    return error, False
            elif frames.buffer.lookup(frames.fixed_frame, frame).stamp_ns <= stamp_ns:
                waits = True
            else:
                return (
                    "The message contains an old timestamp and cannot be transformed "
                    f"('{header.frame_id}' to '{frames.fixed_frame}' at time {stamp_ns / NS:f})."
                ), False
        return "", waits


POSE_UPDATE, MENU_SELECT, BUTTON_CLICK, MOUSE_DOWN, MOUSE_UP = range(1, 6)
_CLIENT = "/rviz2"
_IDENTITY: Matrix = np.eye(4)
# Half the length of the line along an axis [m].
_AID = 10_000.0
# The interaction modes with a line along the axis.
_HELPED = (motion.MOVE_AXIS, motion.ROTATE_AXIS, motion.MOVE_ROTATE)


@dataclass
class SceneControl:
    """A control in the scene."""

    message: motion.Message
    # The path of the control's scene node.
    path: str
    # The orientation of the control: columns are x, y and z.
    axes: Matrix
    # Rotation about x by dragging [rad].
    rotation_angle: float = 0.0

    def orientation(self, pose: Matrix, camera: Matrix) -> Matrix:
        """Return the orientation of the control's frame in the reference frame, shape (3, 3)."""
        mode = self.message.orientation_mode
        if mode == motion.INHERIT:
            return pose[:3, :3]
        if mode == motion.FIXED:
            return motion.rotation(self.axes[:, 0], self.rotation_angle)
        return motion.facing(self.axes, camera, self.rotation_angle)

    def marker_pose(self, pose: Matrix, camera: Matrix) -> Matrix:
        """Return the pose of the control's markers, shape (4, 4)."""
        pose_of_markers = pose.copy()
        is_apart = (
            self.message.orientation_mode == motion.VIEW_FACING
            and self.message.independent_marker_orientation
        )
        if not is_apart:
            pose_of_markers[:3, :3] = self.orientation(pose, camera)
        return pose_of_markers


class SceneMarker:
    """An interactive marker in the scene.

    Args:
        context: The context of the display.
        path: The path of its scene node.
        statuses: The statuses of the display.
        send: Publishes feedback.
    """

    def __init__(
        self, context: Context, path: str, statuses: Statuses, send: Callable[[motion.Message], None]
    ) -> None:
        self._context, self.path, self._statuses, self._send = context, path, statuses, send
        self.message: motion.Message = None
        self.controls: list[SceneControl] = []
        # Whether a line shows the axis of a drag.
        self.shows_aids = False
        # The reference frame.
        self._frame = ""
        # Whether the marker moves with its frame.
        self._is_locked = False
        # Transform from the reference frame to the fixed frame.
        self._reference: Matrix = np.eye(4)
        # The pose in the reference frame.
        self._pose: Matrix = np.eye(4)
        # Camera axes: rows are right, up and ahead.
        self._camera: Matrix = np.eye(3)
        self._pressed_control: SceneControl | None = None
        self._drag: motion.Drag | None = None
        # The reference frame's transform and the camera of the last frame.
        self._last_view: tuple[Matrix | None, Camera] | None = None
        # Header and pose received during a drag.
        self._requested: tuple[motion.Message, motion.Message] | None = None
        # Control and point of the last menu.
        self.menu_request: tuple[str, Floats | None] = ("", None)

    def show(self, message: motion.Message) -> None:
        """Draw a message, replacing an earlier one."""
        angles = {control.message.name: control.rotation_angle for control in self.controls}
        self.message = message
        self._context.scene.delete(self.path)
        self._set_pose(message.header, message.pose)
        scene = self._context.scene
        scene.set_object(f"{self.path}/axes", axes(message.scale, 0.05 * message.scale))
        above = f"{self.path}/controls"
        self.controls = [
            self._draw_control(control, f"{above}/{node_name(control.name)}", angles.get(control.name, 0.0))
            for control in message.controls
        ]
        self.controls.append(self._draw_control(motion.title(message), f"{self.path}/title", 0.0))
        controls_by_name = {control.message.name: control for control in self.controls[:-1]}
        if self._pressed_control is not None:
            self._pressed_control = controls_by_name.get(self._pressed_control.message.name)
        text = f"Locked to frame {self._frame}" if self._is_locked else "Position is fixed."
        self._statuses.set("ok", message.name, text)
        self.update(is_changed=True)

    def move(self, header: motion.Message, pose: motion.Message) -> None:
        """Move to a pose from the server. During a drag, store the pose until the drag ends."""
        if self._drag is not None:
            self._requested = header, pose
            return
        self._set_pose(header, pose)
        self.update(is_changed=True)

    def press(self, control: SceneControl, pointer: motion.Pointer, point: Floats | None) -> None:
        """Begin a drag; points and rays are in the fixed frame, [m]."""
        inward = inverse(self._reference)
        local = pointer.transformed_to(inward)
        grab = self._pose[:3, 3] if point is None else _transform_point(inward, point)
        self._camera = local.axes
        axes = control.orientation(self._pose, local.axes) @ control.axes
        mode = control.message.interaction_mode
        self._pressed_control = control
        self._drag = motion.Drag(mode, axes, grab, self._pose, local, self._pose)
        if self.shows_aids and mode in _HELPED and control.message.orientation_mode != motion.VIEW_FACING:
            ends = np.outer((1, -1), control.axes[:, 0] * _AID)
            self._context.scene.set_object(f"{control.path}/aid", Lines(ends, (1.0, 1.0, 1.0, 1.0)))
        for event in (POSE_UPDATE, MOUSE_DOWN):
            self.report(event, control, point)

    def drag(self, pointer: motion.Pointer, shift: bool, ctrl: bool) -> None:
        """Move the marker as far as its control allows."""
        if self._drag is None or self._pressed_control is None:
            return
        before = self._drag
        self._drag = before.move_to(pointer.transformed_to(inverse(self._reference)), shift, ctrl)
        if self._drag.pose is before.pose:
            return
        self._pose = self._drag.pose
        self._pressed_control.rotation_angle += self._drag.rotation_angle - before.rotation_angle
        self._place_controls()
        self.report(POSE_UPDATE, self._pressed_control, None)

    def release(self, control: SceneControl, point: Floats | None) -> None:
        """End a drag, or click a button."""
        if control.message.interaction_mode == motion.BUTTON:
            self.report(BUTTON_CLICK, control, point)
        for event in (POSE_UPDATE, MOUSE_UP):
            self.report(event, control, point)
        self._context.scene.delete(f"{control.path}/aid")
        self._pressed_control = self._drag = None
        if self._requested is not None:
            requested, self._requested = self._requested, None
            self.move(*requested)

    def choose(self, entry: int) -> None:
        """Report the choice of a menu entry."""
        name, point = self.menu_request
        control = next((c for c in self.controls if c.message.name == name), self.controls[-1])
        self.report(MENU_SELECT, control, point, menu_entry_id=entry)

    def report(
        self,
        event: int,
        control: SceneControl,
        point: Floats | None,
        menu_entry_id: int = 0,
    ) -> None:
        """Send feedback in the reference frame of a locked marker, else in the fixed frame."""
        feedback = motion.make(
            FEEDBACK, event_type=event, marker_name=self.message.name, control_name=control.message.name,
            client_id=_CLIENT, menu_entry_id=menu_entry_id, mouse_point_valid=point is not None,
        )  # fmt: skip
        frames, fixed = self._context.frames, self._context.frames.fixed_frame
        feedback.header.frame_id = self._frame if self._is_locked else fixed
        frame = self._frame.removeprefix("/")
        if self._is_locked and frame != fixed and frames.transform(frame) is not None:
            stamp_ns = frames.buffer.lookup(fixed, frame).stamp_ns
            feedback.header.stamp.sec, feedback.header.stamp.nanosec = divmod(stamp_ns, NS)
        reference = np.eye(4) if self._is_locked else self._reference
        matrix = reference @ self._pose
        _write_point(feedback.pose.position, matrix[:3, 3])
        q = quaternion_of(matrix)
        orientation = feedback.pose.orientation
        orientation.x, orientation.y, orientation.z, orientation.w = map(float, q)
        if point is not None:
            inward = inverse(self._reference) if self._is_locked else np.eye(4)
            _write_point(feedback.mouse_point, _transform_point(inward, point))
        self._send(feedback)

    def _draw_control(self, message: motion.Message, path: str, angle: float) -> SceneControl:
        """Draw a control."""
        scene = self._context.scene
        control = SceneControl(message, path, motion.rotation_of(message.orientation), angle)
        for number, part in enumerate(part for part in message.markers if part.type in DRAW):
            node = f"{path}/{number}"
            # A marker with a frame of its own stays where that frame is now.
            pose = pose_in_fixed_frame(np.eye(4), part.pose)
            if part.header.frame_id:
                there = self._context.frames.transform(part.header.frame_id, nanoseconds(part.header.stamp))
                above = self._reference @ control.marker_pose(self._pose, self._camera)
                pose = inverse(above) @ (pose if there is None else pose_in_fixed_frame(there, part.pose))
            scene.set_transform(node, pose)
            for name, drawable in DRAW[part.type](part).drawables.items():
                scene.set_object(f"{node}/{name}", drawable)
        return control

    def _set_pose(self, header: motion.Message, pose: motion.Message) -> None:
        """Set the pose. With a stamp it is fixed; without one it moves with its frame."""
        frames, stamp_ns = self._context.frames, nanoseconds(header.stamp)
        self._frame, self._is_locked = header.frame_id, not stamp_ns
        there = np.eye(4) if self._is_locked else frames.transform(header.frame_id, stamp_ns)
        self._pose = pose_in_fixed_frame(np.eye(4) if there is None else there, pose)
        reference = self._reference_now()
        self._reference = np.eye(4) if reference is None else reference

    def _reference_now(self) -> Matrix | None:
        """Return the transform from the reference frame to the fixed frame; None if unknown."""
        frames = self._context.frames
        is_fixed = not self._is_locked or self._frame.removeprefix("/") == frames.fixed_frame
        return _IDENTITY if is_fixed else frames.transform(self._frame)

    def update(self, is_changed: bool = False) -> None:
        """Place the marker again if its reference frame or the camera has moved, or `is_changed`."""
        scene, frames = self._context.scene, self._context.frames
        reference = self._reference_now()
        before, self._last_view = self._last_view, (reference, scene.camera)
        if not is_changed and before and before[0] is reference and before[1] is scene.camera:
            return
        if is_changed or before is None or (before[0] is None) != (reference is None):
            scene.set_visible(self.path, reference is not None)
        if reference is None:
            problem = f"Error getting time of latest transform between {self._frame} and {frames.fixed_frame}"
            self._statuses.set("error", self.message.name, problem)
            return
        camera = motion.axes_of(scene.camera) @ reference[:3, :3]
        if is_changed or not np.array_equal(reference, self._reference):
            scene.set_transform(self.path, reference)
            is_changed = True
        if is_changed or not np.array_equal(camera, self._camera):
            self._reference, self._camera = reference, camera
            self._place_controls()

    def _place_controls(self) -> None:
        """Place the controls by the pose and the camera."""
        scene = self._context.scene
        scene.set_transform(f"{self.path}/axes", self._pose)
        for control in self.controls:
            scene.set_transform(control.path, control.marker_pose(self._pose, self._camera))


def _transform_point(transform: Matrix, point: Floats) -> Floats:
    """Transform a point."""
    transformed: Floats = transform[:3, :3] @ point + transform[:3, 3]
    return transformed


def _write_point(point: motion.Message, numbers: Floats) -> None:
    point.x, point.y, point.z = map(float, numbers)


# The commands by the command_type of a menu's entry; 0 is feedback.
_COMMANDS = {1: "ros2 run", 2: "ros2 launch"}
# The numbers of the mouse buttons.
_LEFT, _RIGHT = 0, 2
# The beginnings of titles, and the check boxes that RViz shows for them.
_BOXES = {"[x]": "\u2611", "[ ]": "\u2610"}


def namespace(value: Any) -> str:
    """Convert the namespace of a server, given directly or as its topic of updates."""
    return text(value).removesuffix("/update")


class InteractiveMarkersDisplay(Display):
    """The interactive markers of a server, which can be dragged and clicked in a page."""

    class_name = "rviz_default_plugins/InteractiveMarkers"
    type_name = "visualization_msgs/msg/InteractiveMarkerUpdate"
    topic_label = "Interactive Markers Namespace"
    properties = (
        *Display.properties,
        Property(topic_label, "", namespace),
        Property("Show Descriptions", True, flag),
        Property("Show Axes", False, flag),
        Property("Show Visual Aids", False, flag),
        Property("Enable Transparency", True, flag),
    )

    has_side_effects = True

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.markers: dict[str, SceneMarker] = {}
        # The scene node that contains all markers.
        self.handles = f"{self.path}/handles"
        self._client: MarkerClient | None = None

    def start(self) -> None:
        """Connect to the server, if the display is enabled and has a namespace."""
        self.subscriptions, self._client = (), None
        super().start()
        if self.enabled:
            self._connect()

    def on_property_change(self, label: str) -> None:
        """Reconnect, or show and hide parts of the markers."""
        super().on_property_change(label)
        if self.is_started and label in (self.topic_label, "Enable Transparency"):
            self.start()
        for marker in self.markers.values():
            self._apply_visibility(marker)

    def reset(self) -> None:
        """Remove all markers, and request them again."""
        super().reset()
        self.markers.clear()
        if self._client is not None:
            self._connect()

    def update(self) -> None:
        """Apply the server's updates, and follow frames and camera."""
        if self._client is not None:
            self._client.step()
        for marker in self.markers.values():
            marker.update()

    def on_view_turn(self, camera: Camera) -> None:
        """Turn the controls that face the viewer."""
        for marker in self.markers.values():
            marker.update()

    def message_at(self, path: str) -> motion.Message:
        """Return the interactive marker that an object was drawn from."""
        marker = self._marker_at(path)
        return None if marker is None else marker.message

    def use(self, command: UseControl) -> tuple[MenuItem, ...]:
        """Drag or click the control below a page's pointer, and return the menu that this opens.

        Controls that no longer exist are ignored.
        """
        marker = self._marker_at(command.path)
        controls = [] if marker is None else marker.controls
        control = next((c for c in controls if f"{command.path}/".startswith(f"{c.path}/")), None)
        if marker is None or control is None:
            return ()
        point = None if command.point is None else np.array(command.point)
        if command.button == _LEFT and command.event == "down":
            marker.press(control, _pointer(command), point)
        elif command.button == _LEFT and command.event == "move":
            marker.drag(_pointer(command), command.shift, command.ctrl)
        elif command.button == _LEFT:
            marker.release(control, point)
        mode = control.message.interaction_mode
        is_asked = command.button == _RIGHT or (command.button == _LEFT and mode == motion.MENU)
        if command.event != "up" or not is_asked:
            return ()
        marker.menu_request = control.message.name, point
        return tuple(_items(marker.message.menu_entries))

    def show_only(self, path: str | None) -> None:
        """Hide all controls except the one at a path and the always visible ones.

        None shows all.
        """
        for control in (control for marker in self.markers.values() for control in marker.controls):
            is_held = path is not None and f"{path}/".startswith(f"{control.path}/")
            is_shown = path is None or is_held or control.message.always_visible
            self.context.scene.set_visible(control.path, is_shown)
        for marker in self.markers.values():
            self._apply_visibility(marker)

    def choose(self, path: str, entry: int) -> str:
        """Choose a menu entry of the marker at a path, and return a message for the page."""
        marker = self._marker_at(path)
        entries = {} if marker is None else {entry.id: entry for entry in marker.message.menu_entries}
        if marker is None or entry not in entries:
            raise CourseError("This entry is no longer in the menu. Open the menu again.")
        chosen_entry = entries[entry]
        if chosen_entry.command_type in _COMMANDS:
            command = f"{_COMMANDS[chosen_entry.command_type]} {chosen_entry.command}"
            return f"RViz2 would run a command. Run it in a cell: %{command}"
        marker.choose(entry)
        return ""

    def _connect(self) -> None:
        name = "/" + self[self.topic_label].strip("/")
        if name == "/":
            self.statuses.set("error", LABEL, "Error connecting: empty namespace")
            return
        actions = ClientCallbacks(self._show, self._apply_update, self._clear)
        transparent = self["Enable Transparency"]
        self._client = MarkerClient(self.context, name, self.statuses, actions, transparent)
        updates = f"{name}/update"
        self.subscriptions = (
            Subscription(updates, self.type_name, QOS, self._client.queue_update, self.statuses),
        )
        self.context.on_subscribe(self.subscriptions)

    def _marker_at(self, path: str) -> SceneMarker | None:
        return next((m for m in self.markers.values() if f"{path}/".startswith(f"{m.path}/")), None)

    def _clear(self) -> None:
        for name in list(self.markers):
            self._erase(name)

    def _apply_update(self, update: motion.Message) -> None:
        self._show(update.markers)
        for message in update.poses:
            if not all(map(isfinite, _pose_numbers(message.pose))):
                self.statuses.set("error", message.name, "Pose message contains invalid floats!")
                break
            if message.name not in self.markers:
                self._stop(f"it has no marker {message.name!r}.")
                # RViz's text has only one quotation mark.
                text = f"Pose received for non-existing marker '{message.name}"
                self.statuses.set("error", message.name, text)
                break
            self.markers[message.name].move(message.header, message.pose)
        for name in update.erases:
            self._erase(name)

    def _erase(self, name: str) -> None:
        marker = self.markers.pop(name, None)
        self.statuses.delete(name)
        if marker is not None:
            self.context.scene.delete(marker.path)

    def _show(self, markers: Iterable[motion.Message]) -> None:
        for message in markers:
            if not all(map(isfinite, _numbers(message))):
                self.statuses.set("error", message.name, "Marker contains invalid floats!")
            elif not message.controls:
                self._stop(f"the marker {message.name!r} has no controls.")
                self.statuses.set("ok", message.name, "Marker empty.")
                return
            else:
                if message.name not in self.markers:
                    path = f"{self.handles}/{node_name(message.name)}"
                    marker = SceneMarker(self.context, path, self.statuses, self._send)
                    self.markers[message.name] = marker
                self.markers[message.name].show(message)
                self._apply_visibility(self.markers[message.name])

    def _stop(self, reason: str) -> None:
        if self._client is not None:
            self._client.stop(reason)

    def _send(self, feedback: motion.Message) -> None:
        if self._client is not None:
            self._client.send(feedback)

    def _apply_visibility(self, marker: SceneMarker) -> None:
        """Show the parts that the properties request."""
        self.context.scene.set_visible(f"{marker.path}/axes", self["Show Axes"])
        self.context.scene.set_visible(f"{marker.path}/title", self["Show Descriptions"])
        marker.shows_aids = self["Show Visual Aids"]


def _pointer(command: UseControl) -> motion.Pointer:
    """Return the pointer of a page's command, in the fixed frame."""
    direction = np.array(command.direction)
    if not direction.any() or command.pixel <= 0:
        raise CourseError(
            f"The page's ray {command.direction} with pixels of {command.pixel} m has no direction."
        )
    return motion.Pointer(
        origin=np.array(command.origin),
        direction=direction / np.linalg.norm(direction),
        axes=motion.axes_of(Camera(command.eye, command.target, command.up)),
        pixel=command.pixel,
        is_orthographic=bool(command.scale),
    )


def _items(entries: Iterable[motion.Message]) -> Iterator[MenuItem]:
    """Yield the entries of a menu, each one before its submenu."""
    entries = list(entries)
    visited = {0}
    parents = {entry.parent_id for entry in entries}

    def below(parent: int, depth: int) -> Iterator[MenuItem]:
        for entry in (entry for entry in entries if entry.parent_id == parent and entry.id not in visited):
            visited.add(entry.id)
            box, title = _BOXES.get(entry.title[:3], ""), entry.title
            label = f"{box}{title[3:]}" if box else f"\u3000{title}"
            yield MenuItem(entry.id, "\u3000" * depth + label, entry.id in parents)
            yield from below(entry.id, depth + 1)

    return below(0, 0)


def _pose_numbers(pose: motion.Message) -> tuple[float, ...]:
    p, q = pose.position, pose.orientation
    return p.x, p.y, p.z, q.x, q.y, q.z, q.w


def _numbers(message: motion.Message) -> Iterator[float]:
    """Yield the numbers of an interactive marker that RViz checks."""
    yield from (*_pose_numbers(message.pose), message.scale)
    for control in message.controls:
        q = control.orientation
        yield from (q.x, q.y, q.z, q.w)
        for part in control.markers:
            s, c = part.scale, part.color
            yield from (*_pose_numbers(part.pose), s.x, s.y, s.z, c.r, c.g, c.b, c.a)
            for point in part.points:
                yield from (point.x, point.y, point.z)
