"""xacro itself is tested by its project; here it meets the kit's packages, launch files and robots."""

import os
from pathlib import Path

import pytest
from IPython.core.interactiveshell import InteractiveShell
from launch import LaunchContext
from launch.substitutions import Command, FindExecutable, PathJoinSubstitution, SubstitutionFailure
from launch_ros.substitutions import FindPackageShare

from course_lib.errors import CourseError
from course_lib.robots import load_robot
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.tools.notebook import register
from tests.ros.launch.run import recorded
from tests.warm import run_course

XACRO = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"'
ARM = f"""{XACRO} name="two_links">
  <xacro:arg name="tip" default="tip"/>
  <xacro:include filename="$(find tiny_arm)/urdf/link.xacro"/>
  <xacro:property name="length" value="${{0.25 * 2}}"/>
  <xacro:bar name="base" size="${{length}}"/>
  <xacro:bar name="$(arg tip)" size="${{length / 2}}"/>
  <joint name="hinge" type="revolute">
    <parent link="base"/><child link="$(arg tip)"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="${{radians(90)}}" effort="1" velocity="1"/>
  </joint>
</robot>
"""
LINK = f"""{XACRO}>
  <xacro:macro name="bar" params="name size">
    <link name="${{name}}"><visual><geometry><box size="${{size}} 0.1 0.1"/></geometry></visual></link>
  </xacro:macro>
</robot>
"""
LAUNCH = """
from launch import LaunchDescription
from launch.substitutions import Command, FindExecutable, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    file = PathJoinSubstitution([FindPackageShare("tiny_arm"), "urdf", "arm.urdf.xacro"])
    text = Command([FindExecutable(name="xacro"), " ", file, " tip:=launched"])
    description = {"robot_description": ParameterValue(text, value_type=str)}
    publisher = "robot_state_publisher"
    return LaunchDescription([Node(package=publisher, executable=publisher, parameters=[description])])
"""


@pytest.fixture
def arm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The xacro file of a package in the working folder."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "tiny_arm" / "urdf"
    folder.mkdir(parents=True)
    (folder.parent / "package.xml").write_text("<package><name>tiny_arm</name></package>")
    (folder / "link.xacro").write_text(LINK)
    (folder / "arm.urdf.xacro").write_text(ARM)
    return folder / "arm.urdf.xacro"


@pytest.fixture
def context() -> LaunchContext:
    return LaunchContext()


def test_find_in_xacro_resolves_the_same_package_as_launch(arm: Path, context: LaunchContext) -> None:
    share = PathJoinSubstitution([FindPackageShare("tiny_arm"), "urdf", "arm.urdf.xacro"])
    for program in ("xacro", FindExecutable(name="xacro")):
        text = Command([program, " ", share, " tip:=given"]).perform(context)
        assert '<link name="given">' in text
        assert '<box size="0.25 0.1 0.1"/>' in text


def test_launched_robot_state_publisher_publishes_the_xacro_output(arm: Path, tmp_path: Path) -> None:
    file = tmp_path / "arm.launch.py"
    file.write_text(LAUNCH)
    recording, code = recorded(file)
    (description,) = [s.message().data for s in recording.samples if s.topic == "/robot_description"]
    assert code == 0
    assert '<link name="launched">' in description


def test_launch_file_runs_xacro_as_a_subprocess(
    arm: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PATH", os.defpath)
    file = tmp_path / "tiny_arm" / "launch" / "arm.launch.py"
    file.parent.mkdir()
    file.write_text(
        "import os, subprocess\n"
        "from launch import LaunchDescription\n"
        "from launch.actions import LogInfo\n\n\n"
        "def generate_launch_description():\n"
        f"    urdf = subprocess.check_output(['xacro', {str(arm)!r}], text=True)\n"
        f"    assert os.popen('xacro {arm}').read() == urdf\n"
        "    return LaunchDescription([LogInfo(msg=f'{urdf.count(\"<link\")} links')])\n"
    )
    assert recorded(file)[1] == 0
    assert "[launch.user]: 2 links" in capsys.readouterr().out


def test_xacro_error_is_reported_with_the_error_text_of_xacro(arm: Path, context: LaunchContext) -> None:
    arm.write_text(ARM.replace("${length / 2}", "${width}"))
    with pytest.raises(SubstitutionFailure, match="name 'width' is not defined"):
        Command(["xacro ", str(arm)]).perform(context)


def test_xacro_warning_fails_the_command_unless_on_stderr_is_ignore(
    arm: Path, context: LaunchContext
) -> None:
    arm.write_text(ARM.replace("radians(90)", "sorted([1, 2])[0]"))
    with pytest.raises(SubstitutionFailure, match="showed stderr output"):
        Command(["xacro ", str(arm)]).perform(context)
    assert "<robot" in Command(["xacro ", str(arm)], on_stderr="ignore").perform(context)


def test_ros2_run_output_can_be_redirected_into_a_file(arm: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shell = InteractiveShell.instance()
    register(shell)
    line = f"import rclpy\nrclpy.init()\n%ros2 run xacro xacro {arm} tip:=printed > made.urdf"
    with use_graph(Graph(notebook=True)):
        assert shell.run_cell(line).success
    assert '<link name="printed">' in Path("made.urdf").read_text()


def test_robots_are_loaded_from_xacro_files(arm: Path) -> None:
    robot = load_robot(arm)
    assert (robot.name, robot.model.nq) == ("two_links", 1)
    assert [shape.geometry.halfSide[0] for shape in robot.visual_model.geometryObjects] == [0.25, 0.125]


def test_missing_package_is_reported_once(arm: Path) -> None:
    arm.write_text(ARM.replace("<xacro:", '<xacro:include filename="$(find gone)/a.xacro"/><xacro:', 1))
    with pytest.raises(CourseError) as raised:
        load_robot(arm)
    assert str(raised.value).count("package 'gone' not found") == 1
    assert "<class" not in str(raised.value)


@pytest.mark.parametrize("file", ["missing.xacro", "empty.xacro"])
def test_unreadable_xacro_file_is_an_error_without_a_traceback(file: str, tmp_path: Path) -> None:
    (tmp_path / "empty.xacro").touch()
    process = run_course("ros2", "run", "xacro", "xacro", file, cwd=tmp_path)
    assert process.returncode
    assert "Traceback" not in process.stderr
    assert file in process.stderr
    with pytest.raises(CourseError, match=file):
        load_robot(tmp_path / file)


def test_program_that_expands_a_missing_xacro_file_gets_the_error_of_xacro(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text("import rclpy\nimport xacro\nxacro.process_file('missing.xacro')\n")
    process = run_course("run", "program.py", cwd=tmp_path)
    assert "XacroException: No such file or directory: ./missing.xacro" in process.stdout + process.stderr


def test_invalid_xacro_file_is_one_error(arm: Path) -> None:
    arm.write_text(ARM.replace("xacro:bar", "xacro:beam"))
    with pytest.raises(
        CourseError, match=r"xacro cannot expand .*arm\.urdf\.xacro, line \d+\): .*xacro:beam"
    ):
        load_robot(arm)


def test_xacro_command_with_a_space_in_the_path_has_a_hint(arm: Path, tmp_path: Path) -> None:
    file = tmp_path / "my files" / arm.name
    file.parent.mkdir()
    file.write_text(arm.read_text())
    with pytest.raises(SubstitutionFailure, match="hint: a command is split at its spaces"):
        Command(["xacro ", str(file)]).perform(LaunchContext())
    assert "two_links" in Command(["xacro ", '"', str(file), '"']).perform(LaunchContext())


def test_command_without_a_space_behind_xacro_is_recognized(tmp_path: Path, context: LaunchContext) -> None:
    with pytest.raises(
        SubstitutionFailure, match=r"A space is missing after xacro: Command\(\['xacro ', path\]\)"
    ):
        Command(["xacro", str(tmp_path / "arm.xacro")]).perform(context)
