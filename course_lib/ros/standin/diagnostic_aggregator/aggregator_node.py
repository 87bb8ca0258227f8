"""The node `ros2 run diagnostic_aggregator aggregator_node`: /diagnostics in, a tree of them out."""

from typing import Any, Unpack

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node, NodeOptions

from diagnostic_aggregator.analyzers import (
    AGGREGATOR,
    ERROR,
    STALE,
    AnalyzerGroup,
    GenericAnalyzer,
    checked,
    worst,
)


class Aggregator(Node):
    """Publishes /diagnostics_agg and /diagnostics_toplevel_state; its YAML stands below `analyzers:`."""

    def __init__(self, **options: Unpack[NodeOptions]) -> None:
        options["automatically_declare_parameters_from_overrides"] = True
        super().__init__("analyzers", **options)
        parameters = {name: one.value for name, one in self.get_parameters_by_prefix("").items()}
        given = checked(parameters, AGGREGATOR)
        path = f"/{given['path']}" if given["path"] else ""
        self._group = AnalyzerGroup(path, parameters)
        self._other = GenericAnalyzer(path, {"path": "Other", "discard_stale": True, "startswith": [""]})
        self._other_as_errors, self._critical = given["other_as_errors"], given["critical"]
        self._top_level, self._warned = STALE, set[str]()
        depth = given["history_depth"]
        self.create_subscription(DiagnosticArray, "/diagnostics", self._hear, depth)
        self._tree = self.create_publisher(DiagnosticArray, "/diagnostics_agg", 1)
        self._top = self.create_publisher(DiagnosticStatus, "/diagnostics_toplevel_state", 1)
        self.create_timer(1 / given["pub_rate"], self._publish)

    def _hear(self, array: Any) -> None:
        names = ", ".join(status.name for status in array.status)
        if array.header.stamp.sec == 0 and names not in self._warned:
            self._warned.add(names)
            self.get_logger().warn(f"No timestamp set for diagnostic message. Message names: {names}")
        now_ns = self.get_clock().now().nanoseconds
        for status in array.status:
            if self._critical and status.level == ERROR != self._top_level:
                self._publish_top("toplevel_state_critical", ERROR)
            wanted = self._group.match(status.name)
            (self._group if wanted else self._other).analyze(status, now_ns)

    def _publish(self) -> None:
        now = self.get_clock().now()
        others = self._other.report(now.nanoseconds)
        if self._other_as_errors:
            others[0].level, others[0].message = ERROR, 'Unanalyzed items found in "Other"'
        statuses = self._group.report(now.nanoseconds) + (others if len(others) > 1 else [])
        tree = DiagnosticArray(status=statuses)
        tree.header.stamp = now.to_msg()
        self._tree.publish(tree)
        self._publish_top("toplevel_state", worst([status.level for status in statuses] or [ERROR]))

    def _publish_top(self, name: str, level: bytes) -> None:
        self._top_level = level
        self._top.publish(DiagnosticStatus(name=name, level=level))
