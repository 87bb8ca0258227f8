"""Programs of a package in its sources, started by the package's folder, and files that lie in one."""

from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph, use_graph
from course_lib.ros.hints import hint
from course_lib.ros.not_offered import not_offered
from course_lib.ros.packages import why_not_found
from course_lib.ros.program import run_files
from course_lib.tools.run import ros2_over

SCRIPTS = '["talker = my_robot.talker:main", "fail = my_robot.talker:fail"]'
SETUP = f'setup(entry_points={{"console_scripts": {SCRIPTS}}})'
TALKER = """
import sys
from arm_msgs.msg import Angle
from my_robot.helpers import name
from far_msgs import UNIT
from far_msgs.msg import Distance
from other_robot.units import DEGREES

def main():
    print(name(), DEGREES, Angle(degrees=2.0).degrees, Distance(meters=3.0).meters, UNIT, sys.argv[1:])

def fail():
    return 3
"""
SCRIPT = """
from my_robot.helpers import name
if __name__ == "__main__":
    print("script of", name())
"""
CMAKE = (
    "install(PROGRAMS\n  scripts/hello.py # python\n  scripts/missing.py\n  DESTINATION lib/${PROJECT_NAME})"
)
PACKAGES = ("my_robot", "other_robot", "arm_msgs", "tools/far_msgs")
FILES = {
    "my_robot/setup.py": SETUP,
    "my_robot/CMakeLists.txt": CMAKE,
    "my_robot/scripts/hello.py": SCRIPT,
    "my_robot/my_robot/__init__.py": "",
    "my_robot/my_robot/helpers.py": "def name():\n    return 'my robot'\n",
    "my_robot/my_robot/relative.py": "from .helpers import name\nprint('relative to', name())\n",
    "my_robot/my_robot/talker.py": TALKER + "\nif __name__ == '__main__':\n    main()\n",
    "other_robot/other_robot/__init__.py": "",
    "other_robot/other_robot/units.py": "DEGREES = 57\n",
    "arm_msgs/msg/Angle.msg": "float64 degrees\n",
    "tools/far_msgs/msg/Distance.msg": "float64 meters\n",
    "tools/far_msgs/far_msgs/__init__.py": "UNIT = 'm'\n",
}


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """Sources as in a workspace: a package of Python, another one, and one with messages."""
    for name, text in FILES.items():
        file = tmp_path / "src" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    for folder in (tmp_path / "src" / name for name in PACKAGES):
        (folder / "package.xml").write_text(f"<package><name>{folder.name}</name></package>")
    return tmp_path / "src"


def shown(program: Path, capsys: pytest.CaptureFixture[str], *args: str) -> tuple[int, str]:
    with use_graph(Graph(end_ns=START_NS + 10**9)):
        code = run_files([program], seed=0, args=args)
    captured = capsys.readouterr()
    return code, captured.out + captured.err


@pytest.mark.parametrize(
    ("program", "code", "text"),
    [
        ("my_robot:talker", 0, "my robot 57 2.0 3.0 m ['word']\n"),
        ("my_robot:hello.py", 0, "script of my robot\n"),
        ("my_robot:fail", 3, "[ros2run]: Process exited with failure 3\n"),
        ("my_robot/my_robot/talker.py", 0, "my robot 57 2.0 3.0 m ['word']\n"),
        ("my_robot/scripts/hello.py", 0, "script of my robot\n"),
        ("my_robot/my_robot/relative.py", 0, "relative to my robot\n"),
    ],
)
def test_a_program_of_a_package_finds_the_workspace_that_it_lies_in(
    program: str, code: int, text: str, workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert shown(workspace / program, capsys, "word") == (code, text)


def test_ros2_run_takes_a_package_s_folder(
    workspace: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(workspace / "my_robot")
    for folder in (".", str(workspace / "my_robot")):
        assert ros2_over(["run", folder, "talker"], files=[], bag=None, seconds=1.0) == 0
        assert "my robot 57" in capsys.readouterr().out


def test_an_executable_that_a_package_lacks_is_refused_with_those_it_has(
    workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(
        CourseError, match=r"executable 'talk' not found in package .*: talker, fail, hello.py"
    ):
        shown(workspace / "my_robot:talk", capsys)


def test_a_compiled_executable_is_refused_as_what_it_is(
    workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cmake = workspace / "my_robot" / "CMakeLists.txt"
    cmake.write_text(cmake.read_text() + "add_executable(driver src/driver.cpp)\n")
    with pytest.raises(
        CourseError, match=r"'driver' of package .* is a compiled program, and this kit runs Py"
    ):
        shown(workspace / "my_robot:driver", capsys)


@pytest.mark.parametrize(
    ("package", "reason"),
    [
        ("gazebo_ros", "Gazebo is a simulator"),
        ("ros_gz_bridge", "Gazebo is a simulator"),
        ("webots_ros2_driver", "Webots is a simulator"),
        ("moveit", "MoveIt plans"),
        ("nav2_bringup", "navigation runs"),
        ("controller_manager", "ros2_control is made"),
        ("usb_cam", "a driver runs"),
    ],
)
def test_what_no_kit_without_ros_can_offer_says_so_and_what_to_do(package: str, reason: str) -> None:
    text = why_not_found(package)
    assert text.startswith(f"package '{package}' not found: {reason}")
    assert text.endswith("course run FILE --robot tcp/HOST:7447.")
    assert hint(ModuleNotFoundError(f"No module named '{package}.x'", name=f"{package}.x")) in text


@pytest.mark.parametrize("package", ["nav2_msgs", "moveit_msgs", "gazebo_msgs", "my_moveit", "nav2_common"])
def test_types_and_packages_of_ones_own_are_not_refused(package: str) -> None:
    assert not_offered(package) == ""
