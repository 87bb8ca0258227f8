import os
from pathlib import Path
from typing import Any, ClassVar

import pytest
import yaml
from launch import Action, LaunchContext, Substitution
from launch.actions import (
    AppendEnvironmentVariable,
    PopEnvironment,
    PopLaunchConfigurations,
    PushEnvironment,
    PushLaunchConfigurations,
    ResetEnvironment,
    ResetLaunchConfigurations,
    UnsetEnvironmentVariable,
    UnsetLaunchConfiguration,
)
from launch.conditions import IfCondition, LaunchConfigurationEquals, LaunchConfigurationNotEquals
from launch.entities import SomeSubstitutionsType as Some
from launch.entities import SubstitutionFailure, text_of
from launch.frontend import expose_substitution, grammar, parse_substitution
from launch.substitutions import (
    AllSubstitution,
    AndSubstitution,
    AnonName,
    AnySubstitution,
    Command,
    EnvironmentVariable,
    EqualsSubstitution,
    FileContent,
    FindExecutable,
    IfElseSubstitution,
    LaunchConfiguration,
    NotEqualsSubstitution,
    NotSubstitution,
    OrSubstitution,
    PathJoinSubstitution,
    PythonExpression,
    TextSubstitution,
)
from launch.utilities import (
    ensure_argument_type,
    normalize_to_list_of_substitutions,
    perform_substitutions,
)
from launch_ros.actions import SetParameter
from launch_ros.substitutions import Parameter
from nav2_common.launch import HasNodeParams, ReplaceString, RewrittenYaml


@pytest.fixture
def context() -> LaunchContext:
    context = LaunchContext()
    context.launch_configurations |= {"use": "False", "n": "3"}
    return context


def test_each_substitution_returns_its_string(
    context: LaunchContext, monkeypatch: pytest.MonkeyPatch
) -> None:
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
def test_substitution_of_an_undefined_value_is_a_failure(
    context: LaunchContext, substitution: LaunchConfiguration | Command
) -> None:
    with pytest.raises(SubstitutionFailure):
        substitution.perform(context)


def test_replace_string_returns_a_copy_with_replaced_strings(context: LaunchContext, tmp_path: Path) -> None:
    source = tmp_path / "layout.rviz"
    source.write_text("Topic: <robot_namespace>/scan")
    copy = ReplaceString(str(source), {"<robot_namespace>": ("/", LaunchConfiguration("n"))}).perform(context)
    assert (Path(copy).read_text(), Path(copy).suffix) == ("Topic: /3/scan", ".rviz")
    assert source.read_text() == "Topic: <robot_namespace>/scan"
    Path(copy).unlink()


def test_concatenated_substitutions_form_one_string(context: LaunchContext) -> None:
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
def test_launch_argument_value_is_usable_as_a_condition(
    context: LaunchContext, name: str, expected: Any, equal: bool
) -> None:
    assert LaunchConfigurationEquals(name, expected).evaluate(context) is equal
    assert LaunchConfigurationNotEquals(name, expected).evaluate(context) is not equal


V = LaunchConfiguration


@pytest.mark.parametrize(
    ("substitution", "text"),
    [
        (NotSubstitution(V("use")), "true"),
        (AndSubstitution("yes", "1"), "true"),
        (AndSubstitution("on", V("use")), "false"),
        (OrSubstitution("0", V("use")), "false"),
        (AnySubstitution("off", "true", "0"), "true"),
        (AllSubstitution("true", "1", "no"), "false"),
        (EqualsSubstitution("1", "TRUE"), "true"),
        (EqualsSubstitution(V("n"), 3.0), "true"),
        (EqualsSubstitution("0.1", 0.1 + 1e-12), "true"),
        (EqualsSubstitution(None, ""), "true"),
        (EqualsSubstitution(["a", V("n")], "a3"), "true"),
        (EqualsSubstitution("a", "A"), "false"),
        (NotEqualsSubstitution(V("n"), "4"), "true"),
        (IfElseSubstitution(V("use"), "a", ["b", V("n")]), "b3"),
        (IfElseSubstitution("true", if_value="a"), "a"),
        (PythonExpression(["platform.system() != ''"], ["platform"]), "True"),
        (Parameter("p"), "5"),
        (Parameter("q", default="none"), "none"),
    ],
)
def test_boolean_choice_and_parameter_substitutions_return_strings(
    context: LaunchContext, substitution: Substitution, text: str
) -> None:
    SetParameter("p", 5).visit(context)
    assert substitution.perform(context) == text


@pytest.mark.parametrize("substitution", [NotSubstitution("maybe"), IfElseSubstitution("2"), Parameter("q")])
def test_substitution_of_a_non_boolean_or_undefined_parameter_is_a_failure(
    context: LaunchContext, substitution: Substitution
) -> None:
    with pytest.raises(SubstitutionFailure):
        substitution.perform(context)


def test_empty_environment_variable_does_not_use_its_default(
    context: LaunchContext, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOT", "")
    assert EnvironmentVariable("ROBOT", default_value="none").perform(context) == ""


def test_file_content_and_anonymous_name_substitutions_return_strings(
    context: LaunchContext, tmp_path: Path
) -> None:
    (tmp_path / "robot.urdf").write_text("<robot/>")
    assert FileContent([str(tmp_path), "/robot.urdf"]).perform(context) == "<robot/>"
    with pytest.raises(SubstitutionFailure, match="File not found"):
        FileContent("nowhere").perform(context)
    name = AnonName("cam.era").perform(context)
    assert name.startswith("cam_era_")
    assert AnonName("cam.era").perform(context) == name
    assert AnonName("cam.era").perform(LaunchContext()) != name


@pytest.mark.parametrize(
    ("on_stderr", "expected"), [("ignore", "out\n"), ("warn", "out\n"), ("capture", "out\nerr\n")]
)
def test_standard_error_of_a_command_is_ignored_shown_or_captured(
    context: LaunchContext, on_stderr: str, expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    command = Command(["sh -c 'echo out; echo err >&2'"], on_stderr=on_stderr)
    assert command.perform(context) == expected
    assert ("showed stderr output" in capsys.readouterr().out) == (on_stderr == "warn")


def test_environment_and_arguments_are_changed_pushed_and_restored(
    context: LaunchContext, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("A_PATH", "b")
    monkeypatch.delenv("OTHER", raising=False)
    context.environment_at_start = dict(os.environ)
    for action in (
        PushEnvironment(),
        PushLaunchConfigurations(),
        AppendEnvironmentVariable("A_PATH", "c"),
        AppendEnvironmentVariable("A_PATH", "a", prepend=True, separator=";"),
        AppendEnvironmentVariable("OTHER", "x"),
        UnsetLaunchConfiguration("n"),
    ):
        action.visit(context)
    assert (os.environ["A_PATH"], os.environ["OTHER"], "n" in context.launch_configurations) == (
        f"a;b{os.pathsep}c", "x", False)  # fmt: skip
    ResetEnvironment().visit(context)
    ResetLaunchConfigurations({"kept": ["use is ", V("use")]}).visit(context)
    assert (os.environ["A_PATH"], context.launch_configurations) == ("b", {"kept": "use is False"})
    UnsetEnvironmentVariable("A_PATH").visit(context)
    PopLaunchConfigurations().visit(context)
    PopEnvironment().visit(context)
    assert (os.environ["A_PATH"], context.launch_configurations) == ("b", {"use": "False", "n": "3"})
    with pytest.raises(RuntimeError, match="no environment to bring back"):
        PopEnvironment().visit(context)


class Shout(Substitution):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.text = text

    @classmethod
    def parse(cls, data: list[list[Substitution]]) -> tuple[type["Shout"], dict[str, Any]]:
        (text,) = data
        return cls, {"text": perform_substitutions(LaunchContext(), text)}

    def perform(self, context: LaunchContext) -> str:
        return f"{self.text}!"


class Note(Action):
    notes: ClassVar[list[str]] = []

    def __init__(self, text: Substitution, **options: Any) -> None:
        super().__init__(**options)
        self.text = normalize_to_list_of_substitutions(text)

    def execute(self, context: LaunchContext) -> None:
        self.notes.append(perform_substitutions(context, self.text))


def test_custom_actions_and_substitutions_are_executed(context: LaunchContext) -> None:
    Note(Shout("a"), condition=IfCondition("true")).visit(context)
    Note(Shout("b"), condition=IfCondition("false")).visit(context)
    assert Note.notes == ["a!"]


@pytest.mark.parametrize("exposed", [Shout, Shout.parse])
def test_exposed_substitutions_are_read_in_launch_files(
    context: LaunchContext, monkeypatch: pytest.MonkeyPatch, exposed: Any
) -> None:
    # As moveit_configs_utils exposes its substitution xacro. The end of the test removes it again.
    monkeypatch.setitem(grammar.SUBSTITUTIONS, "shout", grammar.Form(Shout))
    assert expose_substitution("shout")(exposed) is exposed
    assert perform_substitutions(context, parse_substitution("$(shout a) $(shout 'b c')")) == "a! b c!"


NAV = "amcl:\n  ros__parameters:\n    rate: 5.0\n    names: [a, b]\n    deep: {rate: 1}\nother: {x: 1}\n"


def test_yaml_is_rewritten_as_in_nav2(context: LaunchContext, tmp_path: Path) -> None:
    (tmp_path / "nav.yaml").write_text(NAV)
    rewrites: dict[str, Some] = {
        "rate": V("n"),
        "amcl.ros__parameters.deep.rate": "2.5",
        "amcl.ros__parameters.added.more": "true",
        "amcl.ros__parameters.names.1": "c",
        "nowhere": "1",
    }
    file = RewrittenYaml(str(tmp_path / "nav.yaml"), rewrites, root_key=V("use"),
                         key_rewrites={"other": "another"}, convert_types=True)  # fmt: skip
    assert yaml.safe_load(Path(file.perform(context)).read_text()) == {
        "False": {
            "amcl": {
                "ros__parameters": {
                    "rate": 3, "names": ["a", "c"], "deep": {"rate": 2.5}, "added": {"more": True}
                }
            },
            "another": {"x": 1},
        }
    }  # fmt: skip
    others = RewrittenYaml(str(tmp_path / "nav.yaml"), {}, value_rewrites={"a": "7"}, convert_types=True)
    assert (
        yaml.safe_load(Path(others.perform(context)).read_text())["amcl"]["ros__parameters"]["names"][0] == 7
    )
    plain = RewrittenYaml(str(tmp_path / "nav.yaml"), {"x": "2"}).perform(context)
    assert yaml.safe_load(Path(plain).read_text())["other"] == {"x": "2"}
    assert [HasNodeParams(str(tmp_path / "nav.yaml"), node).perform(context) for node in ("amcl", "x")] == [
        "True",
        "False",
    ]


def test_argument_of_another_type_is_rejected_with_the_text_of_ros() -> None:
    ensure_argument_type("a", str, "name")
    ensure_argument_type(True, (str, int), "name")
    with pytest.raises(TypeError) as caught:
        ensure_argument_type(1.5, [str, int], "name", "Box")
    assert str(caught.value) == (
        "'Box' expected 'name' to be one of [<class 'str'>, <class 'int'>], but got '1.5' of type "
        "'<class 'float'>'"
    )
    with pytest.raises(TypeError, match=r"^Expected 'name' to be one of \[<class 'str'>\], but got '1'"):
        ensure_argument_type(1, str, "name")
