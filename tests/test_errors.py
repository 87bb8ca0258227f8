import pytest

from course_lib.errors import counted, did_you_mean


@pytest.mark.parametrize(
    ("name", "text"),
    [("/chater", ". Did you mean /chatter?"), ("lst", ". Did you mean list?"), ("xyz", ""), ("", "")],
)
def test_the_nearest_name_goes_on_behind_a_text(name: str, text: str) -> None:
    assert did_you_mean(name, iter(["/chatter", "list", "/rosout"])) == text


def test_as_many_near_names_are_given_as_are_wanted() -> None:
    assert did_you_mean("arm", ["arm_1", "arm_2", "leg"], most=3) == ". Did you mean arm_2 or arm_1?"


def test_one_is_counted_without_an_s() -> None:
    assert [counted(n, "node") for n in (0, 1, 2)] == ["0 nodes", "1 node", "2 nodes"]
