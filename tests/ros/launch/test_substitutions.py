from pathlib import Path
from typing import Any

import pytest
from launch import LaunchContext
from launch.conditions import LaunchConfigurationEquals, LaunchConfigurationNotEquals
from launch.entities import SubstitutionFailure, text_of
from launch.substitutions import (
    Command,
    EnvironmentVariable,
    FindExecutable,
    LaunchConfiguration,
    PathJoinSubstitution,
    PythonExpression,
    TextSubstitution,
)
from nav2_common.launch import ReplaceString


@pytest.fixture
def context() -> LaunchContext:
    context = LaunchContext()
    context.launch_configurations |= {"use": "False", "n": "3"}
    return context


def test_each_gives_its_text(context: LaunchContext, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROBOT", "ur10")
    use = LaunchConfiguration("use")
    for substitution, text in (
        (TextSubstitution(text="a"), "a"),
        (use, "False"),
        (LaunchConfiguration("other", default=2), "2"),
        (LaunchConfiguration(["u", "se"]), "False"),
        (PythonExpression(["not ", use]), "True"),
        (PythonExpression(["int(", LaunchConfiguration("n"), ") * math.pi > 9 and sqrt(4) == 2"]), "True"),
        (PathJoinSubstitution(["/a", ["b", TextSubstitution(text="c")], "d"]), "/a/bc/d"),
        (EnvironmentVariable("ROBOT"), "ur10"),
        (EnvironmentVariable("NO_ROBOT", default_value="none"), "none"),
        (Command([FindExecutable(name="echo"), " -n hi"]), "hi"),
    ):
        assert context.perform_substitution(substitution) == text


@pytest.mark.parametrize(
    "substitution",
    [
        LaunchConfiguration("x"),
        EnvironmentVariable("NO_ROBOT"),
        FindExecutable(name="no-such"),
        Command("false"),
    ],
)
def test_what_is_not_there_is_a_failure(
    context: LaunchContext, substitution: LaunchConfiguration | Command
) -> None:
    with pytest.raises(SubstitutionFailure):
        substitution.perform(context)


def test_replace_string_gives_a_copy_with_the_texts_replaced(context: LaunchContext, tmp_path: Path) -> None:
    source = tmp_path / "layout.rviz"
    source.write_text("Topic: <robot_namespace>/scan")
    copy = ReplaceString(str(source), {"<robot_namespace>": ("/", LaunchConfiguration("n"))}).perform(context)
    assert (Path(copy).read_text(), Path(copy).suffix) == ("Topic: /3/scan", ".rviz")
    assert source.read_text() == "Topic: <robot_namespace>/scan"
    Path(copy).unlink()


def test_joined_parts_are_one_text(context: LaunchContext) -> None:
    assert text_of(context, ["a", TextSubstitution(text="b"), Path("c")]) == "abc"


@pytest.mark.parametrize(
    ("name", "expected", "equal"),
    [
        ("n", "3", True),
        ("n", [LaunchConfiguration("n")], True),
        ("n", "4", False),
        ("n", None, False),
        ("other", "3", False),
        ("other", None, True),
    ],
)
def test_the_value_of_an_argument_is_a_condition(
    context: LaunchContext, name: str, expected: Any, equal: bool
) -> None:
    assert LaunchConfigurationEquals(name, expected).evaluate(context) is equal
    assert LaunchConfigurationNotEquals(name, expected).evaluate(context) is not equal
