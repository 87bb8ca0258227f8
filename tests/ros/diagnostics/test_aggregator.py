"""The tree of diagnostic_aggregator, with the rules and names of its C++ sources."""

from pathlib import Path
from typing import Any

import pytest
from diagnostic_aggregator.aggregator_node import Aggregator, strip_prefix
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from course_lib.errors import CourseError

OK, WARN, ERROR, STALE = b"\x00", b"\x01", b"\x02", b"\x03"

ROBOT = """
analyzers:
  ros__parameters:
    path: Robot
    arms: {type: diagnostic_aggregator/GenericAnalyzer, path: Arms, startswith: ['/arms'], timeout: 2.0}
    topology:
      type: diagnostic_aggregator/AnalyzerGroup
      path: Topology
      analyzers:
        left: {type: diagnostic_aggregator/GenericAnalyzer, path: Left, contains: ['/left']}
        right: {type: diagnostic_aggregator/GenericAnalyzer, path: Right, regex: ['.*/right/\\w+']}
    noise: {type: diagnostic_aggregator/DiscardAnalyzer, path: Noise, contains: [noise]}
    todo: {type: diagnostic_aggregator/IgnoreAnalyzer, path: Later, contains: ['/legs']}
"""


class Bench:
    """An aggregator, and a node that publishes to it once a second and receives its tree."""

    def __init__(self, yaml: str, folder: Path) -> None:
        (folder / "analyzers.yaml").write_text(yaml)
        self.aggregator = Aggregator(cli_args=["--ros-args", "--params-file", str(folder / "analyzers.yaml")])
        self.node = Node("robot")
        self._publisher = self.node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.trees: list[dict[str, Any]] = []
        self.top_levels: list[Any] = []
        self.node.create_subscription(DiagnosticArray, "/diagnostics_agg", self._hear, 10)
        self.node.create_subscription(
            DiagnosticStatus, "/diagnostics_toplevel_state", lambda s: self.top_levels.append(s.level), 10
        )
        self.executor = SingleThreadedExecutor()
        for node in (self.aggregator, self.node):
            self.executor.add_node(node)

    def after(self, seconds: int, **levels: bytes) -> dict[str, Any]:
        """Publish levels by name ("__" for a slash). Return the last tree by name."""
        array = DiagnosticArray(header=self._header())
        for name, level in levels.items():
            name = name.replace("__", "/")
            array.status.append(
                DiagnosticStatus(name=name, level=level, message=f"{name} said", hardware_id="h")
            )
        self._publisher.publish(array)
        end_ns = self.node.get_clock().now().nanoseconds + seconds * 10**9
        while (left_ns := end_ns - self.node.get_clock().now().nanoseconds) > 0:
            self.executor.spin_once(timeout_sec=left_ns * 1e-9)
        self.executor.spin_once(timeout_sec=0.002)
        self.executor.spin_once(timeout_sec=0.002)
        return self.trees[-1]

    def _header(self) -> Any:
        return DiagnosticArray().header.__class__(stamp=self.node.get_clock().now().to_msg())

    def _hear(self, array: Any) -> None:
        self.trees.append({status.name: status for status in array.status})


@pytest.fixture
def robot(started_graph: object, tmp_path: Path) -> Bench:
    return Bench(ROBOT, tmp_path)


def levels(tree: dict[str, Any]) -> dict[str, bytes]:
    return {name: status.level for name, status in tree.items()}


def test_statuses_appear_below_every_matching_analyzer(robot: Bench) -> None:
    tree = robot.after(1, __arms__left__motor=OK, __arms__right__motor=WARN, __legs__left__motor=ERROR)
    assert levels(tree) == {
        "/Robot/Arms": WARN,
        "/Robot/Arms/ arms left motor": OK,
        "/Robot/Arms/ arms right motor": WARN,
        "/Robot/Topology/Left": ERROR,
        "/Robot/Topology/Left/ arms left motor": OK,
        "/Robot/Topology/Left/ legs left motor": ERROR,
        "/Robot/Topology/Right": WARN,
        "/Robot/Topology/Right/ arms right motor": WARN,
        "/Robot/Topology": ERROR,
        "/Robot": ERROR,
    }
    assert tree["/Robot/Arms"].message == "Warning"
    assert [(v.key, v.value) for v in tree["/Robot/Arms"].values] == [
        ("/arms/left/motor", "/arms/left/motor said"),
        ("/arms/right/motor", "/arms/right/motor said"),
    ]
    item = tree["/Robot/Arms/ arms left motor"]
    assert (item.message, item.hardware_id) == ("/arms/left/motor said", "h")
    assert [(v.key, v.value) for v in tree["/Robot"].values] == [
        ("Arms", "Warning"),
        ("/Robot/Topology", "Error"),
    ]
    assert robot.top_levels[-1] == ERROR


def test_unmatched_statuses_are_grouped_under_other_and_discarded_ones_are_omitted(robot: Bench) -> None:
    tree = robot.after(1, foo__bar=OK, noise=ERROR)
    assert {name for name in tree if "Other" in name} == {"/Robot/Other", "/Robot/Other/foo bar"}
    assert not any("noise" in name for name in tree)
    assert "/Robot/Other" not in robot.after(6)  # it is removed after five seconds without messages


def test_silent_component_becomes_stale_and_its_group_an_error(robot: Bench) -> None:
    assert levels(robot.after(1, __arms__left__motor=OK, __arms__right__motor=OK))["/Robot/Arms"] == OK
    tree = robot.after(2, __arms__right__motor=OK)
    assert tree["/Robot/Arms/ arms left motor"].level == STALE
    assert (tree["/Robot/Arms"].level, tree["/Robot/Arms"].message) == (ERROR, "Error")
    tree = robot.after(3)
    assert (tree["/Robot/Arms"].level, tree["/Robot/Arms"].message) == (STALE, "Stale")


@pytest.mark.parametrize(
    ("options", "level", "message"),
    [
        ("num_items: 2", ERROR, "Expected 2, found 1"),
        ("num_items: 1", OK, "OK"),
        ("expected: ['arm: b']", ERROR, "Error"),
    ],
)
def test_missing_items_are_an_error(
    started_graph: object, tmp_path: Path, options: str, level: bytes, message: str
) -> None:
    yaml = f"""
/**:
  ros__parameters:
    arms:
      {{type: diagnostic_aggregator/GenericAnalyzer, path: Arms, find_and_remove_prefix: [arm], {options}}}
"""
    tree = Bench(yaml, tmp_path).after(1, **{"arm: a": OK})
    assert (tree["/Arms"].level, tree["/Arms"].message) == (level, message)
    assert tree["/Arms/a"].level == OK
    if "expected" in options:
        assert (tree["/Arms/b"].level, tree["/Arms/b"].message) == (STALE, "Missing")


def test_without_analyzers_all_statuses_are_in_the_group_other_which_is_an_error(
    started_graph: object, tmp_path: Path
) -> None:
    tree = Bench("/**: {ros__parameters: {other_as_errors: true}}", tmp_path).after(1, cam=OK)
    assert tree["/AnalyzerGroup"].message == "No analyzers"
    assert tree["/Other"].message == 'Unanalyzed items found in "Other"'
    assert levels(tree) == {"/AnalyzerGroup": ERROR, "/Other": ERROR, "/Other/cam": OK}


@pytest.mark.parametrize(
    ("settings", "message", "logged"),
    [
        ("type: GenericAnalyzer", "Pluginlib exception loading analyzer", "Failed to load analyzer arms"),
        (
            "type: diagnostic_aggregator/GenericAnalyzer, name: [x]",
            "Analyzer init failed",
            "any way of check",
        ),
        ("type: diagnostic_aggregator/AnalyzerGroup", "Analyzer init failed", "No analyzers initialized"),
    ],
)
def test_invalid_analyzer_is_logged_and_shown(
    started_graph: object,
    tmp_path: Path,
    capfd: pytest.CaptureFixture[str],
    settings: str,
    message: str,
    logged: str,
) -> None:
    bench = Bench(
        f"""
/**:
  ros__parameters:
    arms: {{path: Arms, {settings}}}
    legs: {{path: Legs, type: diagnostic_aggregator/GenericAnalyzer, startswith: [leg]}}
""",
        tmp_path,
    )
    assert logged in capfd.readouterr().err
    status = bench.after(1)["/arms"]
    assert (status.level, status.message) == (STALE, message)


def test_parameter_of_wrong_type_is_rejected_with_the_correct_syntax(
    started_graph: object, tmp_path: Path
) -> None:
    yaml = "analyzers: {ros__parameters: {a: {type: diagnostic_aggregator/GenericAnalyzer, path: A, %s}}}"
    with pytest.raises(
        CourseError, match=r"^expected \[string_array\] got \[string\]\nhint: .*startswith: \['x'\]"
    ):
        Bench(yaml % "startswith: x", tmp_path)
    with pytest.raises(
        CourseError, match=r"^expected \[double\] got \[integer\]\nhint: .*write timeout: 5\.0\."
    ):
        Bench(yaml % "startswith: [x], timeout: 5", tmp_path)


def test_critical_error_is_published_immediately(started_graph: object, tmp_path: Path) -> None:
    bench = Bench("/**: {ros__parameters: {critical: true, pub_rate: 0.9}}", tmp_path)
    bench.after(2, cam=ERROR)
    assert bench.top_levels == [ERROR] * 2  # immediately, and after 1.1 s


def test_missing_stamp_is_warned_about_once(robot: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    publisher = robot.node.create_publisher(DiagnosticArray, "/diagnostics", 10)
    for _ in range(2):
        publisher.publish(DiagnosticArray(status=[DiagnosticStatus(name="a"), DiagnosticStatus(name="b")]))
    robot.after(1)
    text = "No timestamp set for diagnostic message. Message names: a, b"
    assert capfd.readouterr().err.count(text) == 1


@pytest.mark.parametrize(
    ("name", "prefix", "short"),
    [
        ("/PREFIX/base_hokuyo_node: Connection Status", "base_hokuyo_node", "/PREFIX/Connection Status"),
        ("/Base/motor", "", "/Base/motor"),
        ("/Base/motor", "arm", "/Base/motor"),
        ("/arm/arm: x", "arm", "/arm/arm: x"),  # ROS searches for the first occurrence of the prefix
    ],
)
def test_prefix_is_stripped_from_the_last_path_component(name: str, prefix: str, short: str) -> None:
    assert strip_prefix(name, prefix) == short
