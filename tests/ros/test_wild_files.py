"""The tables of launch files and layouts from public repositories, and the judgement of one."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.benchmarks.wild_files import files_of, judged_error, judgement, started
from tests.benchmarks.wild_programs import Row, table
from tests.displays.test_layout import LAYOUT
from tests.patience import PATIENCE

LAUNCH, LAYOUTS = table("launch"), table("layout")


def test_at_least_85_percent_of_launch_files_load_or_report_missing_packages() -> None:
    assert len(LAUNCH) >= 250
    assert len({row.repository for row in LAUNCH}) >= 60
    honest = [row for row in LAUNCH if row.result == "described" or (row.result == "needs" and row.reason)]
    assert len(honest) >= 0.85 * len(LAUNCH)
    assert [row for row in LAUNCH if row.result == "fails" and not (row.theirs and row.reason)] == []


def test_all_public_layouts_survive_a_round_trip() -> None:
    assert len(LAYOUTS) >= 60
    assert {row.result for row in LAYOUTS} == {"kept"}


@pytest.fixture
def judge_text(tmp_path: Path) -> Callable[[str, str], tuple[str, str]]:
    """Judge the text of a file in a clone."""

    def judge(name: str, text: str) -> tuple[str, str]:
        (tmp_path / name).write_text(text, encoding="utf-8")
        what = "layout" if name.endswith(".rviz") else "launch"
        assert tmp_path / name in files_of(tmp_path, what)
        return judgement(tmp_path, Row("a/b", "1", name), what)

    return judge


PYTHON = """
import os
from launch import LaunchDescription
from launch.actions import *
from launch_ros.actions import Node
def generate_launch_description():
    return LaunchDescription([{}])
"""


@pytest.mark.parametrize(
    ("action", "expected"),
    [
        ("DeclareLaunchArgument('needed'), Node(package='nowhere', executable='x')", ("described", "")),
        ("TimerAction(period=1.0, actions=[ExecuteProcess(cmd=['gazebo', 'x'])])", ("needs", "gazebo")),
        ("__import__('no_such')", ("needs", "no_such")),
        ("open(__file__ + '.txt')", ("fails", "a file is missing")),
        ("1 / 0", ("fails", "ZeroDivisionError: division by zero")),
        ("os._exit(3)", ("fails", "its process died")),
    ],
)
def test_launch_file_is_described_completely_in_a_separate_process(
    judge_text: Callable[[str, str], tuple[str, str]], action: str, expected: tuple[str, str]
) -> None:
    assert judge_text("a.launch.py", PYTHON.format(action)) == expected


@pytest.mark.slow
def test_error_in_an_xml_launch_file_or_layout_is_its_reported_reason(
    judge_text: Callable[[str, str], tuple[str, str]],
) -> None:
    include = '<launch><include file="$(find-pkg-share nav2_bringup)/x.launch.py"/></launch>'
    assert judge_text("a.launch.xml", include) == ("needs", "nav2_bringup")
    assert judge_text("a.rviz", LAYOUT) == ("kept", "")
    assert judge_text("a.rviz", "a: [")[0] == "fails"


def test_reason_contains_no_local_path() -> None:
    assert judged_error(ValueError("/clones/a+b/x.py: no"), Path("/clones/a+b")) == (
        "fails", "ValueError: x.py: no")  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("action", "result"),
    [
        ("Node(package='demo_nodes_py', executable='talker')", "starts"),
        (
            "Node(package='demo_nodes_py', executable='talker'), Node(package='joy', executable='joy_node')",
            "starts in part",
        ),
        ("Node(package='joy', executable='joy_node')", "needs"),
        ("DeclareLaunchArgument('robot_ip')", "needs"),
        ("1 / 0", "fails"),
    ],
)
def test_launch_results_distinguish_full_partial_and_failed_starts(
    action: str, result: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tests.benchmarks.wild_files.LIMIT", PATIENCE)
    (tmp_path / "a.launch.py").write_text(PYTHON.format(action))
    assert started(tmp_path, Row("a/b", "1", "a.launch.py"))[0] == result
