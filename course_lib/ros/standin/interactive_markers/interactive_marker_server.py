"""The server of interactive markers, which clients like RViz show, move and send feedback about."""

# ruff: noqa: N802 - the names are ROS's

from collections.abc import Callable
from dataclasses import dataclass, field
from threading import Lock
from typing import Any

from builtin_interfaces.msg import Time as TimeMessage
from geometry_msgs.msg import Pose
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.time import Time
from std_msgs.msg import Header
from visualization_msgs.msg import (
    InteractiveMarker,
    InteractiveMarkerFeedback,
    InteractiveMarkerPose,
    InteractiveMarkerUpdate,
)
from visualization_msgs.srv import GetInteractiveMarkers

Callback = Callable[[InteractiveMarkerFeedback], object]
_UPDATES, _FEEDBACK = QoSProfile(depth=100), QoSProfile(depth=1)
# A client that has moved a marker has exclusive control of it for this long.
_OWNED = Duration(seconds=1.0)


@dataclass
class Callbacks:
    """Feedback callbacks of a marker: one for each event type, and a default for all others."""

    default: Callback | None = None
    by_type: dict[int, Callback] = field(default_factory=dict)

    def put(self, callback: Callback | None, event_type: int) -> None:
        """Set or remove the callback for an event type."""
        if event_type == InteractiveMarkerServer.DEFAULT_FEEDBACK_CALLBACK:
            self.default = callback
        elif callback:
            self.by_type[event_type] = callback
        else:
            self.by_type.pop(event_type, None)


@dataclass
class MarkerContext:
    """A marker that clients show."""

    int_marker: InteractiveMarker
    callbacks: Callbacks
    last_feedback: Time
    last_client_id: str = ""


@dataclass
class UpdateContext:
    """A change that `applyChanges` publishes: a whole marker, only its pose, or its removal."""

    FULL_UPDATE, POSE_UPDATE, ERASE = range(3)

    update_type: int = FULL_UPDATE
    int_marker: InteractiveMarker = field(default_factory=InteractiveMarker)
    callbacks: Callbacks = field(default_factory=Callbacks)


class InteractiveMarkerServer:
    """The markers of one namespace. Changes are sent to clients by `applyChanges`.

    Args:
        node: Publishes updates, and receives feedback while it is spun.
        namespace: Prefix of the topics `update` and `feedback` and the service
            `get_interactive_markers`.
        update_pub_qos: QoS of the updates.
        feedback_sub_qos: QoS of the feedback.
    """

    DEFAULT_FEEDBACK_CALLBACK = 255

    def __init__(
        self,
        node: Node,
        namespace: str,
        *,
        update_pub_qos: QoSProfile = _UPDATES,
        feedback_sub_qos: QoSProfile = _FEEDBACK,
    ) -> None:
        self.node, self.namespace = node, namespace
        self.seq_num = 0
        self.mutex = Lock()
        self.marker_contexts: dict[str, MarkerContext] = {}
        self.pending_updates: dict[str, UpdateContext] = {}
        self.get_interactive_markers_srv: Any = node.create_service(
            GetInteractiveMarkers, f"{namespace}/get_interactive_markers", self.getInteractiveMarkersCallback
        )
        self.update_pub: Any = node.create_publisher(
            InteractiveMarkerUpdate, f"{namespace}/update", update_pub_qos
        )
        self.feedback_sub: Any = node.create_subscription(
            InteractiveMarkerFeedback, f"{namespace}/feedback", self.processFeedback, feedback_sub_qos
        )

    def shutdown(self) -> None:
        """Erase all markers and destroy the publisher, the subscription and the service.

        Call it before the node is destroyed.
        """
        if self.update_pub is None:
            return
        if self.node.context.ok():
            self.clear()
            self.applyChanges()
        self.node.destroy_service(self.get_interactive_markers_srv)
        self.node.destroy_publisher(self.update_pub)
        self.node.destroy_subscription(self.feedback_sub)
        self.get_interactive_markers_srv = self.update_pub = self.feedback_sub = None

    def insert(
        self,
        marker: InteractiveMarker,
        *,
        feedback_callback: Callback | None = None,
        feedback_type: int = DEFAULT_FEEDBACK_CALLBACK,
    ) -> None:
        """Add or replace a marker. Its callback takes effect immediately."""
        with self.mutex:
            update = self.pending_updates.setdefault(marker.name, UpdateContext())
            update.update_type, update.int_marker = UpdateContext.FULL_UPDATE, marker
        if feedback_callback is not None:
            self.setCallback(marker.name, feedback_callback, feedback_type)

    def setPose(self, name: str, pose: Pose, header: Header | None = None) -> bool:
        """Move a marker that clients already show.

        A header without a frame keeps the marker's header. Returns whether the marker could be
        moved.
        """
        with self.mutex:
            stored, update = self.marker_contexts.get(name), self.pending_updates.get(name)
            if stored is None or (update and update.update_type == UpdateContext.FULL_UPDATE):
                return False
            keeps = header is None or not header.frame_id
            self._set_pose(name, pose, stored.int_marker.header if header is None or keeps else header)
            return True

    def erase(self, name: str) -> bool:
        """Remove a marker. Return whether there is one of that name."""
        with self.mutex:
            if name not in self.pending_updates and name not in self.marker_contexts:
                return False
            self.pending_updates.setdefault(name, UpdateContext()).update_type = UpdateContext.ERASE
            return True

    def clear(self) -> None:
        """Remove all markers."""
        self.pending_updates = {}
        for name in self.marker_contexts:
            self.erase(name)

    def setCallback(
        self,
        name: str,
        feedback_callback: Callback | None,
        feedback_type: int = DEFAULT_FEEDBACK_CALLBACK,
    ) -> bool:
        """Set the callback for one feedback type, or the default for all others.

        None removes it.
        """
        with self.mutex:
            contexts = (self.marker_contexts.get(name), self.pending_updates.get(name))
            for context in (context for context in contexts if context is not None):
                context.callbacks.put(feedback_callback, feedback_type)
            return any(contexts)

    def applyChanges(self) -> None:
        """Apply the pending changes and publish them in one update."""
        with self.mutex:
            if not self.pending_updates:
                return
            message = InteractiveMarkerUpdate(type=InteractiveMarkerUpdate.UPDATE)
            for name, update in self.pending_updates.items():
                stored = self.marker_contexts.get(name)
                marker = update.int_marker
                if update.update_type == UpdateContext.ERASE:
                    if self.marker_contexts.pop(name, None):
                        message.erases.append(name)
                elif update.update_type == UpdateContext.FULL_UPDATE:
                    if stored is None:
                        now = self.node.get_clock().now()
                        stored = self.marker_contexts[name] = MarkerContext(marker, update.callbacks, now)
                    stored.int_marker = marker
                    message.markers.append(marker)
                elif stored is not None:
                    stored.int_marker.pose, stored.int_marker.header = marker.pose, marker.header
                    pose = InteractiveMarkerPose(header=marker.header, pose=marker.pose, name=name)
                    message.poses.append(pose)
            self.pending_updates = {}
        self.seq_num += 1
        self.publish(message)

    def get(self, name: str) -> InteractiveMarker | None:
        """Return a marker as it will be after `applyChanges`; None if none has that name."""
        update, stored = self.pending_updates.get(name), self.marker_contexts.get(name)
        if update and update.update_type == UpdateContext.FULL_UPDATE:
            return update.int_marker
        if stored is None or (update and update.update_type == UpdateContext.ERASE):
            return None
        if update:
            stored.int_marker.pose = update.int_marker.pose
        return stored.int_marker

    def processFeedback(self, feedback: InteractiveMarkerFeedback) -> None:
        """Move the marker as the client requests, call the callback, and publish."""
        with self.mutex:
            stored = self.marker_contexts.get(feedback.marker_name)
            if stored is None:
                return
            now = self.node.get_clock().now()
            # After its feedback, another client has exclusive control of the marker for some time.
            if now - stored.last_feedback < _OWNED and stored.last_client_id != feedback.client_id:
                return
            stored.last_feedback, stored.last_client_id = now, feedback.client_id
            if feedback.event_type == InteractiveMarkerFeedback.POSE_UPDATE:
                stored_header = stored.int_marker.header
                header = stored_header if stored_header.stamp == TimeMessage() else feedback.header
                self._set_pose(feedback.marker_name, feedback.pose, header)
        callback = stored.callbacks.by_type.get(feedback.event_type, stored.callbacks.default)
        if callback is not None:
            callback(feedback)
        self.applyChanges()

    def publish(self, update: InteractiveMarkerUpdate) -> None:
        """Publish an update with its sequence number."""
        update.seq_num = self.seq_num
        self.update_pub.publish(update)

    def getInteractiveMarkersCallback(
        self, request: GetInteractiveMarkers.Request, response: GetInteractiveMarkers.Response
    ) -> GetInteractiveMarkers.Response:
        """Respond with all markers and the sequence number of the last update."""
        with self.mutex:
            response.sequence_number = self.seq_num
            response.markers = [context.int_marker for context in self.marker_contexts.values()]
            return response

    def _set_pose(self, name: str, pose: Pose, header: Header) -> None:
        update = self.pending_updates.setdefault(name, UpdateContext(UpdateContext.POSE_UPDATE))
        if update.update_type != UpdateContext.FULL_UPDATE:
            update.update_type = UpdateContext.POSE_UPDATE
        update.int_marker.pose, update.int_marker.header = pose, header
