"""The analyzers of ROS's diagnostic_aggregator, with the rules of its C++ sources (branch ros2-jazzy)."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from rclpy.logging import get_logger
from rclpy.parameter import Parameter

from course_lib.errors import CourseError

OK, ERROR, STALE = DiagnosticStatus.OK, DiagnosticStatus.ERROR, DiagnosticStatus.STALE
_WORDS = {OK: "OK", DiagnosticStatus.WARN: "Warning", ERROR: "Error", STALE: "Stale"}
Parameters = Mapping[str, Any]
_Table = Mapping[str, tuple[Parameter.Type, Any]]  # by name: type, default

_STRINGS = (Parameter.Type.STRING_ARRAY, ())
GENERIC: _Table = {
    "path": (Parameter.Type.STRING, ""),
    **dict.fromkeys(("find_and_remove_prefix", "remove_prefix", "startswith", "contains"), _STRINGS),
    **dict.fromkeys(("expected", "regex"), _STRINGS),
    "timeout": (Parameter.Type.DOUBLE, 5.0),  # [s]
    "num_items": (Parameter.Type.INTEGER, -1),
    "discard_stale": (Parameter.Type.BOOL, False),
}
AGGREGATOR: _Table = {
    "path": (Parameter.Type.STRING, ""),
    "pub_rate": (Parameter.Type.DOUBLE, 1.0),  # [Hz]
    "history_depth": (Parameter.Type.INTEGER, 1000),
    "other_as_errors": (Parameter.Type.BOOL, False),
    "critical": (Parameter.Type.BOOL, False),
}


class GenericAnalyzer:
    """Keeps the last status of each name that matches; those that stay away for long are stale.

    `path` is its parent's, `parameters` are its YAML; they raise a ValueError if they could match nothing.
    """

    def __init__(self, path: str, parameters: Parameters) -> None:
        given = checked(parameters, GENERIC)
        self.name = given["path"]
        self.path = f"{path}/{self.name}"
        found = given["find_and_remove_prefix"]
        self._starts = tuple(given["startswith"] or found)
        self._contains = given["contains"]
        self._patterns = [re.compile(pattern) for pattern in given["regex"]]
        self._prefixes = [output_name(one) for one in given["remove_prefix"] or found]
        self._timeout_ns = round(given["timeout"] * 1e9)
        self._count = given["num_items"]
        self._discards = given["discard_stale"]
        missing = [DiagnosticStatus(name=name, level=STALE, message="Missing") for name in given["expected"]]
        self._items = {status.name: (0, status) for status in missing}  # with the time they came, [ns]
        if not (self._starts or self._contains or self._patterns):
            raise ValueError(
                f"GenericAnalyzer '{self.name}' was not initialized with any way of checking diagnostics."
                f"Name: {path}, namespace: /\n"
                "hint: give it startswith, contains or regex; in Jazzy name and expected match nothing."
            )

    def match(self, name: str) -> bool:
        """Return whether a name matches one of its prefixes, parts or patterns."""
        return (
            name.startswith(self._starts)
            or any(part in name for part in self._contains)
            or any(pattern.fullmatch(name) for pattern in self._patterns)
        )

    def analyze(self, status: DiagnosticStatus, now_ns: int) -> None:
        """Keep a status."""
        self._items[status.name] = now_ns, status

    def report(self, now_ns: int) -> list[DiagnosticStatus]:
        """Return the sum first, then the items by name."""
        stale = {n for n, (at, _) in self._items.items() if 0 < self._timeout_ns < now_ns - at}
        if self._discards:
            self._items = {name: item for name, item in self._items.items() if name not in stale}
        header = DiagnosticStatus(name=self.path)
        reported = [header]
        for name, (_, status) in sorted(self._items.items()):
            header.values.append(KeyValue(key=name, value=status.message))
            fields = {key: getattr(status, key) for key in ("message", "hardware_id", "values")}
            level = STALE if name in stale else status.level
            path = f"{self.path}/{output_name(name)}"
            reported.append(DiagnosticStatus(name=path, level=level, **fields))
        header.level = worst([s.level for s in reported[1:]] or [OK if self._discards else STALE])
        header.message = word(header.level)
        self._expect_number(header, len(self._items))
        for status in reported:
            for prefix in self._prefixes:
                status.name = without_prefix(status.name, prefix)
        return reported

    def _expect_number(self, header: DiagnosticStatus, there: int) -> None:
        if there == self._count == 0:
            header.level, header.message = OK, "OK"
        elif 0 < self._count != there:
            header.level = max(ERROR, header.level)
            found = f"Expected {self._count}, found {there}"
            header.message = found if there else f"No items found, expected {self._count}"


class DiscardAnalyzer(GenericAnalyzer):
    """Discards the statuses that match."""

    def report(self, now_ns: int) -> list[DiagnosticStatus]:
        """Return no status."""
        return []


class AnalyzerGroup:
    """Passes statuses to all its analyzers that match, and sums their reports up."""

    def __init__(self, path: str, parameters: Parameters) -> None:
        self.path = self.name = path
        self._failed: list[DiagnosticStatus] = []
        self._analyzers: list[GenericAnalyzer | AnalyzerGroup] = []
        for name, own in children(parameters).items():
            self._add(name, own)
        if not self._analyzers and path:
            get_logger("AnalyzerGroup").error("No analyzers initialized in AnalyzerGroup '/'")

    @property
    def complete(self) -> bool:
        """True if it has analyzers and all of them could be created."""
        return bool(self._analyzers) and not self._failed

    def match(self, name: str) -> bool:
        """Return whether one of its analyzers matches a name."""
        return any(analyzer.match(name) for analyzer in self._analyzers)

    def analyze(self, status: DiagnosticStatus, now_ns: int) -> None:
        """Pass a status to all analyzers that match."""
        for analyzer in self._analyzers:
            if analyzer.match(status.name):
                analyzer.analyze(status, now_ns)

    def report(self, now_ns: int) -> list[DiagnosticStatus]:
        """Return the reports of its analyzers, then their sum, except at a root without a path."""
        if not self._analyzers:
            return [DiagnosticStatus(name=self.path or "/AnalyzerGroup", level=ERROR, message="No analyzers")]
        header, levels, reported = DiagnosticStatus(name=self.path), [], list[DiagnosticStatus]()
        for analyzer in self._analyzers:
            for status in analyzer.report(now_ns):
                reported.append(status)
                if status.name == analyzer.path:
                    header.values.append(KeyValue(key=analyzer.name, value=status.message))
                    levels.append(status.level)
        header.level = worst(levels or [OK])
        header.message = word(header.level)
        return [*reported, *([header] if self.path else []), *self._failed]

    def _add(self, name: str, parameters: Parameters) -> None:
        """Create an analyzer; if that fails, it is logged and reported as stale."""
        kind = str(parameters["type"])
        path = f"{self.path}/{parameters['path']}" if kind.endswith("Group") else self.path
        log = get_logger("AnalyzerGroup")
        try:
            analyzer = KINDS[kind](path, parameters)
            if isinstance(analyzer, AnalyzerGroup) and not analyzer.complete:
                raise ValueError("one of its analyzers failed")
            self._analyzers.append(analyzer)
            return
        except KeyError:
            why = "Pluginlib exception loading analyzer"
            log.error(f"Failed to load analyzer {name}, type {kind}.\nhint: there are {', '.join(KINDS)}.")
        except (ValueError, re.error) as error:
            why = "Analyzer init failed"
            log.error(f"{error}\nUnable to initialize analyzer NS: /, type: {kind}")
        self._failed.append(DiagnosticStatus(name=f"{self.path}/{name}", level=STALE, message=why))


KINDS: dict[str, type[GenericAnalyzer | AnalyzerGroup]] = {
    f"diagnostic_aggregator/{kind.__name__}": kind
    for kind in (GenericAnalyzer, DiscardAnalyzer, AnalyzerGroup)
}


def checked(parameters: Parameters, table: _Table) -> dict[str, Any]:
    """Return each parameter of a table, or its default.

    A value of another type is a CourseError; on a robot the node dies of that, with the same first line.
    """
    for name in table.keys() & parameters.keys():
        wanted, found = table[name][0], Parameter.Type.from_parameter_value(parameters[name])
        if found is not wanted:
            example = {"STRING_ARRAY": f"['{parameters[name]}']", "DOUBLE": f"{parameters[name]}.0"}
            raise CourseError(
                f"expected [{wanted.name.lower()}] got [{found.name.lower()}]\n"
                f"hint: {name}: {parameters[name]} in the YAML; write "
                f"{name}: {example.get(wanted.name, table[name][1])}."
            )
    return {name: parameters.get(name, default) for name, (_, default) in table.items()}


def children(parameters: Parameters) -> dict[str, dict[str, Any]]:
    """Group parameters by analyzer; those without a type or a path, and ignored ones, are left out."""
    found: dict[str, dict[str, Any]] = {}
    for name, value in sorted(parameters.items()):
        parts = re.fullmatch(r"((?:analyzers\.)?[^.]+)\.(.+)", name)
        if parts:
            found.setdefault(parts[1], {})[parts[2]] = value
    ignored = (None, "", "diagnostic_aggregator/IgnoreAnalyzer")
    return {name: own for name, own in found.items() if own.get("type") not in ignored and own.get("path")}


def word(level: bytes) -> str:
    """Return the name of a level."""
    return _WORDS.get(level, "Error")


def worst(levels: Sequence[bytes]) -> bytes:
    """Return the worst of levels; stale beside others is an error."""
    level = max(levels)
    return ERROR if level == STALE and set(levels) != {STALE} else level


def output_name(name: str) -> str:
    """Return an item's name below its analyzer's path: slashes become spaces."""
    return name.replace("/", " ")


def without_prefix(name: str, prefix: str) -> str:
    """Remove a prefix from the last part of a path, with the colon and the spaces behind it."""
    begin = name.rfind("/") + 1
    if not prefix:
        return name
    last = name[begin:]
    if name.find(prefix) == begin:  # as in ROS, not if it occurs in the path as well
        last = last.removeprefix(prefix)
    return name[:begin] + last.removeprefix(":").lstrip(" ")
