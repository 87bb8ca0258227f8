import pytest

from course_lib.errors import did_you_mean, format_count


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
