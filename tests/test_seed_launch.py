"""The launch files of the course's source documents run unmodified; see test_seed_programs.py."""

import os
import re
from pathlib import Path

import pytest

from course_lib.export.export import export
from tests.ros.launch.run import recorded

DOCUMENTS = sorted(Path(os.environ["COURSE_SEEDS"]).glob("*.txt")) if "COURSE_SEEDS" in os.environ else []
DASHBOARD = Path(__file__).parent / "programs" / "dashboard.py"
LAYOUT = """
Visualization Manager:
  Displays:
    - {Class: rviz_default_plugins/Marker, Name: Paint, Topic: <robot_namespace>/visualization_marker}
  Global Options: {Fixed Frame: map}
"""
MAIN = r"__main__':\n    main\(\)\n"

pytestmark = pytest.mark.skipif(not DOCUMENTS, reason="COURSE_SEEDS names no folder with the documents")


def cut(beginning: str, ending: str) -> str:
    """Extract a section from a document, including its end."""
    text = next(t for document in DOCUMENTS if beginning in (t := document.read_text()))
    match = re.search(re.escape(beginning) + ".*?" + ending, text, re.DOTALL)
    assert match is not None
    return match[0]


def test_dashboard_launch_file_starts_the_exported_package(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    start = '#!/usr/bin/env python3\n"""\nLaunch file for Perception Dashboard'
    (tmp_path / "dashboard.launch.py").write_text(cut(start, r"LaunchDescription\(\[.*?\n    \]\)\n"))
    (tmp_path / "robot_params.yaml").write_text(cut("# robot_params.yaml\n", r"arrow_head_diameter: 0\.2\n"))
    (tmp_path / "perception_dashboard.rviz").write_text(LAYOUT)
    names = ("dashboard.launch.py", "robot_params.yaml", "perception_dashboard.rviz")
    export(DASHBOARD, "perception_dashboard", tmp_path, extra=[tmp_path / name for name in names])
    launch = tmp_path / "perception_dashboard" / "launch" / "dashboard.launch.py"
    recording, code = recorded(launch, seconds=2.0)
    counts = {topic.name: topic.count for topic in recording.topics()}
    assert code == 0
    assert (counts["/perception/markers"], counts["/tf"], counts["/scan"]) == (20, 40, 20)
    assert "course view --bag DIR --rviz" in capsys.readouterr().out


@pytest.mark.parametrize(("settings", "topic"), [((), ""), (("use_namespace:=True", "namespace:=a"), "/a")])
def test_painting_launch_file_opens_its_layout_and_starts_the_node(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], settings: tuple[str, ...], topic: str
) -> None:
    bringup = tmp_path / "neo_nav2_bringup"
    for folder in (bringup / "rviz", bringup / "launch"):
        folder.mkdir(parents=True)
    (bringup / "package.xml").write_text('<package format="3"><name>neo_nav2_bringup</name></package>')
    (bringup / "rviz" / "single_robot.rviz").write_text(LAYOUT)
    (bringup / "launch" / "rviz_launch2.py").write_text(cut("# rviz_launch2.py\nimport os", r"return ld\n"))
    node = cut(
        "import rclpy\nfrom rclpy.node import Node\nfrom visualization_msgs.msg import Marker\nfrom geo", MAIN
    )
    (tmp_path / "node.py").write_text(node)
    export(tmp_path / "node.py", "paint_path", tmp_path, nodes=["PaintPathNode"])
    _, code = recorded(bringup / "launch" / "rviz_launch2.py", *settings, seconds=0.2)
    captured = capsys.readouterr()
    assert code == 0
    assert "Transform not available" in captured.err
    layout = Path(captured.out.split("--rviz ")[1].split()[0])
    assert f"Topic: {topic}/visualization_marker" in layout.read_text()
    layout.unlink()
