import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import course_lib
from course_lib.usual_commands import HASH_SEED
from tests.conftest import Typed
from tests.patience import PATIENCE

PROGRAM = Path(__file__).parent / "programs" / "timer.py"
HELLO = "import rclpy\nrclpy.init()\nrclpy.create_node('hello').get_logger().info(rclpy.__file__)\n"


def course(*words: str, cwd: Path, **environment: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "course_lib", *words]
    return subprocess.run(
        command,
        cwd=cwd,
        env=os.environ | {"PYTHONHASHSEED": HASH_SEED} | environment,  # otherwise some start twice
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@pytest.fixture
def bad_inputs(tmp_path: Path) -> Path:
    (tmp_path / "folder").mkdir()
    (tmp_path / "broken.ipynb").write_text('{"cells": [')
    (tmp_path / "broken.py").write_text("def f(:\n")
    (tmp_path / "binary.py").write_bytes(b"\0\1\2")
    (tmp_path / "broken.rviz").write_text("a: [1,\nb: }")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "file").touch()
    return tmp_path


@pytest.mark.parametrize(
    "words",
    [
        "frobnicate",
        "bag",
        "run",
        "run missing.py",
        "run folder",
        "run broken.py",
        "run binary.py",
        "run broken.ipynb",
        "run {program} --seconds soon",
        "run {program} --bag folder",
        "render --bag missing --png out.png",
        "render --bag folder --png out.png",
        "render --bag folder",
        "render --bag folder --size big --png out.png",
        "render --bag folder --at -1 --png out.png",
        "render --bag folder --png out.jpg",
        "view --no-browser --bag missing",
        "view --no-browser --rviz missing.rviz",
        "export",
        "export {program} --package Robot --out new",
        "export --check missing",
        "bag info missing",
        "bag info folder",
        "ros2 topic list",
        "ros2 --bag missing topic list",
        "ros2 --run {program} --bag missing topic list",
        "check missing.ipynb",
        "check folder",
        "check broken.ipynb",
        "submit missing.ipynb",
        "submit folder",
        "submit broken.ipynb",
        "grade missing --out out",
        "grade broken.py --out out",
        "grade folder --out broken.py",
        "lab broken.py",
        "lab new --port 99999",
        "release full",
        "demo --out full",
    ],
)
def test_invalid_input_gives_a_one_line_error_and_exit_code_2(
    bad_inputs: Path, in_process: Callable[..., Typed], words: str
) -> None:
    process = in_process(*words.format(program=PROGRAM).split(), cwd=bad_inputs)
    assert process.returncode == 2, process.stdout + process.stderr
    assert "Traceback" not in process.stdout + process.stderr
    (line,) = process.stderr.splitlines()
    assert line.startswith("error: ")


def test_ros2_command_that_fails_gives_a_one_line_error_and_exit_code_1(
    bad_inputs: Path, in_process: Callable[..., Typed]
) -> None:
    words = f"ros2 --run {PROGRAM} run tf2_ros tf2_ecko a b"
    process = in_process(*words.split(), cwd=bad_inputs)
    (line,) = process.stderr.splitlines()
    assert (process.returncode, line.startswith("error: ")) == (1, True)


def test_installed_command_rejects_invalid_input_with_exit_code_2(bad_inputs: Path) -> None:
    process = course("run", "folder", cwd=bad_inputs)
    assert (process.returncode, process.stdout, len(process.stderr.splitlines())) == (2, "", 1)


@pytest.mark.slow
def test_debug_option_shows_the_traceback(tmp_path: Path) -> None:
    assert "Traceback" in course("--debug", "run", "missing.py", cwd=tmp_path).stderr


@pytest.mark.parametrize(
    "command", ["", "lab", "run", "ros2", "render", "check", "submit", "grade", "release", "bag info"]
)
def test_every_command_has_help(tmp_path: Path, in_process: Callable[..., Typed], command: str) -> None:
    process = in_process(*command.split(), "--help", cwd=tmp_path)
    assert process.returncode == 0
    assert "Usage: course" in process.stdout


@pytest.mark.parametrize(
    ("words", "command"),
    [
        ("grade submissions --out", "course grade"),
        ("grade submissions --ot out", "course grade"),
        ("grade", "course grade"),
        ("ros2 --bag", "course ros2"),
        ("bag play --run", "course bag play"),
        ("frobnicate --out", "course"),
        ("--out", "course"),
    ],
)
def test_invalid_arguments_point_to_the_help_of_their_command(
    tmp_path: Path, in_process: Callable[..., Typed], words: str, command: str
) -> None:
    process = in_process(*words.split(), cwd=tmp_path)
    assert process.stderr.endswith(f". See: {command} --help\n")


def test_sim_time_without_a_robot_is_rejected(tmp_path: Path, in_process: Callable[..., Typed]) -> None:
    process = in_process("view", "--bag", "somewhere", "--use-sim-time", cwd=tmp_path)
    assert process.returncode == 2
    assert "--robot dds/HOST" in process.stderr


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="the output is closed by the shell")
def test_program_runs_with_a_closed_output(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text("from pathlib import Path\nPath(__file__).with_suffix('.txt').write_text('ran')\n")
    command = f"exec {sys.executable} -m course_lib run {program} >&-"
    process = subprocess.run(command, shell=True, stderr=subprocess.PIPE, text=True, timeout=PATIENCE)
    assert (process.returncode, process.stderr) == (0, "")
    assert program.with_suffix(".txt").read_text() == "ran"


def test_exit_code_of_run_is_the_exit_code_of_the_program(tmp_path: Path) -> None:
    (tmp_path / "fails.py").write_text("raise ValueError('no')")
    (tmp_path / "leaves.py").write_text("import sys\nsys.exit(3)")
    assert course("run", "fails.py", cwd=tmp_path).returncode == 1
    assert course("run", "leaves.py", cwd=tmp_path).returncode == 3


@pytest.mark.parametrize("before", [[], ["--"]])
def test_ros_args_and_arguments_after_two_dashes_reach_the_program(tmp_path: Path, before: list[str]) -> None:
    (tmp_path / "says.py").write_text("import sys\nprint(sys.argv)")
    process = course("run", "says.py", *before, "--ros-args", "-r", "a:=b", cwd=tmp_path)
    assert process.stdout == "['says.py', '--ros-args', '-r', 'a:=b']\n"


@pytest.mark.parametrize("content", ["raise ImportError('a broken ROS')", "import _rclpy_pybind11"])
def test_rclpy_on_the_python_path_is_ignored(tmp_path: Path, content: str) -> None:
    foreign = tmp_path / "ros" / "rclpy"
    foreign.mkdir(parents=True)
    (foreign / "__init__.py").write_text(content)
    (tmp_path / "hello.py").write_text(HELLO)
    process = course("run", "hello.py", cwd=tmp_path, PYTHONPATH=str(foreign.parent))
    assert process.returncode == 0, process.stderr
    assert str(Path(course_lib.__file__).parent) in process.stderr


def test_programs_run_together_share_one_graph_with_separate_main_modules(tmp_path: Path) -> None:
    (tmp_path / "hears.py").write_text(
        "import rclpy\nfrom std_msgs.msg import Int32\n"
        "rclpy.init()\nnode = rclpy.create_node('hears')\n"
        "node.create_subscription(Int32, 'count', lambda m: node.get_logger().info(f'heard {m.data}'), 10)\n"
        "rclpy.spin(node)\n"
    )
    process = course("run", "hears.py", str(PROGRAM), "--seconds", "0.5", cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert "[INFO] [1700000000.401000000] [hears]: heard 4" in process.stderr


@pytest.mark.slow
def test_ros2_command_inspects_programs_and_bags(tmp_path: Path) -> None:
    process = course(
        "ros2", "--run", str(PROGRAM), "--seconds", "0.35", "topic", "echo", "/count", cwd=tmp_path
    )
    assert process.returncode == 0, process.stderr
    assert process.stdout.count("---\n") == 3
    course("run", str(PROGRAM), "--seconds", "1", "--bag", "bag", cwd=tmp_path)
    output = course("ros2", "--bag", "bag", "topic", "list", "-t", cwd=tmp_path)
    assert "/count [std_msgs/msg/Int32]\n" in output.stdout
    assert course("ros2", "--bag", "bag", "service", "list", cwd=tmp_path).returncode == 0
