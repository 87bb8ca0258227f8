import pytest

from course_lib.tools.hints import did_you_mean


@pytest.mark.parametrize(
    ("name", "text"),
    [("/chater", ". Did you mean /chatter?"), ("lst", ". Did you mean list?"), ("xyz", "."), ("", ".")],
)
def test_the_nearest_name_ends_the_sentence(name: str, text: str) -> None:
    assert did_you_mean(name, iter(["/chatter", "list", "/rosout"])) == text
