"""Interfaces of a student's own: a package's folder beside the program."""

import importlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.messages.definitions import add_package, type_names, typestore

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
    """Return a new package's folder on Python's path; the name is the test's own, as classes stay known."""
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


def test_all_three_kinds_can_be_imported_and_sent(folder: Path) -> None:
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


def test_a_type_is_found_by_its_name_alone(folder: Path) -> None:
    write(folder, Range_msg="float64 width")
    assert message_class(f"{folder.name}/msg/Range")().width == 0.0  # type: ignore[attr-defined]  # made above


def test_a_program_imports_the_package_beside_it(folder: Path) -> None:
    write(folder, Range_msg="float64 width")
    program = folder.parent / "program.py"
    program.write_text(f"from {folder.name}.msg import Range\nprint(Range(width=2.0))")
    command = [sys.executable, "-m", "course_lib", "run", str(program)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert (done.stdout, done.stderr) == (f"{folder.name}.msg.Range(width=2.0)\n", "")


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"Limit_msg": "float64 low\nfloat64 = 3"}, "Limit.msg, line 2: 'float64 = 3' is neither a field"),
        ({"Limit_msg": "float64"}, "Limit.msg, line 1: 'float64' is neither a field"),
        ({"Limit_msg": "\nfloat64 Low"}, "Limit.msg, line 2: 'Low' is an invalid field name. It should have"),
        (
            {"Limit_msg": "sensor_msgs/Imag image"},
            "field image: No message type 'sensor_msgs/msg/Imag'",
        ),
        ({"Limit_msg": "Rang range"}, "Limit.msg, field range: No message type"),
        ({"Limit_msg": "wstring name"}, "field name: the kit has no wide strings (wstring). Write string:"),
        ({"Limit_msg": "wstring[3] name"}, "field name: the kit has no wide strings"),
        ({"limit_msg": "float64 low"}, "limit.msg: a type's name is written like JointLimit, so 'limit'"),
        ({"Ask_srv": "float64 low"}, "Ask.srv: a .srv file has 2 parts with --- between them, not 1."),
        ({"Go_action": "---\n"}, "Go.action: a .action file has 3 parts with --- between them, not 2."),
    ],
)
def test_a_malformed_file_is_named_with_its_line(folder: Path, files: dict[str, Any], said: str) -> None:
    write(folder, **files)
    with pytest.raises(CourseError) as raised:
        add_package(folder)
    assert said in str(raised.value)
    assert str(folder) in str(raised.value)


def test_a_changed_file_asks_for_a_new_kernel(folder: Path) -> None:
    write(folder, Range_msg="float64 width")
    add_package(folder)
    add_package(folder)  # the same again
    write(folder, Range_msg="float32 width")
    with pytest.raises(CourseError, match="has changed since it was read: restart the kernel"):
        add_package(folder)
