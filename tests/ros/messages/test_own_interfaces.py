"""Custom interfaces of a student, in a package folder next to the program."""

import importlib
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.real.types import types_of
from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.messages.definitions import add_package, type_names, typestore
from tests.warm import run_course

LIMIT = """# Of a joint
uint8 SOFT=0
uint8 HARD=1
uint8 kind 1
string name "a # b"
float64 low -1   # [rad]
float32[] steps [1, 2.5]
bool[2] ends
int32[<=3] counts
geometry_msgs/Point where
Range range
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> Iterator[Path]:
    """Return a new package's folder on Python's path. Its name is unique, because classes stay registered."""
    monkeypatch.syspath_prepend(str(tmp_path))
    package = f"own_{abs(hash(request.node.name))}_msgs"
    yield tmp_path / package
    for name in [name for name in type_names() if name.startswith(package)]:
        del typestore().fielddefs[name]


def write(folder: Path, **files: str) -> None:
    for name, text in files.items():
        path = folder / name.rsplit("_")[1] / name.replace("_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def test_custom_messages_services_and_actions_can_be_imported_and_sent(folder: Path) -> None:
    write(
        folder,
        Limit_msg=LIMIT,
        Range_msg="float64 width",
        Ask_srv="Limit limit\n---\n",
        Go_action="---\n---\nLimit limit",
    )
    limit = importlib.import_module(f"{folder.name}.msg").Limit(counts=[1, 2])
    assert (limit.HARD, limit.kind, limit.name, limit.low) == (1, 1, "a # b", -1.0)
    assert (list(limit.steps), limit.ends) == ([1.0, 2.5], [False, False])
    assert repr(limit.range) == f"{folder.name}.msg.Range(width=0.0)"
    assert deserialize(serialize(limit), type(limit)) == limit
    asked = importlib.import_module(f"{folder.name}.srv").Ask.Request(limit=limit)
    assert deserialize(serialize(asked), type(asked)) == asked
    assert importlib.import_module(f"{folder.name}.action").Go.Feedback(limit=limit).limit is limit


def test_folders_below_msg_are_not_part_of_a_type_name(folder: Path) -> None:
    file = folder / "msg" / "referee" / "Command.msg"
    file.parent.mkdir(parents=True)
    file.write_text("uint8 STOP=2\nuint8 command")
    command = importlib.import_module(f"{folder.name}.msg").Command
    assert (command.STOP, type_names().count(f"{folder.name}/msg/Command")) == (2, 1)


def list_in_cmake(folder: Path, *files: str) -> None:
    names = " ".join(f'"{file}"' for file in files)
    (folder / "CMakeLists.txt").write_text(f"rosidl_generate_interfaces(${{PROJECT_NAME}} {names})\n")


def test_interface_in_another_folder_is_found_if_cmake_lists_it(folder: Path) -> None:
    write(folder, Path_msg="Corner[] corners")
    (folder / "msg_geo").mkdir()
    (folder / "msg_geo" / "Corner.msg").write_text("float64 x")
    list_in_cmake(folder, "msg/Path.msg", "msg_geo/Corner.msg")
    module = importlib.import_module(f"{folder.name}.msg")
    assert module.Path(corners=[module.Corner(x=1.0)]).corners[0].x == 1.0


def test_malformed_interface_that_cmake_does_not_list_is_ignored(folder: Path) -> None:
    write(folder, Range_msg="float64 width")
    (folder / "msg" / "Range_Old.msg").write_text("float64 width")
    with pytest.raises(CourseError, match="Range_Old"):
        add_package(folder)
    list_in_cmake(folder, "msg/Range.msg")
    assert importlib.import_module(f"{folder.name}.msg").Range(width=2.0).width == 2.0


@pytest.mark.parametrize("other", ["cmake/my_msgs-extras.cmake", "launch/bringup.launch", "cfg/Tuning.cfg"])
def test_only_files_in_msg_srv_and_action_are_interfaces(folder: Path, other: str) -> None:
    write(folder, Range_msg="float64 width")
    file = folder / other
    file.parent.mkdir()
    file.write_text("set(a b)")
    assert importlib.import_module(f"{folder.name}.msg").Range(width=2.0).width == 2.0


@pytest.mark.parametrize(
    ("line", "default"),
    [
        ("byte value 50", b"2"),
        ("byte[] value [0, 0x10]", [b"\0", b"\x10"]),
        ("byte[2] value [3, 4]", [b"\3", b"\4"]),
        ("char value 65", 65),
        (r"string value 'Hello\'world!'", "Hello'world!"),
        (r'string value "a \"b\" c"', 'a "b" c'),
        ("string value 1", "1"),
        ("string value no", "no"),
        ("string[] value ['x, y', \"z\", 1]", ["x, y", "z", "1"]),
        ("string[] value []", []),
        ("bool value 1", True),
        ("bool value False", False),
        ("float64 value 1e3", 1000.0),
        ("int16[<=3] value [-1, 2]", [-1, 2]),
    ],
)
def test_default_is_a_value_of_its_type(folder: Path, line: str, default: object) -> None:
    write(folder, Limit_msg=line)
    limit = importlib.import_module(f"{folder.name}.msg").Limit
    value = limit().value
    assert (list(value) if isinstance(default, list) else value) == default
    assert type(value) is type(default) or isinstance(default, list)
    assert deserialize(serialize(limit()), limit) == limit()


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("byte value 256", "'256' is not a value of the type byte"),
        ("string<=2 value 'abc'", "\"'abc'\" is not a value of the type string<=2"),
        ("int32[2] value [1]", r"'\[1\]' is not a value of the type int32\[2\]"),
        ("int32[] value 1", r"'1' is not a value of the type int32\[\]"),
        ("geometry_msgs/Point value 1", "'1' is not a value of the type geometry_msgs/Point"),
    ],
)
def test_default_of_another_type_is_rejected_with_its_line(folder: Path, line: str, error: str) -> None:
    write(folder, Limit_msg=line)
    with pytest.raises(CourseError, match=rf"Limit\.msg, line 1: {error}"):
        add_package(folder)


def test_array_of_int64_is_printed_without_its_dtype_as_in_ros(folder: Path) -> None:
    write(folder, Limit_msg="int64[2] a\nuint64[1] b\nfloat64[1] c")
    limit = importlib.import_module(f"{folder.name}.msg").Limit()
    assert repr(limit).partition(".msg.")[2] == (
        "Limit(a=array([0, 0]), b=array([0], dtype=uint64), c=array([0.]))"
    )


def test_type_from_an_added_package_can_be_looked_up_by_its_name(folder: Path) -> None:
    write(folder, Range_msg="float64 width")
    assert message_class(f"{folder.name}/msg/Range")().width == 0.0  # type: ignore[attr-defined]  # made above


@pytest.mark.slow
def test_program_imports_an_interface_package_in_its_folder(folder: Path) -> None:
    write(folder, Range_msg="float64 width")
    program = folder.parent / "program.py"
    program.write_text(f"from {folder.name}.msg import Range\nprint(Range(width=2.0))")
    process = run_course("run", program)
    assert (process.stdout, process.stderr) == (f"{folder.name}.msg.Range(width=2.0)\n", "")


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"Limit_msg": "float64 low\nfloat64 = 3"}, "Limit.msg, line 2: 'float64 = 3' is neither a field"),
        ({"Limit_msg": "float64"}, "Limit.msg, line 1: 'float64' is neither a field"),
        ({"Limit_msg": "\nfloat64 Low"}, "Limit.msg, line 2: 'Low' is an invalid field name. It should have"),
        (
            {"Limit_msg": "sensor_msgs/Imag image"},
            "field image: No message type 'sensor_msgs/msg/Imag'",
        ),
        ({"Limit_msg": "Rang range"}, "Limit.msg, line 1, field range: No message type"),
        (
            {"limit_msg": "float64 low"},
            "limit.msg: the file name must be a type name like JointLimit, not 'limit'",
        ),
        ({"Ask_srv": "float64 low"}, "Ask.srv: a .srv file has 1 line with --- between its parts, not 0."),
        ({"Go_action": "---\n"}, "Go.action: a .action file has 2 lines with --- between its parts, not 1."),
    ],
)
def test_malformed_interface_file_is_reported_with_its_line(
    folder: Path, files: dict[str, Any], message: str
) -> None:
    write(folder, **files)
    with pytest.raises(CourseError) as raised:
        add_package(folder)
    assert message in str(raised.value)
    assert str(folder) in str(raised.value)


def test_changed_interface_file_requires_a_new_kernel(folder: Path) -> None:
    write(folder, Range_msg="float64 width")
    add_package(folder)
    add_package(folder)  # the same again
    write(folder, Range_msg="float32 width")
    with pytest.raises(CourseError, match="has changed since it was read: restart the kernel"):
        add_package(folder)


@pytest.mark.parametrize("line", ["wstring name", "wstring[3] name", "wstring<=9 name"])
def test_only_using_a_type_with_a_wide_string_is_an_error(folder: Path, line: str) -> None:
    write(
        folder,
        Angle_msg="float64 degrees",
        List_msg="Pair[] pairs",
        Pair_msg="Wide a\nWide b",
        Wide_msg=f"float64 x\n{line}",
        Ask_srv="Wide wide\n---\n",
        Turn_srv="Angle angle\n---\n",
    )
    messages = importlib.import_module(f"{folder.name}.msg")
    services = importlib.import_module(f"{folder.name}.srv")
    assert messages.Angle(degrees=2.0).degrees == services.Turn.Request().angle.degrees + 2.0
    for module, name in ((messages, "Wide"), (messages, "Pair"), (messages, "List"), (services, "Ask")):
        with pytest.raises(CourseError, match=r"Wide\.msg, line 2, field name: the kit has no wide strings"):
            getattr(module, name)
        assert name not in module.__all__
    assert set(types_of(folder.name)) >= {f"{folder.name}/msg/Angle", f"{folder.name}/srv/Turn"}


_IDL = """
#include "geometry_msgs/msg/Point.idl"
// Written by hand.
module PACKAGE {
  module msg {
    typedef double double__3[3];
    module Report_Constants {
      const octet FAST = 1;
      const string NAME = "a" "b";
      const unsigned long MOST = 4;
    };
    @verbatim (language="comment", text="Of a robot (1)")
    struct Report {
      @default (value=TRUE)
      boolean is_free, is_late; /* a comment */
      @unit (value="m")
      double__3 width;
      @default (value="(1, 2)")
      sequence<short, MOST> steps;
      sequence<geometry_msgs::msg::Point> points;
      string<5> name[2];
      unsigned long long countSteps;
    };
  };
};
"""


def write_idl(folder: Path, text: str, kind: str = "msg") -> Path:
    file = folder / kind / "Report.idl"
    file.parent.mkdir(parents=True)
    file.write_text(text.replace("PACKAGE", folder.name))
    return file


def test_types_in_idl_files_are_imported_with_constants_and_defaults(folder: Path) -> None:
    write_idl(folder, _IDL)
    report_class = importlib.import_module(f"{folder.name}.msg").Report
    report = report_class(countSteps=3)
    assert (report.FAST, report.NAME, report.is_free, report.is_late) == (b"\1", "ab", True, True)
    assert (list(report.width), list(report.steps), report.name) == ([0.0] * 3, [1, 2], ["", ""])
    assert report_class.get_fields_and_field_types() == {
        "is_free": "boolean",
        "is_late": "boolean",
        "width": "double[3]",
        "steps": "sequence<int16, 4>",
        "points": "sequence<geometry_msgs/Point>",
        "name": "string<5>[2]",
        "countSteps": "uint64",
    }
    assert deserialize(serialize(report), report_class) == report


def test_services_and_actions_in_idl_files_have_their_parts(folder: Path) -> None:
    module = "module PACKAGE { module KIND { STRUCTS }; };"
    structs = "struct Report_Request { long a; }; struct Report_Response { };"
    write_idl(folder, module.replace("KIND", "srv").replace("STRUCTS", structs), "srv")
    names = ("Goal", "Result", "Feedback")
    structs = " ".join(f"struct Report_{name} {{ float {name.lower()}; }};" for name in names)
    write_idl(folder, module.replace("KIND", "action").replace("STRUCTS", structs), "action")
    request = importlib.import_module(f"{folder.name}.srv").Report.Request(a=2)
    assert deserialize(serialize(request), type(request)) == request
    assert importlib.import_module(f"{folder.name}.action").Report.Feedback(feedback=1.0).feedback == 1.0


def test_idl_file_next_to_the_msg_file_it_was_built_from_is_ignored(folder: Path) -> None:
    write(folder, Report_msg="float64 width")
    (folder / "msg" / "Report.idl").write_text("anything")
    assert importlib.import_module(f"{folder.name}.msg").Report(width=2.0).width == 2.0


@pytest.mark.parametrize(
    ("old", "new", "line", "problem"),
    [
        ("};\n", "", 25, "expected a module, struct, typedef or const, not ''"),
        ("short, MOST", "short, 0", 19, "expected a size above 0, not '0'"),
        ("boolean is", "long double is", 15, "'long double' is not a type that messages can have, like"),
        ("boolean is", "char is", 15, "'char' is not a type that messages can have, like double"),
        ("sequence<short, MOST>", "sequence<sequence<short> >", 19, "sequences of sequences are not"),
        ("name[2]", "name[2][3]", 21, "expected ';', not '['"),
        ("is_late", "import", 15, "'import' is a keyword of Python, so choose another name"),
        ("is_late", "is_free", 15, "the field 'is_free' is already defined above"),
        ('"(1, 2)"', '"(1, x)"', 19, 'expected default values like "(1, 2)"'),
        ('"(1, 2)"', '"(1, 2, 3, 4, 5)"', 19, "expected at most 4 default values, not 5"),
        ("FAST = 1", "FAST = 300", 8, "'300' is not a value of the type uint8"),
        ("typedef", "enum", 6, "expected a module, struct, typedef or const, not 'enum'"),
        ("};\n", "\u00e9", 24, "'\u00e9' is not a character of IDL"),
    ],
)
def test_malformed_idl_file_is_reported_with_its_line(
    folder: Path, old: str, new: str, line: int, problem: str
) -> None:
    file = write_idl(folder, new.join(_IDL.rsplit(old, 1)))
    with pytest.raises(CourseError, match=re.escape(f"{file}, line {line}: {problem}")):
        importlib.import_module(f"{folder.name}.msg")


def test_idl_file_without_the_struct_of_its_name_is_reported(folder: Path) -> None:
    file = write_idl(folder, _IDL.replace("Report", "Other"))
    with pytest.raises(CourseError, match=f"{file} does not define a struct for the type .*/msg/Report"):
        importlib.import_module(f"{folder.name}.msg")
