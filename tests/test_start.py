"""The restart of `course` with a fixed hash seed."""

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from course_lib import cli, usual_commands
from course_lib.__main__ import main
from course_lib.tools import run as tools
from tests.patience import PATIENCE

PROGRAM = "import sys, os\nprint(os.environ['PYTHONHASHSEED'], sys.argv[1:], hash('a'))\n"


@pytest.mark.parametrize(
    ("words", "is_restarted"),
    [
        ("run a.py", True),
        ("--debug run a.py", True),
        ("bag play bag", True),
        ("bag info bag", False),
        ("ros2 --run a.py topic list", True),
        ("ros2 --run=a.py topic list", True),
        ("ros2 --bag bag topic list", False),
        ("lab", False),
        ("", False),
    ],
)
def test_only_commands_that_run_programs_restart_the_interpreter(
    words: str, is_restarted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    started: list[list[str]] = []

    def execve(program: str, command: list[str], environment: dict[str, str]) -> None:
        assert environment["PYTHONHASHSEED"] == usual_commands.HASH_SEED
        started.append(command)
        assert signal.SIGINT in signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        raise SystemExit

    monkeypatch.delenv("PYTHONHASHSEED", raising=False)
    monkeypatch.setattr(os, "execve", execve)
    monkeypatch.setattr(os, "name", "posix")
    if is_restarted:
        with pytest.raises(SystemExit):
            usual_commands.fix_hash_seed(words.split())
        assert started == [[sys.executable, "-P", "-m", "course_lib", *words.split()]]
    else:
        usual_commands.fix_hash_seed(words.split())
        assert started == []


def test_interrupt_during_the_imports_exits_without_a_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(words: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(usual_commands, "find_usual_command", interrupt)
    monkeypatch.setattr(sys, "argv", ["course", "--version"])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == usual_commands.INTERRUPTED


@pytest.mark.slow
def test_program_runs_once_with_the_hash_seed_and_its_arguments(tmp_path: Path) -> None:
    (tmp_path / "p.py").write_text(PROGRAM)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONHASHSEED"}
    command = [sys.executable, "-m", "course_lib", "run", "p.py", "--", "--word"]
    outputs = {
        subprocess.run(
            command,
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
            timeout=PATIENCE,
        ).stdout
        for _ in range(2)
    }
    (output,) = outputs
    assert output.startswith("0 ['--word'] ")


def test_files_named_like_python_modules_do_not_break_a_run(tmp_path: Path) -> None:
    # These are modules that the kit or one of its libraries imports only when a program runs.
    for name in ("concurrent", "json", "numpy", "queue", "random", "select", "typing"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('a wrong module was imported')\n")
    (tmp_path / "p.py").write_text("import rclpy\nrclpy.init()\nprint(rclpy.create_node('n').get_name())\n")
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONHASHSEED"}
    # As the script `course` starts, which does not add the current folder to the path.
    command = [sys.executable, "-P", "-m", "course_lib", "run", "p.py"]
    done = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=PATIENCE
    )
    assert (done.stdout, done.stderr, done.returncode) == ("n\n", "", 0)


def test_no_heavy_module_is_imported_before_the_restart() -> None:
    code = "import sys, course_lib.__main__; print(*({'numpy', 'typer', 'rclpy'} & sys.modules.keys()))"
    process = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=PATIENCE
    )
    assert process.stdout == "\n"


@pytest.mark.slow
def test_common_command_lines_make_the_same_calls_as_typer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "p.yaml").write_text("{}")
    monkeypatch.setenv("PYTHONHASHSEED", usual_commands.HASH_SEED)
    monkeypatch.chdir(tmp_path)
    calls: list[Any] = []

    def keep(*args: Any, **options: Any) -> int:
        calls.append((args, options))
        return 7

    monkeypatch.setattr(tools, "run", keep)
    monkeypatch.setattr(tools, "ros2_over", keep)
    lines = [
        "run a.py",
        "run a.py b.py --seconds 2 --seed 3 --bag out",
        "run --seconds=0.5 --real-time a.py",
        "run a.launch.py speed:=2.0 --strict",
        "run a.py --params-file p.yaml -- --word -x",
        "run a.py --real-time --ros-args -p a:=1 -- -x",
        "run lesson.ipynb",
        "run pkg:talker a.ipynb",
        "ros2 --run a.py --run=b.py topic echo /chatter --once",
        "ros2 --bag bag --seconds 3 topic list -t",
        "ros2 topic list",
        "ros2",
    ]
    for line in lines:
        words = line.split()
        command = usual_commands.find_usual_command(words)
        assert command is not None, line
        assert command() == 7
        monkeypatch.setattr(sys, "argv", ["course", *words])
        with pytest.raises(SystemExit, match="7"):
            cli.main()
        quick, typers = calls[-2:]
        assert _plain(quick) == _plain(typers), line


def _plain(call: Any) -> Any:
    """Return a call without the options that have their default."""
    args, options = call
    kept = {name: value for name, value in options.items() if value not in (None, False, [], ())}
    kept = {name: list(value) if isinstance(value, tuple) else value for name, value in kept.items()}
    return [list(arg) for arg in args], kept


@pytest.mark.parametrize(
    "line",
    [
        "",
        "run",
        "run --help",
        "run a.py --help",
        "run a.py --seconds",
        "run a.py --seconds x",
        "run a.py --seconds -1",
        "run a.py --params-file no.yaml",
        "run a.py --real-time=1",
        "run a.py --second 2",
        "run a.py --robot tcp/h:1",
        "run a.launch.py --show-args",
        "--debug run a.py",
        "ros2 --help",
        "ros2 --run a.py topic pub /a std_msgs/msg/String -- {data: x}",
        "ros2 --robot tcp/h:1 topic list",
        "bag play b",
        "lab",
    ],
)
def test_other_command_lines_are_parsed_by_typer(line: str) -> None:
    assert usual_commands.find_usual_command(line.split()) is None


@pytest.mark.slow
def test_small_program_runs_without_importing_unnecessary_modules(tmp_path: Path) -> None:
    (tmp_path / "p.py").write_text(
        "import sys, rclpy\nrclpy.init()\nrclpy.create_node('n')\n"
        "print(*sorted({'typer', 'pydantic', 'yaml', 'launch', 'rosbags', 'IPython'} & sys.modules.keys()))\n"
    )
    process = subprocess.run(
        [sys.executable, "-m", "course_lib", "run", "p.py"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert (process.stdout, process.stderr, process.returncode) == ("\n", "", 0)


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    "line", ["run no.py", "run a.py --bag .", "ros2 topic list", "ros2 --bag no topic list"]
)
def test_error_of_a_common_command_is_one_line(line: str, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "course_lib", *line.split()]
    process = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=PATIENCE)
    assert (process.returncode, process.stdout, len(process.stderr.splitlines())) == (2, "", 1)
    assert process.stderr.startswith("error: ")
