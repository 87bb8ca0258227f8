"""Complete layouts of topics that a robot publishes through `course router`."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from course_lib import Viewer
from course_lib.course.exercise import read_notebook
from course_lib.displays.layout import yaml_text
from course_lib.displays.panel.protocol import PublishGesture
from course_lib.displays.panel.tools import publish
from course_lib.ros.graph.graph import use_graph
from course_lib.ros.robot.connect import RobotAddress, link_to
from course_lib.ros.robot.robot_graph import RobotGraph
from tests.gateway import nav2_robot
from tests.gateway.conftest import ROSTER, Opened
from tests.gateway.test_router import Started, course, says, started, users_in
from tests.gateway.test_two_kits import advance_until
from tests.ports import free_port

__all__ = ["started"]
SOLUTION = Path(__file__).parents[2] / "solutions" / "week07_solution.ipynb"
WEEK_7 = """
from course_lib.sensors import Detector, DetectorNode, Thing, World, circle, cylinder, placed
from rclpy.executors import SingleThreadedExecutor

person = Thing(cylinder(0.25, 1.8), placed(2.0, 0.0, 0.9), label="Person")
seen = Detector(World([person]), circle((0.0, 0.0, 1.0), radius=3.0, period=20.0), seed=7)
rclpy.init()
executor = SingleThreadedExecutor()
detector = DetectorNode(seen, frame_id="world", rate=10.0)
for node in (detector, TfPublisher(), PathPlanner(), PerceptionNode(), TrajectoryNode()):
    executor.add_node(node)
node.get_logger().info("The dashboard is ready")
try:
    executor.spin()
except KeyboardInterrupt:
    rclpy.try_shutdown()
"""
DASHBOARD = ("/tf", "/perception/markers", "/planned_path", "/robot_trajectory")
SERVICE = "/perception_node/set_parameters"
OFFERED = tuple(
    f"/perception_node/{name}_parameters" for name in ("set", "get", "list", "describe", "set_atomically")
)
LATCHED = {"Durability Policy": "Transient Local"}
SENSOR = {"Reliability Policy": "Best Effort"}
NAV2: dict[str, tuple[tuple[str, str, dict[str, str]], ...]] = {  # group -> class, topic, QoS
    "": (
        ("LaserScan", "scan", SENSOR),
        ("PointCloud2", "mobile_base/sensors/bumper_pointcloud", SENSOR),
        ("Map", "map", LATCHED),
        ("MarkerArray", "waypoints", {}),
    ),
    "Global Planner": (("Map", "global_costmap/costmap", LATCHED), ("Path", "plan", {})),
    "Controller": (
        ("Map", "local_costmap/costmap", LATCHED),
        ("Path", "local_plan", {}),
        ("Polygon", "local_costmap/published_footprint", {}),
    ),
}
SEEN = [topic.replace("/", " ") for displays in NAV2.values() for _, topic, _ in displays]


class Behind:
    """A robot's programs and a kit of the driver, on both sides of `course router`."""

    def __init__(self, folder: Path, started: Started, opened: Opened) -> None:
        (folder / "roster.csv").write_text(ROSTER)
        self._folder, self._started = folder, started
        self.place, self._there = (f"tcp/127.0.0.1:{free_port()}" for _ in range(2))
        opened(mode="router", **{"listen/endpoints": [self._there]})

    def runs(self, program: str, ready: str, sends: tuple[str, ...], offers: tuple[str, ...] = ()) -> Path:
        """Start a program of the robot; return its output."""
        words = [word for topic in sends for word in ("--send", topic)]
        words += [word for name in offers for word in ("--call", name)]
        log = self._started("run", program, "--robot", self._there, *words)
        says(log, ready)
        return log

    def router(self, *words: str) -> None:
        """Start the gateway, which the first student drives through."""
        options = ("--listen", self.place, "--students", "roster.csv", "--driver", "1234")
        says(self._started("router", "--robot", self._there, *options, *words), "router is linked")

    @property
    def address(self) -> str:
        """The driver's address."""
        return users_in(self._folder)[1].address(self.place)


@pytest.fixture
def behind(tmp_path: Path, started: Started, opened: Opened) -> Behind:
    return Behind(tmp_path, started, opened)


@pytest.fixture
def student() -> Iterator[Callable[..., RobotGraph]]:
    graphs: list[RobotGraph] = []

    def join(address: str, *send: str) -> RobotGraph:
        graphs.append(link_to(RobotAddress(address, send=send)))
        return graphs[-1]

    yield join
    for graph in graphs:
        graph.close()


def dashboard_of_week_7() -> tuple[str, str]:
    """Return the solution's nodes as a program, and the code of its layout."""
    cells = ["".join(cell["source"]) for cell in read_notebook(SOLUTION)["cells"]]
    nodes = [cell for cell in cells if cell.startswith("# export")]
    return "\n".join([*nodes, WEEK_7]), next(cell for cell in cells if "def dashboard_layout" in cell)


def good(viewer: Viewer, name: str) -> bool:
    """Return whether a display has shown a message and complains of nothing."""
    rows = [row for row in viewer.statuses() if row.display == name]
    drawn = any(f"/{name}/" in path for path in viewer.scene.objects())
    return drawn and all(row.level in ("ok", "hint") for row in rows)


@pytest.mark.slow
def test_week_7_dashboard_runs_on_a_robot_with_panels_on_another_kit(
    tmp_path: Path, behind: Behind, student: Callable[..., RobotGraph], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    program, layout = dashboard_of_week_7()
    (tmp_path / "dashboard.py").write_text(program)
    behind.runs("dashboard.py", "The dashboard is ready", DASHBOARD, OFFERED)
    behind.router("--call", SERVICE)
    kit = student(behind.address)
    with use_graph(kit):
        scope: dict[str, Any] = {"Viewer": Viewer, "File": Path}
        exec(layout, scope)
        scope["dashboard_layout"]()
        viewer = Viewer.from_rviz("dashboard.rviz")
    for name in ("TF", "Detections", "Plan", "Trajectory"):
        advance_until(kit, partial(good, viewer, name), f"{name}: {viewer.statuses()}")
    assert any("Detections/labels" in path for path in viewer.scene.objects())
    words = ("param", "set", "/perception_node", "confidence_threshold", "1.0")
    output = course(tmp_path, "ros2", "--robot", behind.address, "--call", SERVICE, *words)
    assert "Set parameter successful" in output
    advance_until(
        kit, lambda: not any("Detections/" in path for path in viewer.scene.objects()), "no detection is left"
    )
    viewer.close()


def nav2_layout() -> str:
    """Return a layout as Nav2's: groups, topics without a slash, displays that the kit lacks, tools."""

    def display(kind: str, topic: str, qos: dict[str, str]) -> dict[str, Any]:
        about = {"Depth": 5, "Value": topic, **qos}
        return {
            "Class": f"rviz_default_plugins/{kind}",
            "Name": topic.replace("/", " "),
            "Enabled": True,
            "Topic": about,
        }

    groups = {name: [display(*one) for one in displays] for name, displays in NAV2.items()}
    camera = {**display("Image", "camera/image_raw", {}), "Enabled": True}
    displays = [
        {"Class": "rviz_default_plugins/TF", "Name": "TF", "Enabled": True},
        *groups.pop(""),
        {"Class": "nav2_rviz_plugins/ParticleCloud", "Name": "Particles", "Enabled": True},
        *({"Class": "rviz_common/Group", "Name": name, "Displays": one} for name, one in groups.items()),
        {"Class": "rviz_common/Group", "Name": "Realsense", "Enabled": False, "Displays": [camera]},
    ]
    tools = [{"Class": "rviz_default_plugins/SetInitialPose", "Topic": {"Value": "initialpose"}},
             {"Class": "nav2_rviz_plugins/GoalTool"}]  # fmt: skip
    manager = {"Displays": displays, "Global Options": {"Fixed Frame": "map"}, "Tools": tools}
    return yaml_text({"Visualization Manager": manager})


@pytest.mark.slow
def test_nav2_layout_shows_latched_maps_of_a_robot_and_sends_poses(
    tmp_path: Path, behind: Behind, student: Callable[..., RobotGraph]
) -> None:
    streams = [topic for _, topic, _ in nav2_robot.STREAMS]
    sends = ("/tf", "/tf_static", *nav2_robot.MAPS, *streams)
    log = behind.runs(str(nav2_robot.__file__), "Nav2 is ready", sends)
    behind.router("--send", "/goal_pose", "--send", "/initialpose")
    (tmp_path / "nav2.rviz").write_text(nav2_layout())
    kit = student(behind.address, "/goal_pose", "/initialpose")
    with use_graph(kit):
        viewer = Viewer.from_rviz(tmp_path / "nav2.rviz")
    for name in ("TF", *SEEN):
        advance_until(kit, partial(good, viewer, name), f"{name}: {viewer.statuses()}")
    heard = {info.topic for info in kit.endpoints() if info.kind == "sub"}
    assert "/camera/image_raw" not in heard  # its group is off
    node = viewer.session.context.node
    assert node is not None
    for tool, said in (("2D Goal Pose", "PoseStamped 1.5"), ("2D Pose Estimate", "CovarianceStamped 1.5")):
        gesture = PublishGesture(tool, (1.5, 0.0, 0.0))

        def arrived(gesture: PublishGesture = gesture, said: str = said) -> bool:
            publish(node, viewer.session.tools, viewer.fixed_frame, gesture)
            return said in log.read_text()

        advance_until(kit, arrived, said)
    viewer.close()
