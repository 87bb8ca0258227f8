"""Messages that leave the kit: those that were asked for. A robot that is driven stops when commands stop."""

import _thread
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Self

from course_lib.ros import wall
from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.zenoh.link import Outlet

STALE = 0.5  # [s] without a command, after which a moving robot is stopped
LOOK = 0.05  # [s] between two looks
LEASE = 10.0  # [s] after which Zenoh notices that a link is dead
UNSENT = ("/rosout", "/parameter_events")  # every node has them: they stay here without a word
COMMANDS = {"geometry_msgs/msg/Twist": "", "geometry_msgs/msg/TwistStamped": "twist"}  # where the speeds are

Tell = Callable[[str], None]  # prints a line


@dataclass(frozen=True)
class Allowed:
    """The topics that may be sent, and the services and actions that may be called or offered."""

    send: frozenset[str] = frozenset()
    call: frozenset[str] = frozenset()
    everything: bool = False  # of a program that is the robot

    @classmethod
    def of(cls, send: Iterable[str], call: Iterable[str]) -> Self:
        """Return what is allowed by names, with or without their first slash."""
        send, call = (frozenset(f"/{name.strip('/')}" for name in names) for names in (send, call))
        return cls(send, call)

    def topic(self, name: str) -> bool:
        """Return whether messages of a topic may go out; feedback of an allowed action may."""
        return self.everything or name in self.send or ("/_action/" in name and self.service(name))

    def service(self, name: str) -> bool:
        """Return whether a service may be called or offered; those of an allowed action may."""
        return self.everything or name.split("/_action/")[0] in self.call

    def rows(self) -> list[tuple[str, object]]:
        """Return what is allowed, as rows of `ros2 doctor`."""
        others = "everything" if self.everything else "nothing: read-only"
        names = (("may be sent", self.send), ("may be called", self.call))
        return [(what, ", ".join(sorted(allowed)) or others) for what, allowed in names]


class HeldBack:
    """Counts of messages and calls that stay here; each name is told once."""

    def __init__(self, tell: Tell) -> None:
        self.counts = Counter[str]()
        self._tell = tell

    def note(self, name: str, option: str) -> None:
        """Count a message or a call; `option` would let it out."""
        if name in UNSENT:
            return
        self.counts[name] += 1
        if self.counts[name] == 1:
            what = "Messages on" if option == "--send" else "Calls of"
            self._tell(
                f"{what} {name} are held back: the link only listens. To let them out, connect with "
                f"{option} {name}"
            )


class Brake:
    """Follows a command to move by one of zero when no more commands come.

    A command to stand is sent again once the robot listens again, if the link may have lost it.
    """

    def __init__(self, outlet: Outlet, type_name: str) -> None:
        self._outlet, self._type_name = outlet, type_name
        self._zero: bytes | None = None  # stops the robot; None: it stands
        self._since = 0.0  # [s] of the wall clock: the last command
        self._sent: float | None = None  # [s]: the command to stand
        self._lost = False  # whether nobody has heard it
        self._mutex = _thread.allocate_lock()

    def put(self, cdr: bytes) -> None:
        """Send a command."""
        with self._mutex:
            zero = _zero_of(cdr, self._type_name)
            self._since = wall.monotonic()
            self._sent, self._lost = None if zero else self._since, not self._outlet.is_heard()
            self._zero = zero or self._zero
            self._outlet.put(cdr)

    def stop(self, older_than: float = 0.0) -> None:
        """Stop the robot, if the last command is older than so many seconds and was to move, or was lost."""
        with self._mutex:
            now = wall.monotonic()
            if self._zero is None or now - self._since < older_than:
                return
            heard = self._outlet.is_heard()
            if self._sent is None or (heard and self._lost):
                self._outlet.put(self._zero)
                self._sent = now
            elif heard and now - self._sent > LEASE:
                self._zero = None
            self._lost = not heard


def _zero_of(cdr: bytes, type_name: str) -> bytes | None:
    """Return a command to stand; None if this one is."""
    message = deserialize(cdr, message_class(type_name))
    place = COMMANDS[type_name]
    twist: Any = getattr(message, place) if place else message
    speeds = [(part, axis) for part in (twist.linear, twist.angular) for axis in "xyz"]
    if not any(getattr(part, axis) for part, axis in speeds):
        return None
    for part, axis in speeds:
        setattr(part, axis, 0.0)
    return serialize(message)


class Sending:
    """The publishers of the kit that are on the network."""

    def __init__(self) -> None:
        self._outlets: dict[int, Outlet] = {}  # by endpoint
        self._brakes: dict[int, Brake] = {}
        self._open = True
        _thread.start_new_thread(self._watch, ())  # not the graph's: a busy kernel must stop the robot too

    def add(self, endpoint: int, type_name: str, outlet: Outlet) -> None:
        """Add a publisher."""
        self._outlets[endpoint] = outlet
        if type_name in COMMANDS:
            self._brakes[endpoint] = Brake(outlet, type_name)

    def put(self, endpoint: int, cdr: bytes) -> bool:
        """Send a message; returns False for publishers that are not on the network."""
        outlet = self._brakes.get(endpoint) or self._outlets.get(endpoint)
        if outlet is not None:
            outlet.put(cdr)
        return outlet is not None

    def remove(self, endpoint: int) -> None:
        """Remove a publisher; the robot that it drove stops."""
        brake, outlet = self._brakes.pop(endpoint, None), self._outlets.pop(endpoint, None)
        if brake is not None:
            brake.stop()
        if outlet is not None:
            outlet.withdraw()

    def stop(self) -> None:
        """Stop what is driven."""
        for brake in tuple(self._brakes.values()):
            brake.stop()

    def close(self) -> None:
        """Stop what is driven, and send no more."""
        self._open = False
        self.stop()

    def _watch(self) -> None:
        while self._open:
            wall.sleep(LOOK)
            for brake in tuple(self._brakes.values()):
                brake.stop(older_than=STALE)
