"""The programs of the course's source documents run unmodified, at their rates, twice alike.

They are read out of the folder that COURSE_SEEDS names; nothing of them is kept here.
"""

import os
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from course_lib.recording import Recording, read_bag
from course_lib.ros.graph.graph import START_NS
from tests.programs import painting_robot
from tests.warm import run_course

SECONDS = 5.0  # [s] of robot time
DOCUMENTS = (
    sorted(Path(os.environ.get("COURSE_SEEDS", "")).glob("*.txt")) if "COURSE_SEEDS" in os.environ else []
)

# class -> topic, messages per second, messages per timer call
PROGRAMS = {
    "SimpleMarkerNode": ("/visualization_marker", 1.0, 1),
    "RobotStatePublisher": ("/joint_states", 50.0, 1),
    "PerceptionVisualizer": ("/detections", 2.0, 1),
    "TFPublisher": ("/tf", 100.0, 2),
}

# One document lost its programs' indentation: the depth of each line, in steps of four
DIAGNOSTIC_NODE = "PhysicalAIDiagnosticNode"
DEPTHS = "00000000112222223222222221222333333322122222223232222223323323323333222011121212201"
CAMERA = """
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Image

rclpy.init()
node = Node("front_cam")
publisher = node.create_publisher(Image, "/front_cam/image_raw", 10)
node.create_timer(1 / {rate}, lambda: publisher.publish(Image()))
rclpy.spin(node)
"""

ROBOT = Path(painting_robot.__file__)

pytestmark = pytest.mark.skipif(not DOCUMENTS, reason="COURSE_SEEDS names no folder with the documents")


def program(name: str) -> str:
    """Cut out the program with a node: from the #! line or the first import before it to its last line."""
    text = next(t for document in DOCUMENTS if f"class {name}(Node)" in (t := document.read_text()))
    before, after = text.rsplit(f"class {name}(Node)", 1)
    ending = re.search(r"if __name__ == '__main__':\n *main\(\)\n", after)
    assert ending is not None
    start = before.rindex("#!" if "#!" in before else "import rclpy\n")
    return before[start:] + f"class {name}(Node)" + after[: ending.end()]


def run(bag: Path, *files: Path, seconds: float = SECONDS) -> Recording:
    process = run_course("run", *files, "--seconds", f"{seconds}", "--bag", bag)
    # Programs that call rclpy.shutdown() after Ctrl+C end with this error on the real rclpy as
    # well.
    assert process.returncode == 0 or "rcl_shutdown already called" in process.stderr, process.stderr
    return read_bag(bag)


@pytest.mark.slow
@pytest.mark.sample(2)
@pytest.mark.parametrize("name", PROGRAMS)
def test_documented_program_keeps_its_rate_and_records_reproducible_bags(tmp_path: Path, name: str) -> None:
    topic, rate, at_once = PROGRAMS[name]
    (tmp_path / "program.py").write_text(program(name))
    recording, again = (run(tmp_path / bag, tmp_path / "program.py") for bag in ("one", "two"))
    stamps = [stamp_ns for stamp_ns, _ in recording.messages(topic)]
    assert len(stamps) == SECONDS * rate * at_once
    calls = sorted(set(stamps))
    assert {later - earlier for earlier, later in pairwise(calls)} == {round(1e9 / rate)}
    assert recording.digest() == again.digest()
    assert (tmp_path / "one/recording.mcap").read_bytes() == (tmp_path / "two/recording.mcap").read_bytes()


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("rate", "level", "message"),
    [
        (30, b"\x00", "Operating normally: avg 29.8Hz"),
        (5, b"\x02", "Low frame rate: avg 4.8Hz"),
        (15, b"\x01", "Frame rate above normal: avg 14.8Hz"),  # it is below: the document errs
    ],
)
def test_documented_diagnostic_node_runs_with_restored_indentation(
    tmp_path: Path, rate: int, level: bytes, message: str
) -> None:
    lines = program(DIAGNOSTIC_NODE).splitlines()
    restored = [" " * 4 * int(depth) + line for depth, line in zip(DEPTHS, lines, strict=True)]
    (tmp_path / "monitor.py").write_text("\n".join(restored))
    (tmp_path / "camera.py").write_text(CAMERA.format(rate=rate))
    recording = run(tmp_path / "bag", tmp_path / "monitor.py", tmp_path / "camera.py")
    arrays: list[Any] = [message for _, message in recording.messages("/diagnostics")]
    assert len(arrays) == SECONDS
    (status,) = arrays[-1].status
    assert (status.name, status.level, status.message) == ("Front Camera System", level, message)


@pytest.mark.slow
def test_documented_dashboard_keeps_all_its_rates(tmp_path: Path) -> None:
    (tmp_path / "dashboard.py").write_text(program("PerceptionDashboard"))
    recording, again = (run(tmp_path / bag, tmp_path / "dashboard.py") for bag in ("one", "two"))
    counts = {topic.name: topic.count for topic in recording.topics()}
    assert (counts["/perception/markers"], counts["/tf"], counts["/planned_path"]) == (50, 100, 5)
    paths: list[Any] = [path for _, path in recording.messages("/planned_path")]
    assert {(path.header.frame_id, len(path.poses)) for path in paths} == {("world", 50)}
    assert recording.digest() == again.digest()


@pytest.mark.slow
def test_documented_paint_node_paints_two_stripes_and_nothing_while_driving(tmp_path: Path) -> None:
    (tmp_path / "paint.py").write_text(program("PaintPathNode"))
    recording = run(tmp_path / "bag", tmp_path / "paint.py", ROBOT, seconds=12.0)
    markers: list[tuple[float, Any]] = [
        ((stamp_ns - START_NS) / 1e9, marker)
        for stamp_ns, marker in recording.messages("/visualization_marker")
    ]
    points = {marker.id: len(marker.points) for _, marker in markers}
    assert len(points) == 2
    assert min(points.values()) >= 8
    assert not [seconds for seconds, _ in markers if painting_robot.DRIVE <= seconds < painting_robot.SECOND]
