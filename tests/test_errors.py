import pickle
from pathlib import Path

import pytest

from course_lib import load_robot
from course_lib.errors import CourseError, did_you_mean, format_count


@pytest.mark.parametrize(
    ("name", "text"),
    [("/chater", ". Did you mean /chatter?"), ("lst", ". Did you mean list?"), ("xyz", ""), ("", "")],
)
def test_closest_name_is_appended_to_a_message(name: str, text: str) -> None:
    assert did_you_mean(name, iter(["/chatter", "list", "/rosout"])) == text


def test_requested_number_of_close_names_is_suggested() -> None:
    assert did_you_mean("arm", ["arm_1", "arm_2", "leg"], max_count=3) == ". Did you mean arm_2 or arm_1?"


def test_count_of_one_uses_the_singular() -> None:
    assert [format_count(n, "node") for n in (0, 1, 2)] == ["0 nodes", "1 node", "2 nodes"]


def test_long_quoted_values_of_an_error_are_shortened() -> None:
    value = "0 0 1.5 " * 100
    text = str(CourseError(f"origin: {value!r}, expected three numbers, as in '0 0 1'. Don't use 'a'"))
    assert len(text) < 250
    assert text.startswith("origin: '0 0 1.5 0 0")
    assert text.endswith("', expected three numbers, as in '0 0 1'. Don't use 'a'")


def test_long_text_between_two_quoted_values_is_unchanged() -> None:
    text = f"expected 'a', {'or another word ' * 30}or the student's 'b'"
    assert str(CourseError(text)) == text


def test_long_words_of_an_error_are_shortened() -> None:
    path = "/home/student/" + "/".join(["a_long_name_of_a_folder"] * 12)
    error = CourseError(f"{path}: {'9' * 10_000} is not a valid float")
    assert str(error) == f"{path}: {'9' * 80}…{'9' * 20} is not a valid float"
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


JOINT = (
    '<robot name="a"><link name="b"/><link name="c"/><joint name="j" type="revolute"><parent link="b"/>'
    '<child link="c"/><limit lower="{}" upper="1" effort="1" velocity="1"/></joint></robot>'
)
SHAPE = '<robot name="a"><link name="b"><visual><geometry>{}</geometry></visual></link></robot>'
XACRO = '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="b"/>{}</robot>'


@pytest.mark.parametrize(
    "text",
    [
        JOINT,
        SHAPE.format('<mesh filename="package://{}/a.stl"/>'),
        XACRO.format('<xacro:if value="{}"/>'),
        XACRO.format('<xacro:include filename="$(find {})/a.xacro"/>'),
    ],
)
def test_malformed_long_value_of_a_robot_description_is_quoted_in_part(text: str, tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(text.format("x" * 10_000))
    with pytest.raises(CourseError, match="xxx…xxx") as refusal:
        load_robot(tmp_path / "a.urdf")
    assert len(str(refusal.value)) < 1500 + 5 * len(str(tmp_path))


def test_warning_about_a_long_value_is_shortened(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.urdf").write_text(SHAPE.format(f'<sphere radius="{"x" * 10_000}"/>'))
    load_robot(tmp_path / "a.urdf")
    assert "xxx…xxx" in (warning := capsys.readouterr().err)
    assert len(warning) < 400
