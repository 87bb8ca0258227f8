"""Every command that a lesson, an exercise, the README or a guide shows can be typed.

Those in text are typed here. Those in code cells are run with their notebooks, by nbmake.
"""

import json
import re
import shlex
import shutil
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from course_lib import cli
from course_lib.course.material import checkout_root, exercises_dir, lessons_dir, solutions_dir
from course_lib.course.student_folder import prepare
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.tools.notebook import run_pipeline
from course_lib.tools.ros2 import ros2
from course_lib.tools.rqt.rqt import rqt
from course_lib.tools.run import run_with_tool
from course_lib.tools.sources import DISCOVERY, GraphSource
from tests.notebooks.commands import Shown, commands_of

HERE = Path(__file__).parent
EXERCISES = sorted(exercises_dir().glob("week*.ipynb"))
GUIDE = checkout_root() / "docs" / "instructor.md"
GUIDES = [GUIDE, *(GUIDE.with_name(f"{name}.md") for name in ("student", "robot", "hub"))]
DOCUMENTS = [checkout_root() / "README.md", *GUIDES, *sorted(lessons_dir().glob("week*.ipynb")), *EXERCISES]
SECONDS = 4.0  # robot time of the run next to a ros2 command [s]

NOT_RUN = {  # command -> why
    "%": "names the character",
    "%ros2": "names the magic",
    "%ros2 …": "names the magic",
    "%rqt": "names the magic",
    "%rqt …": "names the magic",
    "course check": "names the command",
    "course new course": "names the command",
    "course lab": "serves until it is stopped: tests/course/test_lab.py",
    "course lab ~/my_course": "serves until it is stopped: tests/course/test_lab.py",
    "course mark --serve": "serves until it is stopped: tests/grading/marking",
    "course book OUT": "runs every lesson: tests/browser/test_book.py",
    "course mark graded --serve": "serves until it is stopped: tests/grading/marking",
    'course new week09 "Occupancy maps"': "writes a week into the course of this checkout: tests/authoring",
    **dict.fromkeys(
        (
            "course run my_node.py --robot dds/192.168.1.5 --send /cmd_vel",
            "course ros2 --robot dds/192.168.1.5 topic hz /scan",
            "course view --robot dds/192.168.1.5 --rviz nav.rviz",
            "%ros2 connect dds/192.168.1.5 --send /cmd_vel",
            "%ros2 disconnect",
        ),
        "needs a robot: tests/ros/zenoh",
    ),
    **dict.fromkeys(
        (
            "course router --robot dds/192.168.1.5 --send /cmd_vel --students roster.csv",
            "course router --robot dds/192.168.1.5",
            "course router --driver 20231234",
            "course robot",
            "course robot unknown",
            "course robot --dds",
            "course robot --ros",
        ),
        "serves until it is stopped: tests/gateway",
    ),
    "course classroom --clones clones --roster roster.csv --pushes pushes.json --out submissions": (
        "needs repositories: tests/grading/test_classroom.py"
    ),
    "ros2 run my_markers first_marker": "a package that the student writes on the robot",
    "ros2 run rmw_zenoh_cpp rmw_zenohd": "runs on the robot",
    "ros2 trace": "runs on the robot",
}
NAMED = {  # commands that a sentence only mentions: their help is printed
    "course run",
    "course submit",
    "course view",
    "ros2 param",
    "ros2 param get",
    "ros2 param set",
    "ros2 pkg create",
    "ros2 run",
    "ros2 topic delay",
    "ros2 topic echo",
    "ros2 topic hz",
    "course collect",
    "course feedback",
    "course grade",
    "course mark",
    "course router",
    "course verify",  # of all weeks: tests/notebooks/test_answers.py
}
WRITTEN = "my_files/ros2_ws/src/my_dashboard"
FILLED = {  # command with placeholders -> the command with values
    "%ros2 bag record -o folder --topics ...": "%ros2 bag record -o folder --topics /scan",
    "%ros2 launch file.launch.py": "%ros2 launch robot.launch.py",
    f"%ros2 launch {WRITTEN}/launch/my_dashboard.launch.py": "%ros2 launch robot.launch.py",
    "%ros2 param set /node name value": "%ros2 param set /world rate 2.0",
    "ros2 launch patrol.launch.py": "ros2 launch robot.launch.py",
    "%rqt bag": "%rqt bag inspection",
    "ros2 topic echo --once": "ros2 topic echo --once /scan",
}
RECORD = "course run my_node.py --seconds 5 --bag"
FIRST = {  # prerequisites of a document
    "student.md": ["course export my_lesson.ipynb --package my_robot --out src"],
    "week05_configurations.ipynb": [f"{RECORD} my_bag"],
    "week06_tooling.ipynb": [f"{RECORD} inspection"],
    "week07_dashboard.ipynb": [f"{RECORD} my_files/dashboard_bag"],
}
LAYOUT = "Panels: []\nVisualization Manager:\n  Displays: []\n  Global Options:\n    Fixed Frame: world\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A student's folder with the input files of the commands, and an instructor's downloads.

    No command writes into the course of this checkout.
    """
    weeks = sorted(exercises_dir().rglob("week*"))
    folder = tmp_path / "my_course"
    prepare(folder)
    for solution in solutions_dir().glob("week*_solution.ipynb"):
        shutil.copy(solution, folder / solution.name.replace("solution", "exercise"))
    for name in ("my_node.py", "file.py"):
        shutil.copy(HERE / "every_topic.py", folder / name)
    shutil.copy(HERE / "robot.launch.py", folder)
    shutil.copy(folder / "week07_dashboard.ipynb", folder / "my_lesson.ipynb")
    for name in ("layout", "patrol", "my_files/patrol", "my_files/dashboard"):
        (folder / f"{name}.rviz").write_text(LAYOUT)
    _write_package(folder / "src" / "my_package")
    params = "/**:\n  ros__parameters:\n    world_frame: world\n"
    (folder / "my_files" / "robot_params.yaml").write_text(params)
    (folder / "ur10.urdf").write_text('<robot name="ur10"><link name="base_link"/></robot>')
    with zipfile.ZipFile(folder / "moodle.zip", "w") as archive:
        handed_in = (folder / "week01_exercise.ipynb").read_bytes()
        archive.writestr("Ada_101_assignsubmission_file_/week01_exercise.ipynb", handed_in)
    (folder / "worksheet.csv").write_text("Identifier,Full name,ID number,Grade\nParticipant 101,Ada,ada,\n")
    (folder / "roster.csv").write_text("id,name,email\nada,Ada,ada@x.org\n")
    monkeypatch.chdir(folder)
    monkeypatch.setenv("PYTHONHASHSEED", "0")  # otherwise `course run` starts this process again
    monkeypatch.setenv("COURSE_PACE", "fast")
    monkeypatch.setenv("ROS_PACKAGE_PATH", "my_files/ros2_ws/src")  # the folder for cd ~/ros2_ws in week 7
    yield folder
    assert sorted(exercises_dir().rglob("week*")) == weeks


def _write_package(folder: Path) -> None:
    """Write a package with one executable, my_node."""
    (folder / "my_package").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>my_package</name></package>")
    (folder / "setup.py").write_text("entry_points = {'console_scripts': ['my_node = my_package.node:main']}")
    (folder / "my_package" / "__init__.py").touch()
    (folder / "my_package" / "node.py").write_text("import rclpy\n\n\ndef main():\n    rclpy.init()\n")


@pytest.fixture
def type_in(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Type a command, in this process; a page that would be served is only made, a release not verified."""
    monkeypatch.setattr("webbrowser.open", lambda _: True)
    monkeypatch.setattr("course_lib.displays.render._serve", _serve_nothing)
    monkeypatch.setattr("course_lib.authoring.verify.reject_broken", lambda *_: None)  # takes minutes

    def type_in(text: str) -> None:
        if text.startswith("course "):
            _run_course(text, monkeypatch)
        elif text.startswith("%rqt"):
            _run_rqt(text)
        else:
            _run_ros2(re.sub(r"^%?(timeout \S+ )?", "", text))

    return type_in


async def _serve_nothing(*_: object) -> None:
    return


def _run_course(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", shlex.split(text))
    with pytest.raises(SystemExit) as left:
        cli.main()
    assert left.value.code == 0, text


def _run_ros2(text: str) -> None:
    def tool(graph: Graph) -> None:
        source = GraphSource(graph, discovery=DISCOVERY)
        run_pipeline(
            text.removeprefix("ros2 "), lambda words, write: ros2(words, source, write), sys.stdout.write
        )

    assert run_with_tool([Path("my_node.py")], tool, seconds=SECONDS) == 0, text


def _run_rqt(text: str) -> None:
    with use_graph(Graph(notebook=True)):
        rqt(text.split()[1:])


def ready(shown: Shown) -> str | None:
    """Return the command line for a command, or None if it is not run."""
    words = shown.text.split()
    # The real rclpy is installed in few places: tests/real runs these commands there.
    if shown.text in NOT_RUN or "--ros" in words or words[:2] == ["course", "ros"]:
        return None
    return f"{shown.text} --help" if shown.text in NAMED else FILLED.get(shown.text, shown.text)


@pytest.mark.slow
@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.stem)
def test_every_command_in_the_documents_runs(document: Path, type_in: Callable[[str], None]) -> None:
    for text in FIRST.get(document.name, ()):
        type_in(text)
    for shown in commands_of(document):
        typed = None if shown.in_cell else ready(shown)
        if typed is not None:
            type_in(typed)


def test_every_table_entry_matches_a_documented_command() -> None:
    shown = {one.text for document in DOCUMENTS for one in commands_of(document)}
    assert {*NOT_RUN, *NAMED, *FILLED} <= shown


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda path: path.stem)
def test_every_command_of_an_exercise_is_run_by_its_solution(exercise: Path) -> None:
    solution = solutions_dir() / exercise.name.replace("exercise", "solution")
    in_cells = [{one.text for one in commands_of(path) if one.in_cell} for path in (exercise, solution)]
    assert in_cells[0] <= in_cells[1]


def test_commands_are_found_in_code_blocks_inline_code_and_cells(tmp_path: Path) -> None:
    text = (
        "Type `course check a.ipynb`, not `check`.\n```\npip install x && course lab  # now\n"
        'ros2 topic pub --once /a std_msgs/msg/String "{data:\n b}"\n```\n```python\ncourse = 1\n```\n'
    )
    (tmp_path / "a.md").write_text(text)
    assert [one.text for one in commands_of(tmp_path / "a.md")] == [
        "course lab",
        'ros2 topic pub --once /a std_msgs/msg/String "{data: b}"',
        "course check a.ipynb",
    ]
    cells = [{"cell_type": "code", "source": "if True:\n    %timeout 2 ros2 topic hz /a\n!ls\nx = 5 %2"}]
    (tmp_path / "a.ipynb").write_text(json.dumps({"nbformat": 4, "cells": cells}))
    assert [one.text for one in commands_of(tmp_path / "a.ipynb")] == ["%timeout 2 ros2 topic hz /a", "!ls"]
