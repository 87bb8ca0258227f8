"""`once`, `skip_first` and `throttle_duration_sec`: which calls of one place in the code are logged."""

from collections.abc import Mapping
from dataclasses import dataclass

from rclpy.clock import Clock
from rclpy.impl.logging_severity import LoggingSeverity

Options = Mapping[str, object]

_THROTTLE_CLOCK = Clock()
# The filters in the order they are asked in, their options, and each option's default (None: required).
FILTERS: dict[str, dict[str, object]] = {
    "throttle": {"throttle_duration_sec": None, "throttle_time_source_type": _THROTTLE_CLOCK},
    "skip_first": {"skip_first": None},
    "once": {"once": None},
}
KNOWN = [option for options in FILTERS.values() for option in options]


def filters_of(given: Options) -> list[str]:
    """List the filters that the options of a call ask for.

    Raises:
        TypeError: If an option is unknown or a required one is missing.
    """
    found = [name for name, options in FILTERS.items() if any(given.get(option) for option in options)]
    for name in found:
        for option, default in FILTERS[name].items():
            if option not in given and default is None:
                raise TypeError(
                    f'required parameter "{option}" not specified '
                    f'but is required for the the logging filter "{name}"'
                )
    for option in given:
        if option not in KNOWN:
            raise TypeError(f'parameter "{option}" is not one of the recognized logging options "{KNOWN}"')
    return found


@dataclass
class CallSite:
    """One place in the code that logs: what it asked for the first time, and what it has logged so far."""

    severity: LoggingSeverity
    name: str
    filters: list[str]
    options: dict[str, object]
    last_ns: int = 0
    logged_once: bool = False
    skipped_first: bool = False

    @classmethod
    def first_call(cls, severity: LoggingSeverity, name: str, given: Options) -> "CallSite":
        """Remember what a place asks for."""
        filters = filters_of(given)
        site = cls(severity, name, filters, _options(filters, given))
        source = site.options.get("throttle_time_source_type")
        if source is not None and not isinstance(source, Clock):
            raise ValueError(f'Received throttle_time_source_type of "{source}" is not a clock instance')
        return site

    def require_same(self, severity: LoggingSeverity, name: str, given: Options) -> None:
        """Raise ValueError unless the place asks for what it asked for the first time."""
        filters = filters_of(given)
        changes = {
            "Logger severity": severity != self.severity,
            "Logger name": name != self.name,
            "Requested logging filters": filters != self.filters,
            "Logging filter parameters": _options(filters, given) != self.options,
        }
        for what, changed in changes.items():
            if changed:
                raise ValueError(f"{what} cannot be changed between calls.")

    def lets_pass(self) -> bool:
        """Say whether this call is logged; each filter is asked until one says no."""
        ask = {"throttle": self._throttle, "skip_first": self._skip_first, "once": self._once}
        return all(ask[name]() for name in self.filters)

    def _throttle(self) -> bool:
        clock, seconds = self.options["throttle_time_source_type"], self.options["throttle_duration_sec"]
        assert isinstance(clock, Clock)
        assert isinstance(seconds, (int, float))
        now_ns = clock.now().nanoseconds
        if now_ns < self.last_ns + seconds * 1e9:
            return False
        self.last_ns = now_ns
        return True

    def _skip_first(self) -> bool:
        passes, self.skipped_first = self.skipped_first, True
        return passes

    def _once(self) -> bool:
        passes, self.logged_once = not self.logged_once, True
        return passes


def _options(filters: list[str], given: Options) -> dict[str, object]:
    defaults = {option: default for name in filters for option, default in FILTERS[name].items()}
    return {option: given.get(option, default) for option, default in defaults.items()}
