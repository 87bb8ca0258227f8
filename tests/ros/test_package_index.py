"""Packages of a workspace, found at any depth by the name in their package.xml."""

import os
import re
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib import load_robot
from course_lib.errors import CourseError
from course_lib.robots.robot import packages_only, resolve
from course_lib.ros.hints import hint
from course_lib.ros.programs.packages import find_package, not_found_reason, packages, workspace_of
from course_lib.ros.programs.xacro_program import run_xacro
from course_lib.tools.run import ros2_over
from tests.patience import PATIENCE
from tests.warm import run_course

STL = bytes(80) + struct.pack("<I12fH", 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
Make = Callable[..., Path]


@pytest.fixture
def make(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Make:
    """Work in a workspace; the function makes a package in its src and returns the package's folder."""
    for variable in ("AMENT_PREFIX_PATH", "ROS_PACKAGE_PATH"):
        monkeypatch.setenv(variable, "")
    (tmp_path / "ws" / "src").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "ws")

    def make(folder: str, name: str = "", **files: str) -> Path:
        package = tmp_path / "ws" / "src" / folder
        name = name or package.name
        for path, text in {"package.xml": f"<package><name>{name}</name></package>", **files}.items():
            (package / path).parent.mkdir(parents=True, exist_ok=True)
            (package / path).write_text(text)
        return package

    return make


def python(code: str) -> str:
    """Return the output of a program in the working folder, run as a notebook would."""
    process = subprocess.run(
        [sys.executable, "-c", f"import course_lib\n{code}"],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    return (process.stdout or process.stderr).strip()


def course(*words: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return run_course(*words, cwd=cwd)


@pytest.mark.parametrize("folder", ["arm", "repository/arm", "repository/group/deep/down/arm", "other_name"])
def test_package_is_found_at_any_depth_by_its_manifest_name(
    folder: str, make: Make, capsys: pytest.CaptureFixture[str]
) -> None:
    package = make(folder, "arm", **{"launch/arm.launch.xml": '<launch><log message="found"/></launch>'})
    assert packages() == {"arm": package}
    assert ros2_over(["launch", "arm", "arm.launch.xml"], files=[], bag=None, seconds=0.1) == 0
    assert "found" in capsys.readouterr().out
    assert python("from ament_index_python import get_package_share_path as p; print(p('arm'))") == str(
        package
    )


@pytest.mark.parametrize("marker", ["COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE"])
def test_folder_with_an_ignore_file_is_not_searched(marker: str, make: Make) -> None:
    make("old/arm", "arm", **{f"../{marker}": ""})
    make("arm_2", **{marker: ""})
    assert packages() == {}


def test_nested_package_and_package_in_a_hidden_folder_are_not_found(make: Make) -> None:
    make("arm")
    make("arm/test/inner")
    make(".cache/hidden")
    assert set(packages()) == {"arm"}


def test_folder_name_is_not_a_package_name(make: Make) -> None:
    package = make("folder", "arm")
    (package / "a.stl").write_bytes(STL)
    assert find_package("folder") is None
    assert resolve("package://arm/a.stl") == package / "a.stl"


def test_link_to_a_parent_folder_is_searched_once(make: Make) -> None:
    package = make("arm")
    (package.parent / "loop").symlink_to(package.parent, target_is_directory=True)
    assert packages() == {"arm": package}


def test_package_index_reflects_workspace_changes(make: Make) -> None:
    package = make("arm")
    assert set(packages()) == {"arm"}
    make("deep/leg")
    assert set(packages()) == {"arm", "leg"}
    (package / "package.xml").write_text("<package><!-- <name>old</name> --><name>hand</name></package>")
    assert set(packages()) == {"hand", "leg"}


def test_duplicate_package_name_is_reported_once(make: Make, capsys: pytest.CaptureFixture[str]) -> None:
    first, second = make("a", "arm"), make("b/arm", "arm")
    assert (packages(), packages()) == ({"arm": first}, {"arm": first})
    error = capsys.readouterr().err
    assert error.startswith(f"warning: there are 2 packages named 'arm': {first} and {second}. ")
    assert error.count("warning") == 1


@pytest.mark.parametrize("place", [".", "src", "src/arm", "src/arm/launch", "src/group", "scripts"])
def test_workspace_is_found_from_each_of_its_subfolders(
    place: str, make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make("arm", **{"launch/a.launch.py": ""})
    make("group/leg")
    folder = tmp_path / "ws" / place
    folder.mkdir(exist_ok=True)
    monkeypatch.chdir(folder)
    assert set(packages()) == {"arm", "leg"}
    assert workspace_of(folder) == tmp_path / "ws" / "src"


NAMESPACE = 'xmlns:xacro="http://wiki.ros.org/xacro"'


def test_package_mesh_is_found_next_to_its_install_location(make: Make) -> None:
    setup = 'setup(data_files=[("share/arm/meshes", ["data/a.stl"])])'
    package = make("arm", **{"setup.py": setup, "data/.keep": ""})
    (package / "data" / "a.stl").write_bytes(STL)
    assert resolve("package://arm/meshes/a.stl").read_bytes() == STL
    with pytest.raises(CourseError, match=rf"Correct the address: 'arm' is the package in {package}\."):
        resolve("package://arm/meshes/b.stl")
    with pytest.raises(CourseError, match=r"there is no package 'leg': put its folder, .* workspace's src\."):
        resolve("package://leg/meshes/b.stl")


def test_untrusted_address_cannot_reach_packages_in_the_working_folder(make: Make) -> None:
    (make("arm") / "a.stl").write_bytes(STL)
    with packages_only(), pytest.raises(CourseError, match="does not exist"):
        resolve("package://arm/a.stl")


def test_xacro_robot_finds_packages_and_meshes_in_its_workspace(
    make: Make, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    mesh = '<visual><geometry><mesh filename="package://parts/a.stl"/></geometry></visual>'
    parts = make(
        "deep/folder", "parts", **{"p.xacro": f"<robot {NAMESPACE}><link name='p'>{mesh}</link></robot>"}
    )
    (parts / "a.stl").write_bytes(STL)
    robot = make(
        "arm",
        **{
            "r.xacro": f'<robot name="r" {NAMESPACE}>'
            '<xacro:include filename="$(find parts)/p.xacro"/></robot>'
        },
    )
    for folder in (Path.cwd(), tmp_path):
        monkeypatch.chdir(folder)
        loaded = load_robot(robot / "r.xacro")
        assert loaded.resolve("package://parts/a.stl") == parts / "a.stl"
        assert len(loaded.visual_model.geometryObjects) == 1
    assert os.environ["ROS_PACKAGE_PATH"] == ""


def test_missing_mesh_of_a_robot_in_its_own_package_is_reported_with_the_package(
    make: Make, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    mesh = '<visual><geometry><mesh filename="package://arm/a.stl"/></geometry></visual>'
    package = make("arm", **{"r.urdf": f'<robot name="r"><link name="p">{mesh}</link></robot>'})
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CourseError, match=rf"Correct the address: 'arm' is the package in {package}\."):
        load_robot(package / "r.urdf")


def test_warning_about_packages_is_not_among_the_errors_of_xacro(
    make: Make, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = make("arm", **{"r.xacro": f'<robot name="r" {NAMESPACE}><link name="$(find arm)"/></robot>'})
    make("again", "arm")
    result = run_xacro([str(robot / "r.xacro")])
    assert (result.code, result.errors) == (0, "")
    assert "there are 2 packages named 'arm'" in capsys.readouterr().err


CMAKE = """
project(arm)
set(SCRIPTS scripts/one.py scripts/two)
list(APPEND SCRIPTS "scripts/three")
file(GLOB TOOLS ${CMAKE_CURRENT_SOURCE_DIR}/tools/*)
file(GLOB HERE ${CMAKE_CURRENT_SOURCE_DIR})
install(PROGRAMS ${SCRIPTS} ${TOOLS} DESTINATION lib/${PROJECT_NAME})  # python
install(
  PROGRAMS scripts/long_name.py
  DESTINATION lib/arm
  RENAME short)
install(DIRECTORY nodes/ DESTINATION lib/${PROJECT_NAME} USE_SOURCE_PERMISSIONS)
add_executable(driver src/driver.cpp)
"""
SHEBANG = "#!/usr/bin/env python3\n"


def test_scripts_installed_by_cmake_are_executables(make: Make) -> None:
    files = (
        "scripts/two",
        "scripts/three",
        "tools/four",
        "tools/six.py",
        "nodes/five",
        "scripts/long_name.py",
    )
    scripts = dict.fromkeys(files, SHEBANG)
    make("arm", **{"CMakeLists.txt": CMAKE, **scripts, "nodes/shell": "#!/bin/sh\n", "scripts/one.py": ""})
    package = find_package("arm")
    assert package is not None
    assert set(package.executables) == {"one.py", "two", "three", "four", "six.py", "five", "short"}
    assert package.compiled == {"driver"}


def test_executables_of_cmake_loops_and_macros_are_found(make: Make) -> None:
    cmake = """
macro(add_node name)
  set(target ${name}_node)
  add_executable(${target} src/${name}.cpp)
endmacro()
function(add_nodes)
  foreach(one IN LISTS ARGN)
    add_node(${one})
  endforeach()
endfunction()
Add_Node(camera)
add_nodes(laser imu)
set_target_properties(camera_node PROPERTIES OUTPUT_NAME eye PREFIX "")
foreach(side left right)
  foreach(part hand foot)
    add_executable(${side}_${part} src/${part}.cpp)
  endforeach()
  install(PROGRAMS scripts/${side} DESTINATION lib/${PROJECT_NAME})
endforeach()
"""
    make("arm", **{"CMakeLists.txt": cmake, "scripts/left": SHEBANG, "scripts/right": SHEBANG})
    found = find_package("arm")
    assert found is not None
    assert found.compiled == {
        *("camera_node", "eye", "laser_node", "imu_node"),
        *("left_hand", "left_foot", "right_hand", "right_foot"),
    }
    assert set(found.executables) == {"left", "right"}


@pytest.mark.parametrize(
    "cmake",
    [
        "macro(a)\nb()\nb()\nendmacro()\nmacro(b)\na()\na()\nendmacro()\na()",
        "set(many 1 2 3 4 5 6 7 8 9)\n" + "foreach(x ${many})\n" * 20 + "endforeach()\n" * 20,
        "macro(a)\nforeach(x)\nfunction(b",
    ],
)
def test_endless_or_malformed_cmake_file_is_read_up_to_a_limit(cmake: str, make: Make) -> None:
    make("arm", **{"CMakeLists.txt": cmake})
    found = find_package("arm")
    assert found is not None
    assert not found.compiled


def test_scripts_of_setup_py_and_setup_cfg_are_executables(make: Make) -> None:
    setup = (
        "package_name = 'arm'\n"
        "setup(scripts=['scripts/one'], data_files=[('lib/' + package_name, glob('tools/*'))],\n"
        "entry_points={'console_scripts': [f'two = {package_name}.two:main', "
        "'three = ' + package_name + '.three:main']})"
    )
    cfg = (
        "[options.entry_points]\nconsole_scripts =\n  four = arm.four:main\n"
        "[options]\nscripts = scripts/five\n"
    )
    scripts = dict.fromkeys(("scripts/one", "scripts/five", "tools/six"), SHEBANG)
    make("arm", **{"setup.py": setup, "setup.cfg": cfg, **scripts})
    package = find_package("arm")
    assert package is not None
    assert set(package.executables) == {"one", "two", "three", "four", "five", "six"}


@pytest.mark.parametrize(
    ("build", "folder"),
    [
        ({}, "arm"),
        ({}, "src/arm"),
        ({"setup.py": "setup(package_dir={'': 'source'})"}, "source/arm"),
        ({"setup.py": "setup(package_dir={'arm': 'python/code'})"}, "python/code"),
        ({"setup.cfg": "[options]\npackage_dir =\n    = lib"}, "lib/arm"),
        ({"CMakeLists.txt": "ament_python_install_package(${PROJECT_NAME} PACKAGE_DIR py)"}, "py"),
    ],
)
def test_python_package_is_imported_from_its_build_location(
    build: dict[str, str], folder: str, make: Make, tmp_path: Path
) -> None:
    code = {f"{folder}/__init__.py": "", f"{folder}/names.py": "NAME = 'arm'"}
    make("group/folder", "arm", **build, **code)
    make("other")
    script = make("scripts", **{"s.py": "import arm.names\nprint(arm.names.NAME)"}) / "s.py"
    assert python("from arm.names import NAME; print(NAME)") == "arm"
    process = course("run", script, cwd=tmp_path)
    assert (process.stdout, process.stderr) == ("arm\n", "")


@pytest.mark.parametrize(
    ("folder", "inner"),
    [("arm", "arm"), ("arm", "src/arm"), ("arm/arm", "arm"), ("group/arm", "arm")],
)
def test_python_package_is_imported_if_the_folder_of_its_ros_package_is_on_the_path(
    folder: str, inner: str, make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = Path(inner).parent
    setup = f"setup(packages=['arm'], package_dir={{'': '{root}'}})"
    make(
        folder, "arm", **{"setup.py": setup, f"{inner}/__init__.py": "", f"{inner}/names.py": "NAME = 'arm'"}
    )
    for place in ("src", str(Path("src", folder).parent)):
        with monkeypatch.context() as moved:
            moved.chdir(Path.cwd() / place)
            assert python("from arm.names import NAME; print(NAME)") == "arm"


def test_folder_without_a_package_stays_a_namespace_package(make: Make) -> None:
    make("arm")
    Path("tools").mkdir()
    Path("tools/one.py").write_text("NAME = 1")
    assert python("from tools.one import NAME; print(NAME)") == "1"


def test_messages_are_imported_in_the_parent_folder_of_their_package(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    make("around_msgs/around_msgs", **{"msg/Angle.msg": "float64 degrees\n"})
    monkeypatch.chdir("src")
    code = "from around_msgs.msg import Angle; print(Angle(degrees=2.0).degrees)"
    assert python(code) == "2.0"


@pytest.mark.slow
def test_messages_are_imported_from_a_package_in_a_differently_named_folder(make: Make) -> None:
    make("group/repository", "depth_one_msgs", **{"msg/Angle.msg": "float64 degrees\n"})
    make("depth_two_msgs", **{"srv/Turn.srv": "depth_one_msgs/Angle angle\n---\n"})
    code = (
        "from depth_one_msgs.msg import Angle; from depth_two_msgs.srv import Turn; "
        "print(Turn.Request(angle=Angle(degrees=2.0)))"
    )
    assert "degrees=2.0" in python(code)
    (Path("src") / "depth_two_msgs" / "srv" / "Wrong.srv").write_text("no_type x\n")
    process = course("ros2", "interface", "list")
    assert "    depth_one_msgs/msg/Angle\n" in process.stdout
    assert re.search(r"^warning: .*Wrong\.srv", process.stderr)
    completed = course("ros2", "interface", "show", "depth_one_msgs/msg/Angle")
    assert completed.stdout == "float64 degrees\n"


@pytest.mark.parametrize(
    ("files", "reason"),
    [
        ({"old/leg/package.xml": "leg", "old/COLCON_IGNORE": ""}, r"ignored because of the file .*/COLCON_I"),
        ({"arm/parts/leg/package.xml": "leg"}, r"is inside of the package in .*/src/arm, where colcon does "),
        (
            {"../install/leg/share/leg/package.xml": "leg", "../install/COLCON_IGNORE": ""},
            "AMENT_PREFIX_PATH=",
        ),
    ],
)
def test_package_ignored_by_colcon_is_reported_with_its_folder(
    files: dict[str, str], reason: str, make: Make
) -> None:
    make("arm", **{f"../{path}": f"<package><name>{name}</name></package>" for path, name in files.items()})
    assert re.search(rf"^package 'leg' not found: .*{reason}", not_found_reason("leg"))


def test_package_whose_folder_is_empty_gets_the_command_for_submodules(make: Make) -> None:
    folder = make("arm").parent / "leg_msgs"
    folder.mkdir()
    text = f"its folder {folder} is empty. A submodule of git is empty after a clone: run git submodule"
    assert text in not_found_reason("leg_msgs")
    assert text in hint(ModuleNotFoundError("No module named 'leg_msgs'", name="leg_msgs.msg"))


def test_robot_is_loaded_by_its_address(make: Make) -> None:
    xacro = '<robot name="$(arg name)" xmlns:xacro="http://wiki.ros.org/xacro"><link name="a"/></robot>'
    make(
        "folder", "arm", **{"urdf/r.xacro": xacro, "urdf/r.urdf": '<robot name="u"><link name="a"/></robot>'}
    )
    assert load_robot("package://arm/urdf/r.xacro", name="x").name == "x"
    assert load_robot("package://arm/urdf/r.urdf").name == "u"
    with pytest.raises(CourseError, match=r"package://arm/urdf/s\.urdf does not exist.*'arm' is the package"):
        load_robot("package://arm/urdf/s.urdf")


def test_missing_package_error_does_not_list_hundreds_of_packages(make: Make) -> None:
    for number in range(20):
        make(f"package_{number:02}")
    text = not_found_reason("package_99")
    assert text.count("/ws/src'") == 1
    assert "package_11 and 8 more (ros2 pkg list)" in text
    assert "package_12" not in text


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("CMakeLists.txt", 'file(GLOB all "")\nfile(GLOB some .)'),
        ("CMakeLists.txt", "file(GLOB_RECURSE all ${CMAKE_SOURCE_DIR} src/**.cpp)"),
        ("CMakeLists.txt", "set(a\nforeach(x IN ${a})\ninstall(PROGRAMS)"),
        (
            "setup.py",
            "from glob import glob\nsetup(scripts=glob('.'), data_files=[('a', glob('**.py'))])",
        ),
        ("setup.py", "def ("),
        ("setup.cfg", "[options"),
    ],
)
def test_invalid_build_file_of_one_package_does_not_affect_others(file: str, text: str, make: Make) -> None:
    make("odd", **{file: text})
    make("fine", **{"fine/__init__.py": "", "setup.py": "setup()"})
    assert python("import fine; print('imported')") == "imported"
    assert python("import no_such").endswith("No module named 'no_such'")


def test_many_packages_in_several_workspaces_are_reported_in_few_lines(
    make: Make, capsys: pytest.CaptureFixture[str]
) -> None:
    for copy in range(5):
        for number in range(30):
            make(f"section{copy}/ws/src/arm{number}", f"arm{number}")
    assert len(packages()) == 30
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 4
    assert "there are 5 packages named 'arm0'" in lines[0]
    assert "and 2 more. The first one is used" in lines[0]
    assert lines[3].startswith("warning: 27 more names are each used by several packages: ")


def test_package_overridden_by_a_nearer_workspace_is_not_reported(
    make: Make, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    near = make("section1/ws/src/arm")
    make("section2/ws/src/arm")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(near.parent))
    assert packages() == {"arm": near}
    assert capsys.readouterr().err == ""


def test_module_of_another_platform_is_not_searched_in_the_workspace(make: Make) -> None:
    make("msvcrt", **{"msvcrt/__init__.py": "raise SystemExit('imported')"})
    assert python("import subprocess; print('fine')") == "fine"


def test_packages_are_listed_as_resources_of_the_index(make: Make) -> None:
    prefix = str(make("arm").parent)
    code = (
        "from ament_index_python import *; "
        "print(get_resource('packages', 'arm'), has_resource('packages', 'a'))"
    )
    assert python(code) == f"('', {prefix!r}) False"
    code = (
        "from ament_index_python import *; "
        "print({get_resources('packages')['rclpy'], get_package_prefix('rclpy'), "
        "has_resource('packages', 'rclpy'), get_packages_with_prefixes()['rclpy']})"
    )
    assert python(code) == "{'/opt/ros/jazzy'}"
    assert "LookupError: Could not find the resource 'a' of type 'packages'" in python(
        "from ament_index_python import *; get_resource('packages', 'a')"
    )
    assert "InvalidResourceNameError: Resource name 'a/b' is invalid" in python(
        "from ament_index_python import *; has_resource('packages', 'a/b')"
    )


def test_resources_that_build_files_register_are_in_the_index(make: Make) -> None:
    setup = (
        "from setuptools import setup\nname = 'arm'\nsetup(name=name, data_files=[\n"
        "('share/ament_index/resource_index/packages', ['resource/' + name]),\n"
        "('share/ament_index/resource_index/tools', ['resource/' + name])])"
    )
    make("arm", **{"setup.py": setup, "resource/arm": "a gripper"})
    cmake = (
        'project(plugins)\nament_index_register_resource(shapes CONTENT "box")\n'
        "ament_index_register_resource(colors CONTENT_FILE colors.txt PACKAGE_NAME paint)\n"
        "pluginlib_export_plugin_description_file(nav2_core config/plugins.xml)\n"
    )
    make("plugins", **{"CMakeLists.txt": cmake, "colors.txt": "red"})
    prefix = str(make("counts", **{"msg/Count.msg": "int32 n\n", "srv/Add.srv": "---\n"}).parent)
    code = """
from ament_index_python import *
print(sorted(get_resource_types()))
types = ("tools", "shapes", "colors", "nav2_core__pluginlib__plugin")
for type, name in zip(types, ("arm", "plugins", "paint", "plugins")):
    print(get_resource(type, name), get_resources(type))
content, at = get_resource("rosidl_interfaces", "counts")
print(content.split(), at, has_resource("rosidl_interfaces", "std_msgs"))
"""
    assert python(code).splitlines() == [
        "['colors', 'nav2_core__pluginlib__plugin', 'packages', 'rosidl_interfaces', 'shapes', 'tools']",
        f"('a gripper', {prefix!r}) {{'arm': {prefix!r}}}",
        f"('box', {prefix!r}) {{'plugins': {prefix!r}}}",
        f"('red', {prefix!r}) {{'paint': {prefix!r}}}",
        f"('share/plugins/plugins.xml\\n', {prefix!r}) {{'plugins': {prefix!r}}}",
        f"['msg/Count.idl', 'msg/Count.msg', 'srv/Add.idl', 'srv/Add.srv'] {prefix} /opt/ros/jazzy",
    ]
