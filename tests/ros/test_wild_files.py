"""The tables of launch files and layouts from public repositories, and the judgement of one."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.benchmarks.wild_files import files_of, judged_error, judgement
from tests.benchmarks.wild_programs import Row, table
from tests.displays.test_layout import LAYOUT

LAUNCH, LAYOUTS = table("launch"), table("layout")


def test_at_least_85_in_100_launch_files_are_described_or_refused_by_the_name_of_what_is_missing() -> None:
    assert len(LAUNCH) >= 250
    assert len({row.repository for row in LAUNCH}) >= 60
    honest = [row for row in LAUNCH if row.result == "described" or (row.result == "needs" and row.reason)]
    assert len(honest) >= 0.85 * len(LAUNCH)
    assert [row for row in LAUNCH if row.result == "fails" and not (row.theirs and row.reason)] == []


def test_all_layouts_keep_what_is_in_them() -> None:
    assert len(LAYOUTS) >= 60
    assert {row.result for row in LAYOUTS} == {"kept"}


@pytest.fixture
def judged(tmp_path: Path) -> Callable[[str, str], tuple[str, str]]:
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
def test_a_launch_file_is_described_to_its_end_in_a_process_of_its_own(
    judged: Callable[[str, str], tuple[str, str]], action: str, expected: tuple[str, str]
) -> None:
    assert judged("a.launch.py", PYTHON.format(action)) == expected


def test_what_is_wrong_in_an_xml_file_and_in_a_layout_is_the_reason(
    judged: Callable[[str, str], tuple[str, str]],
) -> None:
    include = '<launch><include file="$(find-pkg-share nav2_bringup)/x.launch.py"/></launch>'
    assert judged("a.launch.xml", include) == ("needs", "nav2_bringup")
    assert judged("a.rviz", LAYOUT) == ("kept", "")
    assert judged("a.rviz", "a: [")[0] == "fails"


def test_a_reason_has_no_path_of_this_machine() -> None:
    assert judged_error(ValueError("/clones/a+b/x.py: no"), Path("/clones/a+b")) == (
        "fails", "ValueError: x.py: no")  # fmt: skip
