"""`%ros2 … | … > …`."""

import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.tools.pipes import run_piped, split
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

    written: list[str] = []
    run_piped(line, ros2, written.append)
    return "".join(written)


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
def test_the_machine_s_tools_see_what_ros2_prints(line: str, text: str) -> None:
    assert [row.strip() for row in output(line).splitlines()] == text.splitlines()


@pytest.mark.parametrize(
    ("line", "sign"),
    [("topic list && echo hi", "&&"), ("topic list; echo hi", ";"), ("topic echo /a > b.txt &", "&")],
)
def test_a_shells_signs_are_named_and_write_no_file(
    line: str, sign: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CourseError, match=f"^A line is one command, without {sign}: write each in a line"):
        output(line)
    assert list(tmp_path.iterdir()) == []


def test_an_arrow_writes_a_file_and_two_add_to_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert output("topic list > a.txt") == ""
    assert output("topic type /chatter >> a.txt") == ""
    assert Path("a.txt").read_text() == TOPICS + "std_msgs/msg/String\n"


@needs_tools
def test_a_tool_that_has_enough_ends_an_endless_one() -> None:
    def ros2(words: Sequence[str], write: Write) -> None:
        while True:
            write("again\n" * 1000)

    written: list[str] = []
    run_piped("topic echo /x | head -n 2", ros2, written.append)
    assert "".join(written) == "again\nagain\n"


@needs_tools
def test_an_error_of_the_command_is_the_error_and_no_tool_is_left_behind() -> None:
    def ros2(words: Sequence[str], write: Write) -> None:
        raise CourseError("Unknown topic '/x'")

    with pytest.raises(CourseError, match="Unknown topic"):
        run_piped("topic info /x | cat", ros2, print)


@needs_tools
def test_where_no_program_may_be_started_the_text_comes_unfiltered(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr("subprocess.Popen", refuse)
    assert output("topic list | wc -l | cat") == (
        f"No program may be started here; this is what wc would be given:\n{TOPICS}"
    )


def test_in_a_root_without_programs_the_text_comes_unfiltered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/nowhere")
    assert output("topic list | wc -l").startswith("No program may be started here")


@pytest.mark.parametrize(
    ("line", "text"),
    [
        (
            "topic list | nosuchtool -x",
            r"^There is no program nosuchtool on this machine: leave out ",
        ),
        ("topic list |", r"^Something is missing beside \|: ros2 topic list \|$"),
        ("| wc", "Something is missing"),
        (
            "topic list > a b",
            r"^Write one file, at the end: ros2 topic list > topics\.txt, not: ",
        ),
        ("topic list > a | wc", r"^Write one file, at the end: "),
    ],
)
def test_lines_that_mean_nothing_are_told(line: str, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        output(line)


def test_quotes_and_braces_are_left_alone() -> None:
    commands, target = split("""topic pub /a std_msgs/msg/String '{data: "a|b > c"}' | grep \\| """)
    assert commands == [["topic", "pub", "/a", "std_msgs/msg/String", '{data: "a|b > c"}'], ["grep", "|"]]
    assert target is None
    with pytest.raises(ValueError, match="No closing quotation"):
        split('topic echo "/a')
