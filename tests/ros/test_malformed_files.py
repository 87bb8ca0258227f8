"""Malformed files of a workspace: errors contain the file and line, without frames of the kit."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib import load_robot
from course_lib.displays.layout import read_layout
from course_lib.errors import CourseError
from course_lib.robots.nav2 import read_map
from course_lib.robots.urdf import find_slips, parse_urdf
from course_lib.ros.messages.definitions import add_package
from course_lib.ros.programs.build_files import executables_of, read_build_files
from course_lib.viewer.drawables import load_mesh
from tests.warm import run_course

XACRO = '<robot name="r" xmlns:xacro="http://wiki.ros.org/xacro">'
JOINT = '<joint name="j" type="{}"><parent link="a"/><child link="b"/></joint>'
SETUP = "from setuptools import setup\nsetup(entry_points={'console_scripts': [\n    %s\n]})\n"
Write = Callable[[str, str], Path]


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    """Work in an empty workspace; the function writes a file of it."""
    for variable in ("AMENT_PREFIX_PATH", "ROS_PACKAGE_PATH"):
        monkeypatch.setenv(variable, "")
    monkeypatch.chdir(tmp_path)

    def write(path: str, text: str) -> Path:
        file = tmp_path / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        return file

    return write


def errors_of(*words: str) -> str:
    process = run_course(*words)
    assert process.returncode
    return process.stdout + process.stderr


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (f'{XACRO}\n<link name="${{b}}"/></robot>', r"\(r\.xacro, line 2\): error: name 'b' is not defined"),
        (f"{XACRO}\n\n<xacro:nope/></robot>", r"\(r\.xacro, line 3\): error: unknown macro name: xacro:nope"),
        (
            f'{XACRO}\n<xacro:include filename="no.xacro"/></robot>',
            r"\(r\.xacro, line 2\): error: No such file",
        ),
        (
            f'{XACRO}\n<xacro:include filename="$(find nope)/a"/></robot>',
            r"\(r\.xacro, line 2\).*'nope' not f",
        ),
        (f'{XACRO}\n<xacro:if value="maybe"/></robot>', r"\(r\.xacro, line 2\): error: Xacro conditional"),
        (f'{XACRO}\n<link name="$(arg n)"/></robot>', r"\(r\.xacro, line 2\): error: Undefined substitution"),
        (
            f'{XACRO}\n<xacro:macro name="m" params="a"><link name="${{a}}"/></xacro:macro>'
            "\n<xacro:m/></robot>",
            r"\(r\.xacro, line 3\): error: Undefined parameters \[a\]",
        ),
        (f"{XACRO}\n<link>", r"XML parsing error: no element found: line 2"),
    ],
)
def test_xacro_error_includes_the_line(write: Write, text: str, expected: str) -> None:
    with pytest.raises(CourseError, match=rf"^xacro cannot expand .*r\.xacro.*{expected}"):
        load_robot(write("r.xacro", text))


MACRO = '<xacro:macro name="leg" params="name x"><link name="${name}"/></xacro:macro>'


@pytest.mark.parametrize(
    ("body", "advice"),
    [
        ('<link name="${height}"/>', 'Set it above: <xacro:property name="height" value="0.1"/>.'),
        ('<xacro:property name="height" value="1"/><link name="${heigth}"/>', "Did you mean height?"),
        (
            '<xacro:property name="h"/><link name="${h}"/>',
            'The property h has no value above this line: write value="0.1".',
        ),
        (f'{MACRO}<xacro:leg name="a"/>', 'The call lacks a value: add x="…" to it'),
        (f'{MACRO}<xacro:leg name="a" x="1" y="1"/>', "The macro leg has the parameters name x."),
        (
            f'{MACRO.replace("name x", "name, x")}<xacro:leg name="a" x="1"/>',
            'The names in params="name, x" are separated by spaces, without commas.',
        ),
        (f'{MACRO}<xacro:lag name="a" x="1"/>', "Did you mean leg?"),
        ('<xacro:wheel name="a"/>', "Define the macro wheel above, or include its file."),
        (f'<xacro:leg name="a" x="1"/>{MACRO}', "The macro leg is defined below this line"),
        ('<link name="$(x)"/>', "A property is read as ${x}; $( ) is for find and arg."),
        ('<xacro:if value="yes"><link name="a"/></xacro:if>', 'Write value="true" or "false"'),
        (f'{MACRO.replace(" x", " *x")}<xacro:leg name="a"/>', "The macro has a *block: put one tag"),
        ('<link name="${1 + }"/>', "In ${ } stands one Python expression"),
        ('<xacro:include filename="whel.xacro"/>', "An included path is relative to this file"),
        ('<link name="a">', "<link> of line 2 is still open where </robot> comes: end it"),
    ],
)
def test_xacro_error_states_the_correction(write: Write, body: str, advice: str) -> None:
    with pytest.raises(CourseError) as error:
        load_robot(write("r.xacro", f"{XACRO}\n{body}</robot>"))
    assert advice in str(error.value).splitlines()[-1]


def test_macro_call_without_prefix_is_reported(write: Write, capsys: pytest.CaptureFixture[str]) -> None:
    box = '<xacro:macro name="box" params="s"><link name="${s}"><visual><geometry><box size="1 1 1"/>'
    load_robot(
        write("s.xacro", f'{XACRO}{box}</geometry></visual></link></xacro:macro><xacro:box s="a"/></robot>')
    )
    assert not capsys.readouterr().err
    load_robot(write("r.xacro", f'{XACRO}\n<link name="a"/>{MACRO}\n<leg name="b" x="1"/></robot>'))
    assert "r.xacro, line 3: <leg> is copied and not expanded." in capsys.readouterr().err


def test_endless_macro_is_a_short_error(write: Write) -> None:
    macro = '<xacro:macro name="m" params="a"><xacro:m a="1"/></xacro:macro>'
    with pytest.raises(CourseError, match=r"\(r\.xacro, line 2\): error: maximum recursion") as error:
        load_robot(write("r.xacro", f'{XACRO}\n{macro}\n<xacro:m a="1"/></robot>'))
    assert len(str(error.value).splitlines()) < 8


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ('<link name="a"/>\n<link name="a"/>', r", line 2: The URDF is not valid: link 'a' is not unique"),
        (
            f'<link name="a"/><link name="b"/>\n{JOINT.format("x")}',
            r", line 3: .*Joint \[j\] has no known type",
        ),
        ('<link name="a"/>\n<link name="b"/>', r", line 2: .*Two root links found: \[a\] and \[b\]"),
        ("<link", r": The URDF is not XML: .*line 2"),
        (
            '<link name="a"><visual><geometry>\n<mesh filename="package://no/a.stl"/></geometry></visual></link>',
            r", line 3: The file package://no/a\.stl does not exist",
        ),
    ],
)
def test_urdf_file_error_includes_the_line(write: Write, body: str, expected: str) -> None:
    with pytest.raises(CourseError, match=rf"^.*/r\.urdf{expected}"):
        load_robot(write("r.urdf", f'<robot name="r">\n{body}</robot>'))


LIMIT = '<limit effort="1" velocity="1" lower="-1" upper="1"/>'
ARM = (
    '<link name="base"/>\n<link name="arm"/>\n<joint name="j" type="revolute">'
    f'<origin xyz="0 0 1"/><parent link="base"/><child link="arm"/>{LIMIT}</joint>'
)


@pytest.mark.parametrize(
    ("old", "new", "advice"),
    [
        (
            '<parent link="base"/>',
            "",
            'Write <parent link="NAME"/> and <child link="NAME"/> into this joint.',
        ),
        ('<parent link="base"/>', '<parent link="bas"/>', "Did you mean base?"),
        ('<parent link="base"/>', '<parent link="x"/>', 'Add <link name="x"/>.'),
        ('<link name="arm"/>', '<Link name="arm"/>', "A link's tag is <link>, and arm is in a <Link>."),
        ('<link name="arm"/>', '<link name="arm"/><link name="hand"/>', 'with <child link="hand"/>.'),
        ("0 0 1", "0, 0, 1", "Separate the numbers with spaces, without commas."),
        ("0 0 1", "0 1", "Write 3 numbers, separated by spaces."),
        ("0 0 1", "0 0 pi/2", "A URDF contains numbers and no formulas"),
        ("0 0 1", "0 0 ${h}", "This is the text of a xacro file"),
        ("0 0 1", "0 0 {h}", "A property of xacro is read with a $, as in ${height}."),
        ("0 0 1", "0 0 x", "Write numbers with points"),
        (LIMIT, "", 'A limit looks like <limit lower="-1.57"'),
        ('effort="1"', "", 'A limit looks like <limit lower="-1.57"'),
        ("revolute", "rotational", "floating, planar. Did you mean revolute?"),
        ("revolute", "Revolute", "floating, planar. Did you mean revolute?"),
        ('name="arm"/>', 'name="base"/>', "Give the second one another name."),
        ('<link name="base"/>', '<link name="base">', "<link> of line 2 is still open where </robot> comes"),
        ('xyz="0 0 1"', 'xyz="0 0 1', "Is a quote or a > missing in line 4, or above?"),
        ('xyz="0 0 1"', "xyz=1", "The value of an attribute is in quotes. See line 4"),
        ("<origin", "<!-- a -- b --><origin", "A comment cannot contain --, as in line 4"),
        ("<parent", "<xacro:leg/><parent", "without xmlns:xacro="),
        ("</joint>", "</joint></robot><a/>", "A file has one outermost tag"),
        ('<link name="base"/>', '<?xml version="1.0"?>', "Nothing may be above <?xml …?>"),
    ],
)
def test_urdf_error_states_the_correction(old: str, new: str, advice: str) -> None:
    with pytest.raises(CourseError) as error:
        parse_urdf(f'<robot name="r">\n{ARM.replace(old, new)}</robot>')
    assert advice in str(error.value)


def test_snippets_of_advice_make_the_urdf_valid() -> None:
    for old in (LIMIT, '<parent link="base"/>'):
        with pytest.raises(CourseError) as error:
            parse_urdf(f'<robot name="r">{ARM.replace(old, "")}</robot>')
        tag = next(tag for tag in re.findall(r"<[^<>]+/>", str(error.value)))
        parse_urdf(f'<robot name="r">{ARM.replace(old, tag.replace("NAME", "base"))}</robot>')


def test_path_in_place_of_the_text_of_a_urdf_is_recognized() -> None:
    with pytest.raises(
        CourseError, match=r"is it a path\? Pass the text of the file, open\(path\)\.read\(\)"
    ):
        parse_urdf("arm.urdf")


def test_link_with_two_parents_is_reported_with_its_name() -> None:
    second = '<joint name="k" type="fixed"><parent link="base"/><child link="arm"/></joint>'
    with pytest.raises(CourseError, match="'arm' is the child of j and k"):
        parse_urdf(f'<robot name="r">{ARM}{second}</robot>')


@pytest.mark.parametrize(
    ("old", "new", "hint"),
    [
        ("<origin", "<orgin", "j: <orgin> is ignored. Did you mean <origin>?"),
        (
            'xyz="0 0 1"',
            'x="0" z="1"',
            'j: x and z of <origin> are ignored: write xyz="0 0 0.1" rpy="0 0 0".',
        ),
        ('xyz="0 0 1"', 'rpy="0 0 90"', "j: rpy is in radians: 90° is 1.5708."),
        ('upper="1"', 'upper="90"', "j: limits are in radians: 90° is 1.5708, and 90 is in degrees?"),
        ('upper="1"', 'upper="-2"', "j: lower=-1 is above upper=-2: swap them."),
        (
            'name="arm"/>',
            'name="arm"><inertial><mass>2.5</mass></inertial></link>',
            'arm: the mass is 0: write <mass value="2.5"/>.',
        ),
        (
            'name="arm"/>',
            'name="arm"><visual><material name="blue"/></visual></link>',
            "arm: no material 'blue' has a color, so this link is red.",
        ),
    ],
)
def test_part_of_a_urdf_that_urdfdom_ignores_has_a_hint(old: str, new: str, hint: str) -> None:
    text = f'<robot name="r">{ARM.replace(old, new)}</robot>'
    parse_urdf(text)
    assert [one for one in find_slips(text) if hint in one]
    assert not list(find_slips(f'<robot name="r">{ARM}</robot>'))


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        ("int32 x\nint32 y z", "line 2: 'z' is not a value of the type int32."),
        ("int8 MOST=300", "line 1: '300' is not a value of the type int8."),
        ("uint8 x -1", "line 1: '-1' is not a value of the type uint8."),
        ("bool x maybe", "line 1: 'maybe' is not a value of the type bool."),
        ("float64 x 1,5", "line 1: '1,5' is not a value of the type float64."),
        ("# a\nint32 x\nint32 x", "line 3: the field 'x' is already defined above."),
        ("int32 A=1\nint32 A=2", "line 2: the constant 'A' is already defined above."),
        ("int32[-1] x", "line 1: a size in 'int32[-1]' is less than 1. For an array of any"),
        ("string<=0 x", "line 1: a size in 'string<=0' is less than 1."),
        ("int32 class", "line 1: 'class' is a keyword of Python"),
        ("\nint3 x", "line 2, field x: No message type"),
    ],
)
def test_interface_file_error_includes_the_line(write: Write, message: str, expected: str) -> None:
    write("wrong_msgs/msg/A.msg", f"{message}\n")
    write("p.py", "from wrong_msgs.msg import A\n")
    output = errors_of("run", "p.py")
    assert f"wrong_msgs/msg/A.msg, {expected}" in output
    assert "importlib" not in output
    assert "course_lib/" not in output


def test_message_that_contains_itself_is_rejected(write: Write) -> None:
    write("wrong_msgs/msg/A.msg", "B[] inner\n")
    write("wrong_msgs/msg/B.msg", "A[] outer\n")
    write("p.py", "from wrong_msgs.msg import A\n")
    output = errors_of("run", "p.py")
    assert "wrong_msgs/msg/A.msg: wrong_msgs/msg/A contains itself, so no message" in output
    assert "course_lib/" not in output


def test_valid_constants_and_defaults_of_interface_files_are_accepted(write: Write) -> None:
    constants = "int8 LOWEST=-128\nuint64 MOST=18446744073709551615\nfloat32 HALF=5e-1\nbool YES=True\n"
    fields = 'string WORD=class\nbool flag true\nint32 x 08\nfloat64[] many [1, 2]\nstring s "a"\n'
    write("right_values_msgs/msg/A.msg", constants + fields)
    write("p.py", "from right_values_msgs.msg import A\nprint(A.LOWEST, A().flag, list(A().many))\n")
    process = run_course("run", "p.py")
    assert (process.stdout, process.stderr) == ("-128 True [1.0, 2.0]\n", "")


@pytest.mark.parametrize(
    ("manifest", "setup", "expected"),
    [
        ("<package><name>arm<", "", "arm/package.xml: not XML: "),
        ("", "", "arm/package.xml: not XML: no element found: line 1"),
        (
            "<package>\n<name>my arm</name></package>",
            "",
            "arm/package.xml, line 2: expected the element <name>arm<",
        ),
        ("", "'go = arm.go'", "setup.py, line 3: 'go = arm.go' is not of the form 'NAME = MODULE:FUNCTION'."),
        ("", "'go = arm.go:a'\n    'no = arm.go:b'", "Is a comma missing between two entries?"),
        ("", "'go = arm.gone:main'", "setup.py line 3: there is no module arm.gone in "),
        (
            "",
            "'go = arm.go:mian'",
            "setup.py line 3: the module arm.go has no function 'mian'. Did you mean main?",
        ),
        ("", "'go = arm.wrong:main'", 'wrong.py", line 1'),
    ],
)
def test_package_error_includes_its_file(write: Write, manifest: str, setup: str, expected: str) -> None:
    manifest = "<package><name>arm</name></package>" if setup else manifest
    write("src/arm/package.xml", manifest)
    write("src/arm/setup.py", SETUP % setup)
    write("src/arm/arm/__init__.py", "")
    write("src/arm/arm/go.py", "def main():\n    pass\n")
    write("src/arm/arm/wrong.py", "def main(:\n")
    output = errors_of("ros2", "run", "arm", "go")
    assert expected in output
    assert not re.search(r"course_lib/|importlib|Traceback", output)


@pytest.mark.parametrize(
    ("action", "expected"),
    [
        ("'talker'", r"expected an action such as Node\(…\), not 'talker' \(l\.launch\.py, line 5: "),
        (
            "DeclareLaunchArgument('a', choices=['x'], default_value='z')",
            r'"z" is not in .*l\.launch\.py, line 6: ',
        ),
        (
            "SetEnvironmentVariable('a', 3)",
            r"expected a string or a substitution, not 3; write it in quotes, '3' \(l\.launch\.py, line 6",
        ),
        ("Node(package='a', executable='b', remappings=['ab'])", r"remappings=\['ab'\], expected pairs: "),
        ("Node('a', 'b')", r"hint: Node takes the last values by name"),
    ],
)
def test_launch_file_error_includes_the_line(write: Write, action: str, expected: str) -> None:
    imports = "from launch import *\nfrom launch.actions import *\nfrom launch_ros.actions import Node\n"
    describe = (
        f"def generate_launch_description():\n    return LaunchDescription([\n        {action}\n    ])\n"
    )
    write("l.launch.py", imports + describe)
    output = errors_of("run", "l.launch.py", "--seconds", "1")
    assert re.search(expected, output)
    assert "course_lib/" not in output


@pytest.mark.parametrize("file", ["a.urdf", "a.rviz", "a.yaml", "a.stl", "my_msgs/msg/A.msg", "setup.py"])
def test_huge_file_is_rejected_before_it_is_read(write: Write, file: str) -> None:
    path = write(file, "")
    with path.open("wb") as stream:
        stream.truncate(2**40)
    read: dict[str, Callable[[], object]] = {
        ".urdf": lambda: load_robot(path),
        ".rviz": lambda: read_layout(path),
        ".yaml": lambda: read_map(path),
        ".stl": lambda: load_mesh(path),
        ".msg": lambda: add_package(path.parents[1]),
        ".py": lambda: executables_of(path),
    }
    with pytest.raises(CourseError, match="File too large"):
        read[path.suffix]()


@pytest.mark.parametrize("link", ["setup.py", "setup.cfg", "CMakeLists.txt"])
def test_build_file_that_is_a_circular_link_is_ignored(write: Write, link: str) -> None:
    folder = write("robot/package.xml", "<package><name>robot</name></package>").parent
    (folder / link).symlink_to(link)
    assert not read_build_files("robot", folder).executables


def test_setup_py_with_a_byte_order_mark_is_read(write: Write) -> None:
    text = "\ufeff" + SETUP % "'talker = robot.talker:main'"
    assert executables_of(write("setup.py", text)) == {"talker": ("robot.talker", "main")}


def test_interface_file_that_is_not_text_is_reported(write: Write) -> None:
    path = write("my_msgs/msg/A.msg", "")
    path.write_bytes("float64 x".encode("utf-16"))
    with pytest.raises(CourseError, match=r"A\.msg cannot be read as a text file in UTF-8"):
        add_package(path.parents[1])


def test_mesh_with_vertices_of_two_coordinates_is_reported(write: Write) -> None:
    with pytest.raises(CourseError, match=r"m\.obj: This is not a readable OBJ file"):
        load_mesh(write("m.obj", "v 0 0\nv 1 0\nv 1 1\nf 1 2 3\n"))


def test_deeply_nested_map_is_reported(write: Write) -> None:
    with pytest.raises(CourseError, match="not YAML: it is nested too deeply"):
        read_map(write("m.yaml", "[" * 2000))


@pytest.mark.parametrize("name", ["node.py", "robot.launch.py"])
def test_program_with_null_bytes_is_reported_with_its_line(write: Write, name: str) -> None:
    path = write(name, "x = 1\n")
    path.write_bytes(b"x = 1\ny = '\0'\n")
    assert f"{name}, line 2: it contains null bytes: save it as text in UTF-8." in errors_of("run", str(path))


@pytest.mark.parametrize("words", [("run",), ("check",)])
def test_notebook_that_is_a_circular_link_is_reported_in_one_line(write: Write, words: tuple[str]) -> None:
    path = write("package.xml", "").with_name("week01_exercise.ipynb")
    path.symlink_to(path)
    errors = errors_of(*words, str(path))
    assert "Too many levels of symbolic links" in errors
    assert len(errors.splitlines()) == 1
