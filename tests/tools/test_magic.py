import subprocess
import sys
from pathlib import Path

import pytest
from IPython.core.interactiveshell import InteractiveShell

from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph, use_graph
from course_lib.tools.notebook import register


@pytest.fixture(scope="module")
def shell() -> InteractiveShell:
    shell = InteractiveShell.instance()
    register(shell)
    register(shell)
    return shell


def test_the_magic_is_imported_before_the_standin_is_in_place() -> None:
    subprocess.run([sys.executable, "-c", "import course_lib.tools.notebook"], check=True)


def run(shell: InteractiveShell, line: str) -> bool:
    """Run a cell; says whether it went well."""
    return bool(shell.run_cell(line).success)  # type: ignore[no-untyped-call]  # IPython does not annotate it


def test_the_magic_lists_this_notebook_s_topics(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str]
) -> None:
    with use_graph(Graph()):
        assert run(shell, "%ros2 topic list")
    assert capsys.readouterr().out == "/parameter_events\n/rosout\n"


@pytest.mark.parametrize(
    ("cell", "said"),
    [
        ("%%bash\ncd .\nros2 topic list -v\n", "In a cell write %ros2 topic list -v\n"),
        (
            "%%sh\n  timeout 5 ros2 topic hz /a || true",
            "In a cell write %timeout 5 ros2 topic hz /a || true\n",
        ),
        ("%%bash\necho ros2 is here", ""),
    ],
)
def test_a_cell_of_shell_script_that_calls_ros2_learns_what_to_write(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str], cell: str, said: str
) -> None:
    run(shell, cell)
    shown = capfd.readouterr()
    assert (said in shown.err) if said else ("In a cell" not in shown.err and "ros2 is here" in shown.out)


@pytest.mark.parametrize("line", ["%ros2 topic echo /nope --once", '%ros2 topic echo "/a'])
def test_an_error_is_a_line_without_a_traceback(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str], line: str
) -> None:
    with use_graph(Graph()):
        assert not run(shell, line)
    shown = capsys.readouterr()
    assert "UsageError: " in shown.out + shown.err
    assert "Traceback" not in shown.out + shown.err


def test_timeout_ends_a_command_as_the_stop_button_does(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    with use_graph(Graph(notebook=True)) as graph:
        assert run(shell, "import rclpy\nrclpy.init()\n%timeout 2.5 ros2 topic hz /nothing\nprint('and on')")
        assert 2.5 <= (graph.now_ns - START_NS) * 1e-9 < 3.0
    shown = capsys.readouterr().out
    assert shown.endswith("Stopped after 2.5 s of robot time.\nand on\n")


def test_timeout_alone_ends_an_endless_command_where_nobody_can_press_stop(
    shell: InteractiveShell, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    monkeypatch.chdir(tmp_path)
    with use_graph(Graph(notebook=True)) as graph:
        assert run(shell, "import rclpy\nrclpy.init()\n%timeout 10 ros2 bag record -a -o kept")
        assert 10.0 <= (graph.now_ns - START_NS) * 1e-9 < 10.5


@pytest.mark.parametrize("line", ["", "ros2 topic hz /a", "5 rqt", "1.2.3 ros2 topic list", "5 ros2"])
def test_timeout_says_how_it_is_written(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str], line: str
) -> None:
    assert not run(shell, f"%timeout {line}")
    shown = capsys.readouterr()
    assert "%timeout 5 ros2 topic hz /scan" in shown.out + shown.err


@pytest.mark.parametrize(
    ("line", "written"),
    [
        ("!ros2 topic list", "%ros2 topic list"),
        ("if True:\n    !ros2 topic list | grep ros", "%ros2 topic list | grep ros"),
        ("!timeout 5 ros2 topic list", "%timeout 5 ros2 topic list"),
    ],
)
def test_a_shell_s_ros2_is_this_notebook_s_and_says_how_it_is_written(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str], line: str, written: str
) -> None:
    with use_graph(Graph(notebook=True)):
        assert run(shell, line)
    shown = capfd.readouterr()
    assert shown.err == f"In a notebook write {written}\n"
    assert "/rosout\n" in shown.out


def test_what_a_shell_s_ros2_writes_can_be_kept(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str]
) -> None:
    with use_graph(Graph()):
        assert run(shell, "found = !ros2 topic list")
    assert shell.user_ns["found"] == ["/parameter_events", "/rosout"]
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize("line", ["!echo ros2 topic list", "!echo hello; true", "x = !echo ros2bag"])
def test_other_commands_go_to_the_shell(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str], line: str
) -> None:
    assert run(shell, line)
    assert "In a notebook" not in capfd.readouterr().err
