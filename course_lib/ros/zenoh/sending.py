"""Messages that leave the kit: those that were asked for. A robot that is driven stops when commands stop."""

import _thread
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Self

from course_lib.ros import wall
from course_lib.ros.topics import OWN_TOPICS
from course_lib.ros.zenoh.commands import COMMANDS, moves, still
from course_lib.ros.zenoh.link import Outlet

STALE = 0.5  # [s] without a command, after which a moving robot is stopped
LOOK = 0.05  # [s] between two looks
LEASE = 10.0  # [s] after which Zenoh notices that a link is dead

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

    def __init__(self, tell: Tell, *, notebook: bool = False) -> None:
        self.counts = Counter[str]()
        self._tell, self._notebook = tell, notebook

    def note(self, name: str, option: str) -> None:
        """Count a message or a call; `option` would let it out."""
        if name in OWN_TOPICS:  # they stay here without a word
            return
        self.counts[name] += 1
        if self.counts[name] == 1:
            what = "Messages on" if option == "--send" else "Calls of"
            python = f' or {option[2:]}=["{name}"]' if self._notebook else ""
            self._tell(
                f"{what} {name} are held back: the link only listens. To let them out, connect with "
                f"{option} {name}{python}"
            )


class Brake:
    """Follows a command to move by one of zero when no more commands come.

    A command to stand is sent again once the robot listens again, if the link may have lost it.
    """

    def __init__(self, outlet: Outlet, type_name: str) -> None:
        self.outlet, self._type_name = outlet, type_name
        self._moved = False  # whether the robot may still move
        self._reached = False  # whether the robot has ever heard a command
        self._since = 0.0  # [s] of the wall clock: the last command
        self._sent: float | None = None  # [s]: the command to stand
        self._lost = False  # whether nobody has heard it
        self._mutex = _thread.allocate_lock()

    def put(self, cdr: bytes) -> None:
        """Send a command."""
        with self._mutex:
            moved, heard = moves(cdr, self._type_name), self.outlet.is_heard()
            self._since = wall.monotonic()
            self._sent, self._lost = None if moved else self._since, not heard
            self._moved, self._reached = self._moved or moved, self._reached or heard
            self.outlet.put(cdr)

    def stop(self, older_than: float = 0.0) -> None:
        """Stop the robot, if the last command is older than so many seconds and was to move, or was lost."""
        with self._mutex:
            now, heard = wall.monotonic(), self.outlet.is_heard()
            self._reached |= heard and self._since > 0.0  # Zenoh may say so after the first command went out
            if not self._moved or now - self._since < older_than:
                return
            zero = still(self._type_name, wall.time_ns())
            if zero is not None and (self._sent is None or (heard and self._lost)):
                self.outlet.put(zero)
                self._sent = now
            elif heard and self._sent is not None and now - self._sent > LEASE:
                self._moved = False
            self._lost = not heard

    @property
    def owes(self) -> bool:
        """True while the robot may need its stop again: the link may have lost it, or may be dead."""
        return self._moved and self._reached

    @property
    def is_cut_off(self) -> bool:
        """True while the robot has not got its stop."""
        return self.owes and self._lost


class Sending:
    """The publishers of the kit that are on the network."""

    def __init__(self) -> None:
        self._outlets: dict[int, Outlet] = {}  # by endpoint
        self._brakes: dict[int, Brake] = {}
        self._leaving: dict[int, Brake] = {}  # of publishers that are gone
        self._open = True
        self._end: Callable[[], None] | None = None
        self._ending = _thread.allocate_lock()
        _thread.start_new_thread(self._watch, ())  # not the graph's: a busy kernel must stop the robot too

    def add(self, endpoint: int, type_name: str, outlet: Outlet) -> None:
        """Add a publisher."""
        self._outlets[endpoint] = outlet
        if type_name in COMMANDS:
            self._brakes[endpoint] = Brake(outlet, type_name)

    def put(self, endpoint: int, cdr: bytes) -> bool:
        """Send a message, behind stops that are due; returns False for publishers not on the network.

        A command that nobody hears yet is dropped while another publisher's stop has to go out before it.
        """
        brake, outlet = self._brakes.get(endpoint), self._outlets.get(endpoint)
        if brake is not None:
            self._settle()
            if not any(
                one.is_cut_off and one.outlet.topic == brake.outlet.topic for one in self._leaving.values()
            ):
                brake.put(cdr)
        elif outlet is not None:
            outlet.put(cdr)
        return outlet is not None

    def remove(self, endpoint: int) -> None:
        """Remove a publisher; the robot that it drove stops, as soon as the link lets it."""
        brake, outlet = self._brakes.pop(endpoint, None), self._outlets.pop(endpoint, None)
        if brake is not None:
            brake.stop()
        if brake is not None and brake.owes:
            brake.outlet.hide()
            self._leaving[endpoint] = brake
        elif outlet is not None:
            outlet.withdraw()

    def stop(self) -> None:
        """Stop what is driven."""
        for brake in self._all_brakes():
            brake.stop()

    def close(self, end: Callable[[], None]) -> None:
        """Stop what is driven and send no more; `end` is called once the robot has its stop."""
        self._end = end
        self.stop()
        self._end_if_stopped()

    def _watch(self) -> None:
        while self._open:
            wall.sleep(LOOK)
            for brake in tuple(self._brakes.values()):
                brake.stop(older_than=STALE)
            self._settle()
            self._end_if_stopped()

    def _settle(self) -> None:
        """Send the stops of publishers that are gone, and end those whose robot has its own."""
        for endpoint, brake in tuple(self._leaving.items()):
            brake.stop()
            if not brake.owes and self._leaving.pop(endpoint, None) is not None:
                brake.outlet.withdraw()

    def _end_if_stopped(self) -> None:
        with self._ending:  # who comes second waits, or Python may exit while the other is in Zenoh
            if self._end is not None and not any(brake.is_cut_off for brake in self._all_brakes()):
                self._open = False
                self._end()

    def _all_brakes(self) -> tuple[Brake, ...]:
        return (*tuple(self._brakes.values()), *tuple(self._leaving.values()))
