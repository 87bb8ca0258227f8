"""`ros2 pkg` has the texts of ros2cli."""

import getpass
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.programs.import_path import STANDIN, provided_packages
from course_lib.ros.programs.packages import find_package
from course_lib.tools.ros2 import ros2
from course_lib.tools.run import ros2_over
from course_lib.tools.sources import RecordingSource

Run = Callable[[str], str]

CREATED = """\
going to create a new package
package name: my_pkg
destination directory: {here}
package format: 3
version: 0.0.0
description: TODO: Package description
maintainer: ['{user} <{user}@todo.todo>']
licenses: ['MIT']
build type: ament_python
dependencies: ['rclpy', 'sensor_msgs']
node_name: talker
creating folder ./my_pkg
creating ./my_pkg/package.xml
creating source folder
creating folder ./my_pkg/my_pkg
creating ./my_pkg/setup.py
creating ./my_pkg/setup.cfg
creating folder ./my_pkg/resource
creating ./my_pkg/resource/my_pkg
creating ./my_pkg/my_pkg/__init__.py
creating folder ./my_pkg/test
creating ./my_pkg/test/test_copyright.py
creating ./my_pkg/test/test_flake8.py
creating ./my_pkg/test/test_pep257.py
creating ./my_pkg/my_pkg/talker.py
"""


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Return the output of `ros2 pkg …` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    for variable in ("AMENT_PREFIX_PATH", "ROS_PACKAGE_PATH"):
        monkeypatch.delenv(variable, raising=False)

    def run(line: str) -> str:
        output: list[str] = []
        ros2(["pkg", *line.split()], RecordingSource(Recording(())), output.append)
        return "".join(output)

    return run


@pytest.fixture
def creation_output(run: Run) -> str:
    """Output of `ros2 pkg create` in the working folder."""
    line = "create --build-type ament_python my_pkg --license MIT --node-name talker"
    return run(f"{line} --dependencies rclpy sensor_msgs")


def test_each_step_has_the_output_of_ros2cli(creation_output: str, tmp_path: Path) -> None:
    assert creation_output == CREATED.format(here=tmp_path, user=getpass.getuser())
    for line in creation_output.splitlines():
        if line.startswith("creating ./"):
            assert (tmp_path / line.removeprefix("creating ")).is_file()


def test_created_package_is_listed_with_its_executable(
    creation_output: str, run: Run, tmp_path: Path
) -> None:
    package = find_package("my_pkg")
    assert package is not None
    assert package.executables == {"talker": ("my_pkg.talker", "main")}
    manifest = ElementTree.parse(tmp_path / "my_pkg/package.xml").getroot()
    assert [element.text for element in manifest.findall("depend")] == ["rclpy", "sensor_msgs"]
    assert run("executables my_pkg") == "my_pkg talker\n"
    assert run("executables my_pkg --full-path") == f"{tmp_path}/lib/my_pkg/talker\n"
    assert run("prefix my_pkg") == f"{tmp_path}\n"
    assert run("prefix my_pkg --share") == f"{tmp_path}/my_pkg\n"
    assert run("xml my_pkg -t version") == "0.0.0\n"
    assert run("xml my_pkg -t depend") == "rclpy\nsensor_msgs\n"
    assert ElementTree.fromstring(run("xml my_pkg")).findtext("license") == "MIT"


def test_unknown_license_causes_a_warning(run: Run) -> None:
    output = run("create --build-type ament_python my_pkg")
    assert "\n[WARNING]: Unknown license 'TODO: License declaration'.  This has been set in the" in output
    assert output.endswith("license identifiers:\n" + run("create x --license ?").split("\n", 1)[1])


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("create my_pkg", r"ament_cmake packages contain C\+\+.*create --build-type ament_python my_pkg"),
        ("create --build-type ament_python test", "'ament_python' packages can't be named 'test'"),
        ("create --build-type ament_python MyPkg", "not a package name"),
        ("create --build-type ament_python my_pkg", r"Aborted!\nThe directory already exists: \./my_pkg\n"),
        ("prefix my_pkgs", r"^Package not found\. Did you mean my_pkg\?$"),
        ("executables my_pgk", r"^Package 'my_pgk' not found\. Did you mean my_pkg\?$"),
        ("xml my_pkg -t maintainr", r"^XML tag not found\. Did you mean maintainer\?$"),
        ("xml rclpy", "^Package XML manifest not found: rclpy is part of the kit"),
    ],
)
def test_invalid_arguments_are_rejected_with_the_text_of_ros2_and_a_solution(
    creation_output: str, run: Run, line: str, text: str
) -> None:
    with pytest.raises(CourseError, match=text):
        run(line)


def test_kit_packages_are_listed_along_with_custom_packages(creation_output: str, run: Run) -> None:
    names = run("list").split()
    assert names == sorted(names)
    assert {*provided_packages(), "my_pkg", "rviz2"} <= set(names)
    assert run("prefix rclpy") == f"{STANDIN}\n"
    lines = run("executables").splitlines()
    assert {"my_pkg talker", "diagnostic_aggregator aggregator_node", "rviz2 rviz2"} <= set(lines)


def test_pkg_requires_neither_a_program_nor_a_recording(
    creation_output: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ros2_over(["pkg", "executables", "my_pkg"], files=[], bag=None, seconds=1.0) == 0
    assert capsys.readouterr().out == "my_pkg talker\n"


def test_created_executable_runs_from_the_command_line(
    creation_output: str, capfd: pytest.CaptureFixture[str]
) -> None:
    assert ros2_over(["run", "my_pkg", "talker"], files=[], bag=None, seconds=1.0) == 0
    assert capfd.readouterr().out == "Hi from my_pkg.\n"


def test_maintainer_is_required_if_the_user_has_no_name(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> str:
        raise KeyError("getpwuid(): uid not found: 1000760000")

    monkeypatch.setattr(getpass, "getuser", fail)
    with pytest.raises(CourseError, match="--maintainer-name NAME"):
        run("create --build-type ament_python my_pkg")
    assert "Ada" in run("create --build-type ament_python my_pkg --maintainer-name Ada")
