"""`%ros2 … | … > …`."""

import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.tools.notebook import run_pipeline, split
from course_lib.tools.verb import Write

TOPICS = "/camera/image\n/chatter\n/perception/boxes\n/rosout\n"
needs_tools = pytest.mark.skipif(shutil.which("grep") is None, reason="this machine has no grep")


def output(line: str) -> str:
    def ros2(words: Sequence[str], write: Write) -> None:
        if list(words) == ["topic", "type", "/chatter"]:
            write("std_msgs/msg/String\n")
        elif words[0] == "interface":
            write(f"shows {words[2]}\n")
        else:
            for one in TOPICS.splitlines(keepends=True):
                write(one)

    output: list[str] = []
    run_pipeline(line, ros2, output.append)
    return "".join(output)


@needs_tools
@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("topic list", TOPICS),
        ('topic list | grep -E "(camera|image|perception|detection)"', "/camera/image\n/perception/boxes\n"),
        ("topic list | wc -l", "4\n"),
        ("topic list|head -n 1", "/camera/image\n"),
        ("topic list | sort -r | uniq | head -2 | tail -n 1", "/perception/boxes\n"),
        ("topic list | grep '|'", ""),
        ("topic list 2>&1 | wc -l", "4\n"),
        ("topic list 2> /dev/null | grep -v '2>&1; &' | wc -l 2>/dev/null", "4\n"),
        ("topic list | grep nothing | wc -l", "0\n"),
        ("topic type /chatter | ros2 interface show -", "shows std_msgs/msg/String\n"),
        ("topic type /chatter | ros2 interface show - | wc -w", "2\n"),
    ],
)
def test_output_is_piped_to_shell_commands(line: str, text: str) -> None:
    assert [row.strip() for row in output(line).splitlines()] == text.splitlines()


@pytest.mark.parametrize(
    ("line", "sign"),
    [("topic list && echo hi", "&&"), ("topic list; echo hi", ";"), ("topic echo /a > b.txt &", "&")],
)
def test_unsupported_shell_syntax_is_reported_and_writes_no_file(
    line: str, sign: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CourseError, match=f"^A line holds one command, without {sign}. Write each command"):
        output(line)
    assert list(tmp_path.iterdir()) == []


def test_output_redirection_writes_or_appends_to_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert output("topic list > a.txt") == ""
    assert output("topic type /chatter >> a.txt") == ""
    assert Path("a.txt").read_text() == TOPICS + "std_msgs/msg/String\n"


@needs_tools
def test_shell_tool_that_exits_early_ends_an_endless_command() -> None:
    def ros2(words: Sequence[str], write: Write) -> None:
        while True:
            write("again\n" * 1000)

    output: list[str] = []
    run_pipeline("topic echo /x | head -n 2", ros2, output.append)
    assert "".join(output) == "again\nagain\n"


@needs_tools
def test_command_error_is_reported_and_no_shell_tool_is_left_running() -> None:
    def ros2(words: Sequence[str], write: Write) -> None:
        raise CourseError("Unknown topic '/x'")

    with pytest.raises(CourseError, match="Unknown topic"):
        run_pipeline("topic info /x | cat", ros2, print)


@needs_tools
def test_output_is_unfiltered_where_subprocesses_are_forbidden(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr("subprocess.Popen", refuse)
    assert output("topic list | wc -l | cat") == (
        f"Programs cannot be started here. The input of wc would be:\n{TOPICS}"
    )


def test_output_is_unfiltered_without_shell_programs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    assert output("topic list | wc -l").startswith("Programs cannot be started here")


@pytest.mark.parametrize(
    ("line", "text"),
    [
        (
            "topic list | nosuchtool -x",
            r"^There is no program nosuchtool on this machine: leave out ",
        ),
        ("topic list |", r"^A command or a file is missing next to \|: ros2 topic list \|$"),
        ("| wc", "A command or a file is missing"),
        (
            "topic list > a b",
            r"^Redirect to one file, at the end: ros2 topic list > topics\.txt, not: ",
        ),
        ("topic list > a | wc", r"^Redirect to one file, at the end: "),
    ],
)
def test_invalid_pipelines_are_reported(line: str, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        output(line)


def test_quotes_and_braces_are_unchanged() -> None:
    commands, target = split("""topic pub /a std_msgs/msg/String '{data: "a|b > c"}' | grep \\| """)
    assert commands == [["topic", "pub", "/a", "std_msgs/msg/String", '{data: "a|b > c"}'], ["grep", "|"]]
    assert target is None
    with pytest.raises(ValueError, match="No closing quotation"):
        split('topic echo "/a')
