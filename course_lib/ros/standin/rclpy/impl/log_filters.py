"""`once`, `skip_first` and `throttle_duration_sec`: which calls of one place in the code are logged."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rclpy.clock import Clock
from rclpy.impl.logging_severity import LoggingSeverity

# The filters in the order they are asked in, and their options, of which the first one is required.
FILTERS = {
    "throttle": ("throttle_duration_sec", "throttle_time_source_type"),
    "skip_first": ("skip_first",),
    "once": ("once",),
}
KNOWN = [option for options in FILTERS.values() for option in options]
_CLOCK = Clock()


def asked(severity: LoggingSeverity, name: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """Say what a call asks for, by the words in which rclpy complains if it changes."""
    filters = [each for each, options in FILTERS.items() if any(given.get(option) for option in options)]
    for each in filters:
        if FILTERS[each][0] not in given:
            raise TypeError(
                f'required parameter "{FILTERS[each][0]}" not specified '
                f'but is required for the the logging filter "{each}"'
            )
    for option in given:
        if option not in KNOWN:
            raise TypeError(f'parameter "{option}" is not one of the recognized logging options "{KNOWN}"')
    source = given.get("throttle_time_source_type", _CLOCK)
    if not isinstance(source, Clock):
        raise ValueError(f'Received throttle_time_source_type of "{source}" is not a clock instance')
    parameters = {option: given.get(option) for each in filters for option in FILTERS[each]}
    return {
        "Logger severity": severity,
        "Logger name": name,
        "Requested logging filters": filters,
        "Logging filter parameters": parameters,
    }


@dataclass
class CallSite:
    """One place in the code that logs: what it asked for the first time, and what it has logged so far."""

    asked: dict[str, Any]
    last_ns: int = 0
    logged_once: bool = False
    skipped_first: bool = False

    def lets_pass(self, asked: dict[str, Any]) -> bool:
        """Say whether a call is logged; raises a ValueError if it does not ask for what the first one did."""
        for what, value in asked.items():
            if value != self.asked[what]:
                raise ValueError(f"{what} cannot be changed between calls.")
        ask = {"throttle": self._throttle, "skip_first": self._skip_first, "once": self._once}
        return all(ask[name]() for name in asked["Requested logging filters"])

    def _throttle(self) -> bool:
        options = self.asked["Logging filter parameters"]
        now_ns: int = (options["throttle_time_source_type"] or _CLOCK).now().nanoseconds
        if now_ns < self.last_ns + options["throttle_duration_sec"] * 1e9:
            return False
        self.last_ns = now_ns
        return True

    def _skip_first(self) -> bool:
        passes, self.skipped_first = self.skipped_first, True
        return passes

    def _once(self) -> bool:
        passes, self.logged_once = not self.logged_once, True
        return passes
