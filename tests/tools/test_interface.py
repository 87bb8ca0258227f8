from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.messages.definitions import interfaces, type_names, typestore
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import RecordingSource


def output(line: str) -> str:
    output: list[str] = []
    ros2(["interface", *line.split()], RecordingSource(Recording(())), output.append)
    return "".join(output)


def test_show_indents_nested_types_with_tabs() -> None:
    assert output("show geometry_msgs/msg/PoseStamped") == (
        "std_msgs/Header header\n\tbuiltin_interfaces/Time stamp\n\t\tint32 sec\n\t\tuint32 nanosec\n"
        "\tstring frame_id\nPose pose\n\tPoint position\n\t\tfloat64 x\n\t\tfloat64 y\n\t\tfloat64 z\n"
        "\tQuaternion orientation\n\t\tfloat64 x 0\n\t\tfloat64 y 0\n\t\tfloat64 z 0\n\t\tfloat64 w 1\n"
    )


def test_show_includes_constants_and_arrays() -> None:
    text = output("show diagnostic_msgs/msg/DiagnosticStatus")
    assert text.startswith("byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\n")
    assert text.endswith("KeyValue[] values\n\tstring key\n\tstring value\n")
    assert output("show std_msgs/msg/Empty") == ""
    assert "float64[36] covariance\n" in output("show geometry_msgs/msg/PoseWithCovariance")


def test_show_of_a_service_prints_request_and_response() -> None:
    assert output("show std_srvs/srv/SetBool --no-comments") == (
        "bool data\n---\nbool success\nstring message\n"
    )


@pytest.mark.slow
@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", ["msg", "srv", "action"])
def test_every_type_can_be_shown_and_has_a_prototype(kind: str) -> None:
    for name in interfaces(kind):
        dividers = output(f"show {name}").splitlines().count("---")
        assert dividers == {"msg": 0, "srv": 1, "action": 2}[kind], name
        assert output(f"proto {name}").startswith('"')


def test_show_includes_the_comments_of_the_interface_file(monkeypatch: pytest.MonkeyPatch) -> None:
    text = "# Adds.\n\nint64 a  # one\nint64 b\n---\nint64 sum\nstd_msgs/Header header # when\n"
    name = "example_interfaces/srv/AddTwoInts"
    monkeypatch.setattr("course_lib.tools.entities.kit_files", lambda: {f"{name}.srv": text})
    lines = output(f"show {name}").splitlines()
    assert [line for line in lines if not line.startswith("\t")] == text.splitlines()
    assert output(f"show {name} --no-comments").splitlines()[:5] == [
        "int64 a", "int64 b", "---", "int64 sum", "std_msgs/Header header",
    ]  # fmt: skip


def test_list_package_and_packages_agree() -> None:
    lines = output("list").splitlines()
    assert [line for line in lines if not line.startswith("    ")] == ["Messages:", "Services:", "Actions:"]
    assert {line.strip() for line in output("list -m").splitlines()[1:]} == set(interfaces("msg"))
    packages = output("packages").splitlines()
    names = [name for package in packages for name in output(f"package {package}").splitlines()]
    assert sorted(names) == sorted(line.strip() for line in lines if line.startswith("    "))
    assert output("packages -s").splitlines() == sorted({name.split("/")[0] for name in interfaces("srv")})
    assert set(interfaces("msg")) <= set(type_names())


@pytest.mark.parametrize("kind", ["msg", "srv", "action"])
def test_names_of_a_kind_are_sorted_without_the_suffixes_of_their_parts(kind: str) -> None:
    assert interfaces(kind) == sorted(interfaces(kind))
    assert "moveit_msgs/action/MoveGroup" in interfaces("action")


def test_proto_is_quoted_yaml() -> None:
    assert output("proto std_srvs/srv/SetBool") == '"data: false\n"\n'
    assert output("proto std_msgs/msg/String --no-quotes") == "data: ''\n\n"


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("show std_msgs/String", r"^Invalid name 'std_msgs/String'\. Expected three parts separated by '/'\."
         r" Did you mean std_msgs/msg/String\?$"),
        ("show std_msgs/msg/Strng", r"^Could not find the interface 'std_msgs/msg/Strng'\. Did you mean "),
        ("show std_msg/msg/String", r"^Unknown package 'std_msg'\. Did you mean std_msgs\?$"),
        ("package sensor_msg", r"^Unknown package 'sensor_msg'\. Did you mean sensor_msgs\?$"),
        ("proto nav_msgs/srv/GetPath", r"^Could not find the interface 'nav_msgs/srv/GetPath'\. Did you"),
    ],
)  # fmt: skip
def test_unknown_type_error_suggests_the_closest(line: str, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        output(line)


def test_custom_package_is_shown_with_its_comments(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "own_shown_msgs/srv"
    folder.mkdir(parents=True)
    (folder / "Drive.srv").write_text("float64 speed  # [m/s]\n---\nbool done\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert output("show own_shown_msgs/srv/Drive") == "float64 speed  # [m/s]\n---\nbool done\n"
    assert output("package own_shown_msgs") == "own_shown_msgs/srv/Drive\n"
    for name in [name for name in typestore().fielddefs if name.startswith("own_shown_msgs")]:
        del typestore().fielddefs[name]


def test_show_prints_an_idl_file_as_a_msg_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "shown_idl_msgs" / "msg" / "Report.idl"
    file.parent.mkdir(parents=True)
    fields = '@default (value="(1, 2)") sequence<long, 3> steps; string<5> name; std_msgs::msg::Empty one;'
    constants = "module Report_Constants { const octet FAST = 1; };"
    structs = f"{constants} struct Report {{ @default (value=TRUE) boolean is_free; {fields} }};"
    file.write_text(f"module shown_idl_msgs {{ module msg {{ {structs} }}; }};")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert output("show shown_idl_msgs/msg/Report").splitlines() == [
        "byte FAST=1",
        "bool is_free true",
        "int32[<=3] steps [1, 2]",
        "string<=5 name",
        "std_msgs/Empty one",
    ]
    for name in [name for name in type_names() if name.startswith("shown_idl_msgs")]:
        del typestore().fielddefs[name]
