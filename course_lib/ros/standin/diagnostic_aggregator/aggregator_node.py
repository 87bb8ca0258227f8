"""The node `ros2 run diagnostic_aggregator aggregator_node`, which aggregates /diagnostics into a tree."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, Unpack

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.logging import get_logger
from rclpy.node import Node, NodeOptions
from rclpy.parameter import Parameter

from course_lib.errors import CourseError

OK, ERROR, STALE = DiagnosticStatus.OK, DiagnosticStatus.ERROR, DiagnosticStatus.STALE
_WORDS = {OK: "OK", DiagnosticStatus.WARN: "Warning", ERROR: "Error", STALE: "Stale"}
Parameters = Mapping[str, Any]
# Type and default value, by parameter name.
_Table = Mapping[str, tuple[Parameter.Type, Any]]

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
    """Keeps the last status of each name that matches.

    A status without recent updates becomes stale. `path` is the path of its parent, `parameters` is
    its configuration. Raises a ValueError if no name could match.
    """

    def __init__(self, path: str, parameters: Parameters) -> None:
        settings = validate_parameters(parameters, GENERIC)
        self.name = settings["path"]
        self.path = f"{path}/{self.name}"
        prefixes = settings["find_and_remove_prefix"]
        self._starts = tuple(settings["startswith"] or prefixes)
        self._contains = settings["contains"]
        self._patterns = [re.compile(pattern) for pattern in settings["regex"]]
        self._prefixes = [prefix.replace("/", " ") for prefix in settings["remove_prefix"] or prefixes]
        self._timeout_ns = round(settings["timeout"] * 1e9)
        self._count = settings["num_items"]
        self._discards = settings["discard_stale"]
        missing = [
            DiagnosticStatus(name=name, level=STALE, message="Missing") for name in settings["expected"]
        ]
        # (time of arrival [ns], status) by name.
        self._items = {status.name: (0, status) for status in missing}
        if not (self._starts or self._contains or self._patterns):
            raise ValueError(
                f"GenericAnalyzer '{self.name}' was not initialized with any way of checking "
                f"diagnostics.Name: {path}, namespace: /\n"
                "hint: give it startswith, contains or regex; in Jazzy name and expected match nothing."
            )

    def match(self, name: str) -> bool:
        """Return whether a name matches one of the analyzer's prefixes, substrings or patterns."""
        return (
            name.startswith(self._starts)
            or any(part in name for part in self._contains)
            or any(pattern.fullmatch(name) for pattern in self._patterns)
        )

    def analyze(self, status: DiagnosticStatus, now_ns: int) -> None:
        """Store a status."""
        self._items[status.name] = now_ns, status

    def report(self, now_ns: int) -> list[DiagnosticStatus]:
        """Return the summary first, then the items by name."""
        stale = {n for n, (at, _) in self._items.items() if 0 < self._timeout_ns < now_ns - at}
        if self._discards:
            self._items = {name: item for name, item in self._items.items() if name not in stale}
        header = DiagnosticStatus(name=self.path)
        reported = [header]
        for name, (_, status) in sorted(self._items.items()):
            header.values.append(KeyValue(key=name, value=status.message))
            fields = {key: getattr(status, key) for key in ("message", "hardware_id", "values")}
            level = STALE if name in stale else status.level
            # Below the path of its analyzer, an item has spaces instead of slashes.
            path = f"{self.path}/{name.replace('/', ' ')}"
            reported.append(DiagnosticStatus(name=path, level=level, **fields))
        header.level = worst_level([s.level for s in reported[1:]] or [OK if self._discards else STALE])
        header.message = level_name(header.level)
        there = len(self._items)
        if there == self._count == 0:
            header.level, header.message = OK, "OK"
        elif 0 < self._count != there:
            header.level = max(ERROR, header.level)
            count_text = f"Expected {self._count}, found {there}"
            header.message = count_text if there else f"No items found, expected {self._count}"
        for status in reported:
            for prefix in self._prefixes:
                status.name = strip_prefix(status.name, prefix)
        return reported


class DiscardAnalyzer(GenericAnalyzer):
    """Discards all matching statuses."""

    def report(self, now_ns: int) -> list[DiagnosticStatus]:
        """Return no statuses."""
        return []


class AnalyzerGroup:
    """Passes statuses to its matching analyzers and summarises their reports."""

    def __init__(self, path: str, parameters: Parameters) -> None:
        self.path = self.name = path
        self._failed: list[DiagnosticStatus] = []
        self._analyzers: list[GenericAnalyzer | AnalyzerGroup] = []
        for name, analyzer_parameters in children(parameters).items():
            self._add(name, analyzer_parameters)
        if not self._analyzers and path:
            get_logger("AnalyzerGroup").error("No analyzers initialized in AnalyzerGroup '/'")

    @property
    def complete(self) -> bool:
        """True if the group has analyzers and all of them could be created."""
        return bool(self._analyzers) and not self._failed

    def match(self, name: str) -> bool:
        """Return whether an analyzer of the group matches a name."""
        return any(analyzer.match(name) for analyzer in self._analyzers)

    def analyze(self, status: DiagnosticStatus, now_ns: int) -> None:
        """Pass a status to all matching analyzers."""
        for analyzer in self._analyzers:
            if analyzer.match(status.name):
                analyzer.analyze(status, now_ns)

    def report(self, now_ns: int) -> list[DiagnosticStatus]:
        """Return the reports of the analyzers and their summary.

        A root without a path has no summary.
        """
        if not self._analyzers:
            return [DiagnosticStatus(name=self.path or "/AnalyzerGroup", level=ERROR, message="No analyzers")]
        header, levels, reported = DiagnosticStatus(name=self.path), [], list[DiagnosticStatus]()
        for analyzer in self._analyzers:
            for status in analyzer.report(now_ns):
                reported.append(status)
                if status.name == analyzer.path:
                    header.values.append(KeyValue(key=analyzer.name, value=status.message))
                    levels.append(status.level)
        header.level = worst_level(levels or [OK])
        header.message = level_name(header.level)
        return [*reported, *([header] if self.path else []), *self._failed]

    def _add(self, name: str, parameters: Parameters) -> None:
        """Create an analyzer. A failure is logged and reported as a stale status."""
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


def validate_parameters(parameters: Parameters, table: _Table) -> dict[str, Any]:
    """Return the values of a table's parameters, or their defaults.

    A value of another type raises a CourseError. On a robot the node exits with the same first
    line.
    """
    for name in table.keys() & parameters.keys():
        expected_type, actual_type = table[name][0], Parameter.Type.from_parameter_value(parameters[name])
        if actual_type is not expected_type:
            example = {"STRING_ARRAY": f"['{parameters[name]}']", "DOUBLE": f"{parameters[name]}.0"}
            raise CourseError(
                f"expected [{expected_type.name.lower()}] got [{actual_type.name.lower()}]\n"
                f"hint: {name}: {parameters[name]} in the YAML; write "
                f"{name}: {example.get(expected_type.name, table[name][1])}."
            )
    return {name: parameters.get(name, default) for name, (_, default) in table.items()}


def children(parameters: Parameters) -> dict[str, dict[str, Any]]:
    """Group parameters by analyzer.

    Ignored analyzers, and analyzers without a type or path, are left out.
    """
    parameters_by_child: dict[str, dict[str, Any]] = {}
    for name, value in sorted(parameters.items()):
        parts = re.fullmatch(r"((?:analyzers\.)?[^.]+)\.(.+)", name)
        if parts:
            parameters_by_child.setdefault(parts[1], {})[parts[2]] = value
    ignored = (None, "", "diagnostic_aggregator/IgnoreAnalyzer")
    return {
        name: child_parameters
        for name, child_parameters in parameters_by_child.items()
        if child_parameters.get("type") not in ignored and child_parameters.get("path")
    }


def level_name(level: bytes) -> str:
    """Return the name of a level."""
    return _WORDS.get(level, "Error")


def worst_level(levels: Sequence[bytes]) -> bytes:
    """Return the worst level. Stale together with other levels is an error."""
    level = max(levels)
    return ERROR if level == STALE and set(levels) != {STALE} else level


def strip_prefix(name: str, prefix: str) -> str:
    """Remove a prefix, and a following colon and spaces, from the last part of a path."""
    begin = name.rfind("/") + 1
    if not prefix:
        return name
    last = name[begin:]
    # As in ROS, the prefix stays if it also occurs earlier in the path.
    if name.find(prefix) == begin:
        last = last.removeprefix(prefix)
    return name[:begin] + last.removeprefix(":").lstrip(" ")


class Aggregator(Node):
    """Publishes /diagnostics_agg and /diagnostics_toplevel_state.

    Its configuration is in the parameters below `analyzers:`.
    """

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        options["automatically_declare_parameters_from_overrides"] = True
        super().__init__("analyzers", **options)
        parameters = {name: p.value for name, p in self.get_parameters_by_prefix("").items()}
        settings = validate_parameters(parameters, AGGREGATOR)
        path = f"/{settings['path']}" if settings["path"] else ""
        self._group = AnalyzerGroup(path, parameters)
        self._other = GenericAnalyzer(path, {"path": "Other", "discard_stale": True, "startswith": [""]})
        self._other_as_errors, self._critical = settings["other_as_errors"], settings["critical"]
        self._top_level, self._warned = STALE, set[str]()
        depth = settings["history_depth"]
        self.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, depth)
        self._tree = self.create_publisher(DiagnosticArray, "/diagnostics_agg", 1)
        self._top = self.create_publisher(DiagnosticStatus, "/diagnostics_toplevel_state", 1)
        self.create_timer(1 / settings["pub_rate"], self._publish)

    def _on_diagnostics(self, array: Any) -> None:
        names = ", ".join(status.name for status in array.status)
        if array.header.stamp.sec == 0 and names not in self._warned:
            self._warned.add(names)
            self.get_logger().warn(f"No timestamp set for diagnostic message. Message names: {names}")
        now_ns = self.get_clock().now().nanoseconds
        for status in array.status:
            if self._critical and status.level == ERROR != self._top_level:
                self._publish_top("toplevel_state_critical", ERROR)
            is_matched = self._group.match(status.name)
            (self._group if is_matched else self._other).analyze(status, now_ns)

    def _publish(self) -> None:
        now = self.get_clock().now()
        other_statuses = self._other.report(now.nanoseconds)
        if self._other_as_errors:
            other_statuses[0].level, other_statuses[0].message = ERROR, 'Unanalyzed items found in "Other"'
        statuses = self._group.report(now.nanoseconds) + (other_statuses if len(other_statuses) > 1 else [])
        tree = DiagnosticArray(status=statuses)
        tree.header.stamp = now.to_msg()
        self._tree.publish(tree)
        self._publish_top("toplevel_state", worst_level([status.level for status in statuses] or [ERROR]))

    def _publish_top(self, name: str, level: bytes) -> None:
        self._top_level = level
        self._top.publish(DiagnosticStatus(name=name, level=level))
