"""Publishing on the network, restricted to the allowed topics, services and actions.

A robot that is driven is stopped when no more commands are published.
"""

import _thread
import struct
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Self

from course_lib.ros.graph.topics import OWN_TOPICS
from course_lib.ros.robot.link import NetworkPublisher, Report
from course_lib.ros.time import wall

TWIST, TWIST_STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
VELOCITY_TYPES = (TWIST, TWIST_STAMPED)
CDR_LITTLE_ENDIAN = b"\0\1\0\0"
ZERO_TWIST = bytes(48)
STAMP_AND_LENGTH = struct.Struct("<iII")  # seconds, nanoseconds, length of frame_id
ALIGNMENT = 8  # [B]


def stop_message(type_name: str, now_ns: int) -> bytes | None:
    """Return the CDR bytes of a zero velocity, or None if the type is not a velocity command."""
    if type_name == TWIST:
        return CDR_LITTLE_ENDIAN + ZERO_TWIST
    if type_name == TWIST_STAMPED:
        # An empty frame_id is one zero byte, which alignment extends to four.
        return CDR_LITTLE_ENDIAN + STAMP_AND_LENGTH.pack(*divmod(now_ns, 10**9), 1) + bytes(4) + ZERO_TWIST
    return None


def is_motion(cdr: bytes, type_name: str) -> bool:
    """Return whether a message is a nonzero velocity command. Incomplete bytes count as motion."""
    if type_name not in VELOCITY_TYPES:
        return False
    twist = cdr[len(CDR_LITTLE_ENDIAN) :]
    if type_name == TWIST_STAMPED:
        end_of_header = STAMP_AND_LENGTH.size + int.from_bytes(twist[8:12], "little")
        twist = twist[end_of_header + -end_of_header % ALIGNMENT :]
    return len(twist) < len(ZERO_TWIST) or any(twist)


# Time without a command after which a moving robot is stopped [s].
STALE_SECONDS = 0.5
# Period of the thread that stops robots [s].
STOP_PERIOD = 0.05
# Packages whose services a node has by itself, for its parameters, log levels and states.
PACKAGES_OF_NODE_SERVICES = ("rcl_interfaces", "type_description_interfaces", "lifecycle_msgs")
# Limit on calls that are kept for an error message.
MAX_CALLS = 100
# Time after which Zenoh notices that a link is dead [s].
LEASE_SECONDS = 10.0


@dataclass(frozen=True)
class Permissions:
    """Permissions: topics that may be sent, and services and actions that may be called or offered.

    Args:
        allows_everything: Whether all topics and services are allowed, because the program is the
            robot.
    """

    send: frozenset[str] = frozenset()
    call: frozenset[str] = frozenset()
    allows_everything: bool = False

    @classmethod
    def from_names(cls, send: Iterable[str], call: Iterable[str]) -> Self:
        """Create permissions from names, with or without a leading slash."""
        send, call = (frozenset(f"/{name.strip('/')}" for name in names) for names in (send, call))
        return cls(send, call)

    def is_topic_allowed(self, name: str) -> bool:
        """Return whether messages of a topic may be sent, including feedback of an allowed action."""
        is_feedback = "/_action/" in name and self.is_service_allowed(name)
        return self.allows_everything or name in self.send or is_feedback

    def is_service_allowed(self, name: str) -> bool:
        """Return whether a service may be called or offered, including services of an allowed action."""
        return self.allows_everything or name.split("/_action/")[0] in self.call

    def status_rows(self) -> list[tuple[str, object]]:
        """Return the permissions as rows of `ros2 doctor`."""
        default = "everything" if self.allows_everything else "nothing: read-only"
        rows = (("may be sent", self.send), ("may be called", self.call))
        return [(label, ", ".join(sorted(names)) or default) for label, names in rows]


@dataclass(eq=False, repr=False)
class BlockedTraffic:
    """Counts the messages and calls that were not allowed, and reports each name once.

    It also reports services and actions that are not offered to the robot.

    Args:
        report: Prints a line.
        notebook: Whether the link is that of a notebook.
    """

    report: Report
    notebook: bool = False
    counts: Counter[str] = field(default_factory=Counter)
    # Services of the last calls.
    calls: list[str] = field(default_factory=list)
    # Services and actions of the kit that are not offered.
    _not_offered: set[str] = field(default_factory=set)

    def add(self, name: str, option: str) -> None:
        """Count a message or call that `option` would have allowed."""
        if name in OWN_TOPICS:
            # Every node publishes these topics, and they are not needed on the robot.
            return
        if option == "--call":
            self.calls = [*self.calls, name][-MAX_CALLS:]
        if "/_action/" in name:
            # An action is allowed as a whole, with its services and topics.
            name, option = name.split("/_action/")[0], "--call"
        self.counts[name] += 1
        if self.counts[name] == 1:
            traffic = "Messages on" if option == "--send" else "Calls of"
            self._report_rule(f"{traffic} {name} are not sent", "send them", name, option)

    def add_service(self, name: str, type_name: str) -> None:
        """Report a service of the kit that the robot cannot call."""
        if type_name.split("/")[0] in PACKAGES_OF_NODE_SERVICES:
            return
        kind, name = "action" if "/_action/" in name else "service", name.split("/_action/")[0]
        if name not in self._not_offered:
            self._not_offered.add(name)
            self._report_rule(f"The {kind} {name} is not offered to the robot", "offer it", name, "--call")

    def _report_rule(self, effect: str, purpose: str, name: str, option: str) -> None:
        """Report an effect of the permissions, and the option that changes it."""
        python = f' or {option[2:]}=["{name}"]' if self.notebook else ""
        self.report(
            f"{effect}: the link does not allow it. To {purpose}, connect with {option} {name}{python}"
        )


@dataclass(eq=False, repr=False)
class StopCommand:
    """Publishes the commands of one publisher, and a zero velocity when commands are no longer published.

    The link may lose a stop command. If no subscription received it, it is sent again to the next
    subscription.
    """

    publisher: NetworkPublisher
    type_name: str
    # Whether the robot may still be moving.
    _may_move: bool = False
    # Whether there has ever been a subscription.
    _was_matched: bool = False
    # Wall time of the last command [s].
    _last_command_at: float = 0.0
    # Wall time of the last stop [s].
    _stop_sent_at: float | None = None
    _is_stop_lost: bool = False
    _mutex: _thread.LockType = field(default_factory=_thread.allocate_lock)

    def put(self, cdr: bytes) -> None:
        """Publish a command."""
        with self._mutex:
            is_moving, is_matched = is_motion(cdr, self.type_name), self.publisher.is_matched()
            self._last_command_at = wall.monotonic()
            self._stop_sent_at = None if is_moving else self._last_command_at
            self._is_stop_lost = not is_matched
            self._may_move = self._may_move or is_moving
            self._was_matched = self._was_matched or is_matched
            self.publisher.put(cdr)

    def stop(self, older_than: float = 0.0) -> None:
        """Stop the robot if its last command is older than `older_than` [s]. Resend a lost stop."""
        with self._mutex:
            now, is_matched = wall.monotonic(), self.publisher.is_matched()
            # Zenoh may report the first match after the first command was sent.
            self._was_matched |= is_matched and self._last_command_at > 0.0
            if not self._may_move or now - self._last_command_at < older_than:
                return
            zero = stop_message(self.type_name, wall.time_ns())
            if zero is not None and (self._stop_sent_at is None or (is_matched and self._is_stop_lost)):
                self.publisher.put(zero)
                self._stop_sent_at = now
            elif is_matched and self._stop_sent_at is not None and now - self._stop_sent_at > LEASE_SECONDS:
                self._may_move = False
            self._is_stop_lost = not is_matched

    @property
    def is_due(self) -> bool:
        """Whether the robot may need the stop again, because the link may have lost it."""
        return self._may_move and self._was_matched

    @property
    def is_unreceived(self) -> bool:
        """Whether the robot has not received the stop command."""
        return self.is_due and self._is_stop_lost


class OutgoingTraffic:
    """The publishers of the kit that are on the network."""

    def __init__(self) -> None:
        # Publishers by endpoint.
        self._publishers: dict[int, NetworkPublisher] = {}
        # Stop commands of velocity publishers by endpoint.
        self._stops: dict[int, StopCommand] = {}
        # Removed publishers whose stop is still due.
        self._removed: dict[int, StopCommand] = {}
        self._is_open = True
        self._on_end: Callable[[], None] | None = None
        self._close_mutex = _thread.allocate_lock()
        # A separate thread, because the robot must stop even if the kernel is busy.
        _thread.start_new_thread(self._watch, ())

    def add(self, endpoint: int, type_name: str, publisher: NetworkPublisher) -> None:
        """Add a publisher."""
        self._publishers[endpoint] = publisher
        if type_name in VELOCITY_TYPES:
            self._stops[endpoint] = StopCommand(publisher, type_name)

    def drives_on(self, topic: str) -> bool:
        """Return whether a publisher of velocity commands on a topic is on the network."""
        return any(stop.publisher.topic == topic for stop in self._stops.values())

    def put(self, endpoint: int, cdr: bytes) -> bool:
        """Publish a message, after all stops that are due.

        Returns False if the publisher is not on the network. A command is dropped as long as the
        stop of a removed publisher on its topic has not been received.
        """
        stop, publisher = self._stops.get(endpoint), self._publishers.get(endpoint)
        if stop is not None:
            self._repeat_stops()
            moving_topics = [other.publisher.topic for other in self._removed.values() if other.is_unreceived]
            if stop.publisher.topic not in moving_topics:
                stop.put(cdr)
        elif publisher is not None:
            publisher.put(cdr)
        return publisher is not None

    def remove(self, endpoint: int) -> None:
        """Remove a publisher and stop the robot that it has driven."""
        stop, publisher = self._stops.pop(endpoint, None), self._publishers.pop(endpoint, None)
        if stop is not None:
            stop.stop()
        if stop is not None and stop.is_due:
            stop.publisher.hide()
            self._removed[endpoint] = stop
        elif publisher is not None:
            publisher.withdraw()

    def stop(self) -> None:
        """Stop the robot."""
        for stop in self._all_stops():
            stop.stop()

    def close(self, on_end: Callable[[], None]) -> None:
        """Stop the robot and publish nothing more.

        `on_end` is called as soon as the robot has received the stop command.
        """
        self._on_end = on_end
        self.stop()
        self._end_if_stopped()

    def _watch(self) -> None:
        while self._is_open:
            wall.sleep(STOP_PERIOD)
            for stop in tuple(self._stops.values()):
                stop.stop(older_than=STALE_SECONDS)
            self._repeat_stops()
            self._end_if_stopped()

    def _repeat_stops(self) -> None:
        """Send the stops of removed publishers; withdraw publishers without a due stop."""
        for endpoint, stop in tuple(self._removed.items()):
            stop.stop()
            if not stop.is_due and self._removed.pop(endpoint, None) is not None:
                stop.publisher.withdraw()

    def _end_if_stopped(self) -> None:
        # A second caller waits here, because Python must not exit while the first is in the link's
        # library.
        with self._close_mutex:
            if self._on_end is not None and not any(stop.is_unreceived for stop in self._all_stops()):
                self._is_open = False
                self._on_end()

    def _all_stops(self) -> tuple[StopCommand, ...]:
        return (*tuple(self._stops.values()), *tuple(self._removed.values()))
