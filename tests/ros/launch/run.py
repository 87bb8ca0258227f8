"""Runs files for tests as `course run` does."""

from pathlib import Path

from course_lib.recording import Recording, record
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.programs.program import run_files
from course_lib.tools.ros2 import EXECUTABLES

MANIFEST = """<package format="3">
  <name>my_robot</name>
  <version>0.1.0</version>
  <description>A robot.</description>
  <maintainer email="ada@example.com">Ada</maintainer>
  <license>MIT</license>
  <depend>rclpy</depend>
  <export><build_type>ament_python</build_type></export>
</package>
"""
SETUP_CFG = "[develop]\nscript_dir=$base/lib/my_robot\n[install]\ninstall_scripts=$base/lib/my_robot\n"


def recorded(
    file: Path, *args: str, seconds: float | None = 1.0, is_strict: bool = False
) -> tuple[Recording, int]:
    """Run a file for some robot time [s] or to its end. Return the recording and the exit code."""
    graph = Graph()
    graph.end_ns = None if seconds is None else graph.now_ns + round(seconds * 1e9)
    with use_graph(graph), record(graph) as recorder:
        code = run_files([file], seed=0, args=args, kit_executables=EXECUTABLES, is_strict=is_strict)
    return recorder.recording(), code
