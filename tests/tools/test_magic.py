import subprocess
import sys
from pathlib import Path

import pytest
from IPython.core.interactiveshell import InteractiveShell

from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.tools.notebook import register
from tests.patience import PATIENCE


@pytest.fixture(scope="module")
def shell() -> InteractiveShell:
    shell = InteractiveShell.instance()
    register(shell)
    register(shell)
    return shell


def test_magic_is_imported_before_the_standin_is_installed() -> None:
    subprocess.run([sys.executable, "-c", "import course_lib.tools.notebook"], check=True, timeout=PATIENCE)


LOAD = """
import sys
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
before = set(sys.modules)
shell.run_line_magic("load_ext", "course_lib")
sys.exit("IPython.core.magics.script" in set(sys.modules) - before)
"""


def test_extension_is_loaded_without_the_script_magics_of_ipython() -> None:
    subprocess.run([sys.executable, "-c", LOAD], check=True, timeout=PATIENCE)


def run(shell: InteractiveShell, line: str) -> bool:
    """Run a cell. Return whether it succeeded."""
    return bool(shell.run_cell(line).success)


def test_magic_lists_the_topics_of_the_notebook(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str]
) -> None:
    with use_graph(Graph()):
        assert run(shell, "%ros2 topic list")
    assert capsys.readouterr().out == "/parameter_events\n/rosout\n"


@pytest.mark.parametrize(
    ("cell", "message"),
    [
        ("%%bash\ncd .\nros2 topic list -v\n", "In a cell write %ros2 topic list -v\n"),
        (
            "%%sh\n  timeout 5 ros2 topic hz /a || true",
            "In a cell write %timeout 5 ros2 topic hz /a || true\n",
        ),
        ("%%bash\necho ros2 is here", ""),
    ],
)
def test_shell_script_cell_with_ros2_prints_the_magic_to_use(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str], cell: str, message: str
) -> None:
    run(shell, cell)
    captured = capfd.readouterr()
    assert (
        (message in captured.err)
        if message
        else ("In a cell" not in captured.err and "ros2 is here" in captured.out)
    )


def test_shell_script_cell_runs_its_commands(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run(shell, "%%bash\necho started")
    assert capfd.readouterr().out == "started\n"


@pytest.mark.parametrize("line", ["%ros2 topic echo /nope --once", '%ros2 topic echo "/a'])
def test_error_is_one_line_without_a_traceback(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str], line: str
) -> None:
    with use_graph(Graph()):
        assert not run(shell, line)
    captured = capsys.readouterr()
    assert "UsageError: " in captured.out + captured.err
    assert "Traceback" not in captured.out + captured.err


def test_timeout_ends_a_command_as_the_stop_button_does(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    with use_graph(Graph(notebook=True)) as graph:
        assert run(shell, "import rclpy\nrclpy.init()\n%timeout 2.5 ros2 topic hz /nothing\nprint('and on')")
        assert 2.5 <= (graph.now_ns - START_NS) * 1e-9 < 3.0
    output = capsys.readouterr().out
    assert output.endswith("Stopped after 2.5 s of robot time.\nand on\n")


def test_timeout_ends_an_endless_command_without_a_page(
    shell: InteractiveShell, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    monkeypatch.chdir(tmp_path)
    with use_graph(Graph(notebook=True)) as graph:
        assert run(shell, "import rclpy\nrclpy.init()\n%timeout 10 ros2 bag record -a -o kept")
        assert 10.0 <= (graph.now_ns - START_NS) * 1e-9 < 10.5


@pytest.mark.parametrize("line", ["", "ros2 topic hz /a", "5 rqt", "1.2.3 ros2 topic list", "5 ros2"])
def test_timeout_usage_is_printed(
    shell: InteractiveShell, capsys: pytest.CaptureFixture[str], line: str
) -> None:
    assert not run(shell, f"%timeout {line}")
    captured = capsys.readouterr()
    assert "%timeout 5 ros2 topic hz /scan" in captured.out + captured.err


@pytest.mark.parametrize(
    ("line", "written"),
    [
        ("!ros2 topic list", "%ros2 topic list"),
        ("if True:\n    !ros2 topic list | grep ros", "%ros2 topic list | grep ros"),
        ("!timeout 5 ros2 topic list", "%timeout 5 ros2 topic list"),
    ],
)
def test_shell_ros2_runs_in_the_notebook_and_prints_the_magic(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str], line: str, written: str
) -> None:
    with use_graph(Graph(notebook=True)):
        assert run(shell, line)
    captured = capfd.readouterr()
    assert captured.err == f"In a notebook write {written}\n"
    assert "/rosout\n" in captured.out


def test_output_of_shell_ros2_can_be_assigned(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str]
) -> None:
    with use_graph(Graph()):
        assert run(shell, "found = !ros2 topic list")
    assert shell.user_ns["found"] == ["/parameter_events", "/rosout"]
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize(
    ("cell", "call"),
    [
        ("%check", 'check("week01.red_cube", RedCube)'),
        ("%check week02.joint_wave wave", 'check("week02.joint_wave", wave)'),
        ("%check 'week02.joint_wave', wave", 'check("week02.joint_wave", wave)'),
    ],
)
def test_check_as_a_magic_prints_its_call(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str], cell: str, call: str
) -> None:
    run(shell, cell)
    assert f"check is a function: write {call}, without the %." in capfd.readouterr().err


@pytest.mark.parametrize("line", ["!echo ros2 topic list", "!echo hello; true", "x = !echo ros2bag"])
def test_other_commands_are_passed_to_the_shell(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str], line: str
) -> None:
    assert run(shell, line)
    assert "In a notebook" not in capfd.readouterr().err


@pytest.mark.parametrize(
    ("cell", "call"),
    [
        ("!rviz2", "viewer = Viewer(); viewer"),
        ("!rviz2 -d layout.rviz", "viewer = Viewer.from_rviz('layout.rviz'); viewer"),
        ("%rviz2 -d layout.rviz", "viewer = Viewer.from_rviz('layout.rviz'); viewer"),
        ("!rqt_graph", "In a notebook write %rqt graph"),
        ("!source install/setup.bash && rviz2", "viewer = Viewer(); viewer"),
        ("!. ../install/local_setup.bash; ros2 node list", "In a notebook write %ros2 node list"),
        ("!source /opt/ros/jazzy/setup.bash && source a/setup.sh && ros2 node list", "write %ros2 node list"),
    ],
)
def test_window_command_prints_the_notebook_alternative(
    shell: InteractiveShell, capfd: pytest.CaptureFixture[str], cell: str, call: str
) -> None:
    with use_graph(Graph()):
        run(shell, cell)
    captured = capfd.readouterr()
    assert call in captured.err
    assert "command not found" not in captured.err
