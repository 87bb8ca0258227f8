"""Programs of a package in its sources, started by the package's folder, and files that lie in one."""

import os
import re
import runpy
from pathlib import Path

import pytest

from course_lib import cli
from course_lib.errors import CourseError
from course_lib.export.export import check_package
from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.hints import hint
from course_lib.ros.programs.build_files import build_faults
from course_lib.ros.programs.packages import NotAvailableError, not_found_reason, packages, unavailable_reason
from course_lib.ros.programs.program import run_files
from course_lib.tools.run import ros2_over
from tests.ros.launch.run import MANIFEST, SETUP_CFG

SCRIPTS = '["talker = my_robot.talker:main", "fail = my_robot.talker:fail"]'
SETUP = f'setup(packages=["my_robot"], entry_points={{"console_scripts": {SCRIPTS}}})'
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
    "my_robot/setup.cfg": SETUP_CFG,
    "my_robot/CMakeLists.txt": CMAKE,
    "my_robot/scripts/hello.py": SCRIPT,
    "my_robot/my_robot/__init__.py": "",
    "my_robot/my_robot/helpers.py": "def name():\n    return 'my robot'\n",
    "my_robot/my_robot/relative.py": "from .helpers import name\nprint('relative to', name())\n",
    "my_robot/my_robot/my_robot.py": (
        "from my_robot.helpers import name\nfrom .helpers import name as same\nprint(name(), same())\n"
    ),
    "my_robot/my_robot/talker.py": TALKER + "\nif __name__ == '__main__':\n    main()\n",
    "other_robot/other_robot/__init__.py": "",
    "other_robot/other_robot/units.py": "DEGREES = 57\n",
    "arm_msgs/msg/Angle.msg": "float64 degrees\n",
    "tools/far_msgs/msg/Distance.msg": "float64 meters\n",
    "tools/far_msgs/far_msgs/__init__.py": "UNIT = 'm'\n",
}


@pytest.fixture
def workspace(tmp_path: Path, restored_packages: None) -> Path:
    """Sources as in a workspace: a package of Python, another one, and one with messages."""
    for name, text in FILES.items():
        file = tmp_path / "src" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    for folder in (tmp_path / "src" / name for name in PACKAGES):
        (folder / "package.xml").write_text(MANIFEST.replace("my_robot", folder.name))
    return tmp_path / "src"


def run_program(program: Path, capsys: pytest.CaptureFixture[str], *args: str) -> tuple[int, str]:
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
        ("my_robot/my_robot/my_robot.py", 0, "my robot my robot\n"),
    ],
)
def test_program_in_a_package_finds_its_workspace(
    program: str, code: int, text: str, workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_program(workspace / program, capsys, "word") == (code, text)


def test_ros2_run_accepts_a_package_folder(
    workspace: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(workspace / "my_robot")
    for folder in (".", str(workspace / "my_robot")):
        assert ros2_over(["run", folder, "talker"], files=[], bag=None, seconds=1.0) == 0
        assert "my robot 57" in capsys.readouterr().out


def test_ros2_run_returns_the_exit_code_of_the_executable(
    workspace: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(workspace)
    (tmp_path / "wrong.launch.py").write_text("def generate_launch_description():\n    return 1 / 0\n")
    assert ros2_over(["run", "my_robot", "fail"], files=[], bag=None, seconds=1.0) == 3
    assert ros2_over(["launch", str(tmp_path / "wrong.launch.py")], files=[], bag=None, seconds=1.0) == 1
    assert ros2_over(["run", "my_robot", "talker"], files=[], bag=None, seconds=1.0) == 0


def test_course_option_after_an_executable_gets_a_hint(
    workspace: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(workspace / "my_robot")
    for words, count in ((["--seconds", "1"], 1), (["--ros-args", "-p", "seconds:=1"], 0)):
        ros2_over(["run", "my_robot", "talker", *words], files=[], bag=None, seconds=1.0)
        assert capsys.readouterr().err.count("course ros2 --seconds 1 run my_robot …") == count
    with pytest.raises(CourseError, match=r"with --run: course ros2 --run setup\.py topic list$"):
        ros2_over(["setup.py"], files=[], bag=None, seconds=1.0)


def test_missing_executable_is_rejected_with_the_available_ones(
    workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(
        CourseError, match=r"executable 'talk' not found in package .*: talker, fail, hello.py"
    ):
        run_program(workspace / "my_robot:talk", capsys)


def test_compiled_executable_is_rejected_with_the_reason(
    workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cmake = workspace / "my_robot" / "CMakeLists.txt"
    cmake.write_text(cmake.read_text() + "add_executable(driver src/driver.cpp)\n")
    with pytest.raises(
        CourseError, match=r"'driver' of package .* is a compiled program, and this kit runs Py"
    ):
        run_program(workspace / "my_robot:driver", capsys)


@pytest.mark.parametrize(
    ("package", "reason"),
    [
        ("gazebo_ros", "Gazebo is a simulator"),
        ("ros_gz_bridge", "Gazebo is a simulator"),
        ("webots_ros2_driver", "Webots is a simulator"),
        ("moveit", "MoveIt plans"),
        ("nav2_bringup", "navigation runs"),
        ("controller_manager", "ros2_control is made"),
        ("usb_cam", "a driver needs its device"),
        ("realsense2_camera", "a driver needs its device"),
        ("slam_toolbox", "navigation runs"),
        ("joy", "a gamepad is read"),
        ("teleop_twist_joy", "a gamepad is read"),
        ("twist_mux", "this forwards messages"),
        ("foxglove_bridge", "this is a server"),
        ("image_proc", "images are processed"),
        ("pointcloud_to_laserscan", "sensor data is filtered"),
        ("plotjuggler", "this window is"),
        ("clearpath_config", "this configures"),
        ("launch_testing", "this tests processes"),
    ],
)
def test_unavailable_ros_package_error_has_the_reason_and_the_next_step(package: str, reason: str) -> None:
    text = not_found_reason(package)
    assert text.startswith(f"package '{package}' not found: {reason}")
    assert text.endswith("course run FILE --robot dds/HOST.")
    assert hint(ModuleNotFoundError(f"No module named '{package}.x'", name=f"{package}.x")) in text


@pytest.mark.parametrize(
    "package",
    [
        *(
            "nav2_msgs",
            "moveit_msgs",
            "gazebo_msgs",
            "my_moveit",
            "nav2_common",
            "velodyne_msgs",
            "mavros_msgs",
        ),
        *(
            "clearpath_platform_msgs",
            "grid_map_msgs",
            "apriltag_msgs",
            "rqt_graph",
            "joystick_node",
            "my_joy",
        ),
    ],
)
def test_custom_types_and_packages_are_accepted(package: str) -> None:
    assert unavailable_reason(package) == ""


@pytest.mark.parametrize(
    "entry",
    ["go = my_robot.classes:Robot.go", "go=my_robot.classes : Robot.go", "go = my_robot.classes:go [x]"],
)
def test_entry_point_with_an_attribute_of_a_class_or_extras_is_run(
    entry: str, workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (workspace / "my_robot" / "my_robot" / "classes.py").write_text(
        "class Robot:\n    @staticmethod\n    def go():\n        print('gone')\ngo = Robot.go\n"
    )
    (workspace / "my_robot" / "setup.py").write_text(SETUP.replace('["talker', f'["{entry}", "talker'))
    assert run_program(workspace / "my_robot:go", capsys) == (0, "gone\n")


def test_missing_attribute_of_a_class_in_an_entry_point_is_reported(
    workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (workspace / "my_robot" / "my_robot" / "classes.py").write_text("class Robot:\n    def go(self): ...\n")
    entry = '["go = my_robot.classes:Robot.goo", "talker'
    (workspace / "my_robot" / "setup.py").write_text(SETUP.replace('["talker', entry))
    code, text = run_program(workspace / "my_robot:go", capsys)
    assert code == 1
    assert "the module my_robot.classes has no function 'Robot.goo'. Did you mean go?" in text


def test_executable_of_a_package_with_cmake_macros_of_its_own_cannot_run_here(
    workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    driver = workspace / "driver"
    (driver / "code").mkdir(parents=True)
    (driver / "package.xml").write_text("<package><name>driver</name></package>")
    (driver / "CMakeLists.txt").write_text("project(driver)\nour_macro(code)\n")
    (driver / "code" / "main.cpp").write_text("int main() {}\n")
    with pytest.raises(NotAvailableError, match="'driver_node' of package 'driver' cannot run here"):
        run_program(workspace / "driver:driver_node", capsys)


def test_missing_environment_variable_gets_the_commands_that_set_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv("TURTLEBOT3_MODEL", raising=False)
    models = {"TURTLEBOT3_MODELS": "burger"}
    with pytest.raises(KeyError) as caught:
        models[os.environ["TURTLEBOT3_MODEL"]]
    assert "is not set. Set it before: export TURTLEBOT3_MODEL=VALUE in" in hint(caught.value)


def test_program_that_reads_keys_without_a_terminal_gets_a_hint() -> None:
    termios = pytest.importorskip("termios")
    with open(os.devnull, encoding="utf-8") as file, pytest.raises(termios.error) as caught:
        termios.tcgetattr(file)
    assert hint(caught.value).startswith("the program reads single keys, which only a terminal has")


_NO_WINDOWS = (
    "OpenCV(4.12.0) window.cpp:1301: error: (-2:Unspecified error) The function is not implemented. "
    "Rebuild the library with Windows, GTK+ 2.x or Cocoa support. If you are on Ubuntu or Debian, "
    "install libgtk2.0-dev and pkg-config in function 'cvShowImage'\n"
)
_HEADLESS = "interactive framework, as 'headless' is currently running"


@pytest.mark.parametrize(
    ("kind", "base", "text", "cause", "instead"),
    [
        (
            "TclError",
            Exception,
            "no display name and no $DISPLAY environment variable",
            "a window needs a screen, and there is none here",
            "a slider of course_lib.controls",
        ),
        ("TclError", Exception, 'couldn\'t connect to display ":7"', "a window needs a screen", "a view"),
        ("error", Exception, _NO_WINDOWS, "this OpenCV has no windows", 'viewer.add("Image")'),
        ("error", RuntimeError, "No available video device", "pygame needs a screen", "publish markers"),
        ("error", RuntimeError, "x11 not available", "pygame needs a screen", "publish markers"),
        (
            "ImportError",
            ImportError,
            f"Cannot load backend 'TkAgg' which requires the 'tk' {_HEADLESS}",
            "TkAgg opens windows, and there is no screen here",
            'plt.savefig("figure.png")',
        ),
    ],
)
def test_window_without_a_screen_gets_the_cause_and_an_alternative(
    kind: str, base: type[Exception], text: str, cause: str, instead: str
) -> None:
    # The libraries are not installed with the kit, and their classes have these names.
    error = base(text) if base is ImportError else type(kind, (base,), {})(text)
    assert hint(error).startswith(cause)
    assert instead in hint(error)


def test_error_of_another_kind_from_opencv_gets_no_hint_about_windows() -> None:
    text = "OpenCV(4.12.0) color.cpp:196: error: (-215:Assertion failed) !_src.empty() in function 'cvtColor'"
    assert "window" not in hint(type("error", (Exception,), {})(text))


@pytest.mark.parametrize(
    ("module", "name"),
    [
        ("cv2", "opencv-python-headless"),
        ("serial", "pyserial"),
        ("ntplib", "ntplib"),
        ("PyQt6.QtWidgets", "PyQt6"),
        ("websocket", "websocket-client"),
    ],
)
def test_missing_module_of_pip_gets_the_command_that_installs_it(module: str, name: str) -> None:
    error = ModuleNotFoundError(f"No module named '{module}'", name=module)
    assert hint(error).endswith(f": pip install {name}")


@pytest.mark.parametrize(
    ("module", "text"),
    [
        ("RPi.GPIO", "RPi drives devices of the robot's own computer: run this program there."),
        (
            "ros2topic.api",
            "this is part of the program ros2, which pip can't install. Here node.get_",
        ),
        ("nav_2d_msgs.msg", "copy the package's folder from https://github.com/ros-navigation/navigation2"),
        ("nav_2d_msgs", "copy the package's folder from https://github.com/ros-navigation/navigation2"),
        ("webots_spot_msgs.msg", "put the folder webots_spot_msgs with its msg"),
        ("zed_interfaces.msg", "put the folder zed_interfaces with its msg"),
        ("py_trees_ros.trees", "py_trees itself runs, after pip install py-trees"),
        ("inputs", "pip install inputs"),
        ("PyKDL", "KDL is a compiled library, which pip can't install. Here course_lib.robots has forward"),
        ("python_qt_binding.QtWidgets", "Here `%rqt` shows graph, plot, console, bag and more"),
    ],
)
def test_missing_module_that_cannot_run_here_has_a_hint(module: str, text: str) -> None:
    assert text in hint(ModuleNotFoundError(f"No module named '{module}'", name=module))


@pytest.mark.parametrize("package", ["launch_pal", "simple_launch"])
def test_missing_source_package_gets_the_command_that_clones_it(package: str) -> None:
    command = f"git clone https://github.com/.*/{package}"
    error = ModuleNotFoundError(f"No module named '{package}.x'", name=f"{package}.x")
    assert re.fullmatch(
        f"it is a source package: clone it into the workspace's src, with {command}.", hint(error)
    )
    assert re.search(f"^package '{package}' not found: .* {command}.$", not_found_reason(package))


def test_packages_of_a_layout_are_found_from_any_folder(
    workspace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", "")
    monkeypatch.chdir("/")
    layout = workspace / "my_robot" / "view.rviz"
    layout.touch()
    cli._find_packages_of(layout)
    assert packages(in_working_folder=False)["far_msgs"] == workspace / "tools" / "far_msgs"


@pytest.mark.parametrize(
    ("line", "is_missing"),
    [
        ("speed = float(sys.argv[1])", True),
        ("name, x, y = sys.argv", True),
        ("speed = [][1]", False),
        ("name, x = sys.argv + ['1', '2']", False),
    ],
)
def test_missing_argument_of_a_program_has_a_hint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str, is_missing: bool
) -> None:
    file = tmp_path / "drive.py"
    file.write_text(f"import sys\n{line}\n")
    monkeypatch.setattr("sys.argv", ["drive.py"])
    with pytest.raises((IndexError, ValueError)) as caught:
        runpy.run_path(str(file))
    assert ("course run FILE -- VALUES" in hint(caught.value)) is is_missing


RESOURCE = ', data_files=[("share/index", ["resource/my_robot"])])'
CMAKE_BUILT = ("ament_python", "ament_cmake")


# Each row was built with colcon, or read by CMake: the second group of a row fails there.
@pytest.mark.parametrize(
    ("file", "old", "new", "fault"),
    [
        (
            "setup.cfg",
            SETUP_CFG,
            "",
            "has no install_scripts. ros2 run finds",
        ),
        ("setup.cfg", "lib/my_robot", "lib/robot", "has install_scripts=$base/lib/robot."),
        ("setup.cfg", SETUP_CFG, "script_dir=$base", "no section headers"),
        ("setup.py", '"]})', '"]}' + RESOURCE, "resource/my_robot of data_files is missing"),
        ("setup.py", "]})", "]}" + RESOURCE.replace("resource/my_robot", "my_robot"), "is a folder"),
        (
            "setup.py",
            'packages=["my_robot"]',
            "packages=[]",
            "packages lacks 'my_robot'",
        ),
        ("setup.py", 'packages=["my_robot"], ', "", "expected packages=[package_name]"),
        ("setup.py", "console_scripts", "console_script", "expected the key 'console_scripts'"),
        ("package.xml", "</package>", "", "not XML: no element found: line"),
        ("package.xml", "A robot.", "A & B", "not XML: not well-formed (invalid token): line 4"),
        ("package.xml", "<version>0.1.0</version>", "", "expected one <version> with a text, found 0"),
        ("package.xml", "0.1.0", "0.1", "the version is '0.1', expected three numbers"),
        ("package.xml", "A robot.", "", "expected one <description> with a text"),
        ("package.xml", "<license>MIT</license>", "", "expected <license> with a text"),
        ("package.xml", 'maintainer email="ada@example.com"', "maintainer", "<maintainer> has no address"),
        ("package.xml", ' format="3"', "", '<depend> needs <package format="3">'),
        ("package.xml", "<depend>", "<depends>rclpy</depends><depend>", "<depends> does not belong there"),
        ("package.xml", "<depend>", "<run_depend>numpy</run_depend><depend>", "<run_depend> does not belong"),
        ("package.xml", "<depend>", "<exec_depend>rclpy</exec_depend><depend>", "rclpy is in <depend> and"),
        ("package.xml", "<build_type>ament_python</build_type>", "", "the build type is 'catkin'"),
        ("package.xml", "ament_python", "ament_pyton", "the build type is 'ament_pyton', which Jazzy lacks"),
    ],
)
def test_fault_in_a_package_file_is_reported_when_the_package_starts(
    file: str, old: str, new: str, fault: str, workspace: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = workspace / "my_robot" / file
    assert build_faults("my_robot", path.parent) == []
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    code, text = run_program(workspace / "my_robot:talker", capsys)
    assert code == 0
    assert "my robot 57 2.0 3.0 m" in text
    assert f"warning: package 'my_robot' starts here, but not on a robot: {path}" in text
    assert fault in text
    assert "warning" not in run_program(workspace / "my_robot:talker", capsys)[1]
    assert not check_package(path.parent).is_complete


def test_package_without_init_file_is_reported_if_setup_searches_packages(workspace: Path) -> None:
    robot = workspace / "my_robot"
    (robot / "my_robot" / "__init__.py").unlink()
    assert build_faults("my_robot", robot) == []
    (robot / "setup.py").write_text(SETUP.replace('["my_robot"]', "find_packages()"))
    assert build_faults("my_robot", robot) == [
        f"{robot / 'my_robot'}: find_packages() of setup.py skips it, as it has no __init__.py."
    ]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ('if((A) AND (B)) # (\nset(y \\( "(" [==[ ( ]==])\nendif()\n#[[ ) " ]]\n', ""),
        (
            "project(x)\ninstall(PROGRAMS a.py\n  DESTINATION lib\nset(x 1)\n",
            "line 2: this command has",
        ),
        ("set(x 1))\n", "line 1: ) closes no command"),
        ('set(x 1)\nset(y "a)\n', 'line 2: " has no second quote'),
        ("message(ament_package)\n", "without it ros2 finds no package"),
        ("project(other)\n", "project(other) is not the <name> of package.xml, my_robot"),
    ],
)
def test_fault_in_a_cmake_file_is_reported_as_by_cmake(text: str, fault: str, workspace: Path) -> None:
    robot = workspace / "my_robot"
    (robot / "package.xml").write_text(MANIFEST.replace(*CMAKE_BUILT))
    (robot / "CMakeLists.txt").write_text(text if "message" in text else f"{text}ament_package()\n")
    faults = build_faults("my_robot", robot)
    assert len(faults) == bool(fault)
    assert fault in "".join(faults)
