"""Whole programs, run as `course run` runs them."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from rclpy.signals import uninstall_signal_handlers

from course_lib.ros.graph.graph import START_NS, Graph, Sample, use_graph
from course_lib.ros.programs.program import run_files
from course_lib.ros.time.time_lock import DeadlockError
from tests.processes import Program

MANY_THREADS = """
import time, random, threading
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

class Worker(Node):
    def __init__(self):
        super().__init__("worker")
        self.publisher = self.create_publisher(String, "done", 10)
        for number in range(3):
            self.create_timer(0.1, lambda n=number: self.work(n), callback_group=ReentrantCallbackGroup())

    def work(self, number):
        time.sleep(random.random() / 3)
        self.publisher.publish(String(data=f"{number} {threading.active_count() > 1}"))

rclpy.init()
rclpy.spin(Worker(), MultiThreadedExecutor(4))
"""

ENDPOINT = """
import rclpy
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node("{name}")
{create}
rclpy.spin(node)
"""


def run(tmp_path: Path, *sources: str) -> list[Sample]:
    files = [tmp_path / f"program{number}.py" for number in range(len(sources))]
    for file, source in zip(files, sources, strict=True):
        file.write_text(source)
    samples: list[Sample] = []
    with use_graph(Graph(end_ns=START_NS + 3 * 10**9)) as graph:
        graph.tap(samples.append)
        assert run_files(files, seed=1) == 0
    return samples


def test_program_with_many_threads_is_deterministic(tmp_path: Path) -> None:
    runs = [run(tmp_path, MANY_THREADS) for _ in range(5)]
    assert len(runs[0]) > 50
    assert all(samples == runs[0] for samples in runs)


def test_two_programs_have_separate_contexts_and_report_incompatible_qos(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    talker = ENDPOINT.format(
        name="talker", create='node.create_publisher(String, "x", qos_profile_sensor_data)'
    )
    listener = ENDPOINT.format(name="listener", create='node.create_subscription(String, "x", print, 10)')
    run(tmp_path, talker, listener)
    err = capsys.readouterr().err
    assert "[talker]: New subscription discovered on topic 'x', requesting incompatible QoS." in err
    assert "[listener]: New publisher discovered on topic 'x', offering incompatible QoS." in err


TALKER = """
import rclpy
rclpy.init()
node = rclpy.create_node("talker")
node.create_timer(0.1, lambda: None)
try:
    print("ready", flush=True)
    rclpy.spin(node)
except KeyboardInterrupt:
    print("left by Ctrl+C")
"""


@pytest.mark.slow
def test_ctrl_c_ends_every_program_of_a_run_even_of_the_same_file(tmp_path: Path) -> None:
    talker = tmp_path / "talker.py"
    talker.write_text(TALKER)
    command = [sys.executable, "-m", "course_lib", "run", str(talker), str(talker), "--real-time"]
    with Program(command, stdout=subprocess.PIPE) as process:
        assert [process.read_line() for _ in range(2)] == ["ready\n"] * 2
        time.sleep(0.2)  # time until it waits [s]
        process.send_signal(signal.SIGINT)
        assert process.communicate(timeout=120)[0] == "left by Ctrl+C\n" * 2
        assert process.returncode == 0


WAITING = """
import rclpy
from rclpy.signals import SignalHandlerOptions

rclpy.init({options})
node = rclpy.create_node("n")
node.create_timer(0.1, lambda: None)
print("ready", flush=True)
try:
    rclpy.spin(node)
except {error}:
    node.get_logger().info("after")
"""


def _interrupted(program: Path, text: str) -> tuple[str, int]:
    """Return stderr and the exit code of a program that gets Ctrl+C while it waits."""
    program.write_text(text)
    command = [sys.executable, "-m", "course_lib", "run", str(program), "--real-time"]
    with Program(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.read_line() == "ready\n"
        time.sleep(0.3)  # time until it waits [s]
        process.send_signal(signal.SIGINT)
        return process.communicate(timeout=120)[1], process.returncode


@pytest.mark.parametrize("options", ["", "signal_handler_options=SignalHandlerOptions.NO"])
def test_ctrl_c_ends_a_program_without_a_traceback(options: str, tmp_path: Path) -> None:
    text = WAITING.format(options=options, error="ValueError")
    assert _interrupted(tmp_path / "program.py", text) == ("", 130)


def test_logging_after_ctrl_c_writes_only_the_log_line(tmp_path: Path) -> None:
    err, code = _interrupted(tmp_path / "program.py", WAITING.format(options="", error="KeyboardInterrupt"))
    assert code == 0
    assert err.startswith("[INFO] [")
    assert err.endswith("] [n]: after\n")
    assert err.count("\n") == 1


STUCK = """
import os, threading

print("ready", flush=True)
threading.Thread(target=os.read, args=(os.pipe()[0], 1)).start()
"""


@pytest.mark.slow
def test_second_ctrl_c_ends_a_program_blocked_outside_the_kit(tmp_path: Path) -> None:
    program = tmp_path / "stuck.py"
    program.write_text(STUCK)
    command = [sys.executable, "-m", "course_lib", "run", str(program)]
    pipes: Any = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with Program(command, start_new_session=True, **pipes) as process:
        assert process.read_line() == "ready\n"
        for _ in range(2):
            time.sleep(0.5)  # pause of a user [s]
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGINT)
        try:
            assert "Stopped at once." in process.communicate(timeout=120)[1]
            assert process.returncode == 130
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)


WAITS_ON = """
import time
while True:
    try:
        time.sleep(1.0)
    except KeyboardInterrupt:
        pass
"""


def test_program_still_waiting_after_the_end_of_a_run_is_stopped_with_a_notice(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "waiter.py"
    program.write_text(WAITS_ON)
    with use_graph(Graph(end_ns=START_NS + 10**9)):
        assert run_files([program], seed=1) == 0
    assert capsys.readouterr().err == (
        "waiter.py was stopped: it was still waiting after the end of the run.\n"
    )


FAILS = """
import rclpy
rclpy.init()
node = rclpy.create_node("x")
node.create_timer(1.0, lambda: node.get_parameter("y"))
rclpy.spin(node)
"""


def test_traceback_shows_program_lines_and_not_kit_lines(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "fails.py"
    program.write_text(FAILS)
    with use_graph(Graph()):
        assert run_files([program], seed=1) == 1
    errors = capsys.readouterr().err
    assert errors.count("  File ") == errors.count(str(program)) == 2
    last = "ParameterNotDeclaredException: Invalid access to undeclared parameter(s): y\nhint: declare y"
    assert last in errors


def test_deadlocked_programs_raise_deadlock_error_and_end(tmp_path: Path) -> None:
    files = [tmp_path / "a.py", tmp_path / "b.py"]
    for file in files:
        file.write_text(ENDPOINT.format(name=file.stem, create=""))
    with use_graph(Graph()), pytest.raises(DeadlockError, match="a callback of /a"):
        run_files(files, seed=1)


def test_string_passed_to_sys_exit_is_shown_and_exits_with_code_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "leaving.py"
    file.write_text("import sys; sys.exit('no robot here')")
    with use_graph(Graph()):
        assert run_files([file], seed=1) == 1
    assert capsys.readouterr().err == "no robot here\n"


def test_program_without_a_shutdown_leaves_no_signal_handler_behind(tmp_path: Path) -> None:
    before = signal.getsignal(signal.SIGINT)
    run(tmp_path, "import rclpy; rclpy.init()")
    uninstall_signal_handlers()  # as the next program does
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.parametrize(
    ("source", "code"),
    [
        ('"""Say it."""\nimport sys\nCODE = 3\n\ndef main():\n    return CODE\n', 3),  # as a console script
        ("def main():\n    raise SystemExit(4)\n\nif __name__ == '__main__':\n    print('guarded')\n", 0),
        ("def main():\n    return 5\n\nprint('it runs something already')\n", 0),
        ("def start():\n    return 6\n", 0),
    ],
)
def test_main_of_a_file_without_a_call_runs_like_a_console_script(
    source: str, code: int, tmp_path: Path
) -> None:
    file = tmp_path / "program.py"
    file.write_text(source)
    with use_graph(Graph(end_ns=START_NS + 10**9)):
        assert run_files([file], seed=0) == code


def test_relative_import_in_a_file_started_by_its_path_has_a_hint(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "node.py").write_text("from .config import RATE\n")
    with use_graph(Graph(end_ns=START_NS + 10**9)):
        assert run_files([tmp_path / "node.py"], seed=0) == 1
    hint = "hint: a started file has no package: leave out the dot to import a file next to it."
    assert hint in capsys.readouterr().err


def test_relative_import_in_a_folder_of_a_package_without_init_has_a_hint(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "arm" / "arm" / "node.py"
    file.parent.mkdir(parents=True)
    (tmp_path / "arm" / "package.xml").write_text("<package><name>arm</name></package>")
    file.write_text("from .config import RATE\n")
    (file.parent / "config.py").write_text("RATE = 2.0\n")
    for code in (1, 0):
        with use_graph(Graph(end_ns=START_NS + 10**9)):
            assert run_files([file], seed=0) == code
        (file.parent / "__init__.py").touch()
    hint = "hint: arm is no Python package: put an empty __init__.py next to node.py."
    assert hint in capsys.readouterr().err


NODE = "from rclpy.node import Node\n\nclass Talker(Node):\n    pass\n\n"
UNNAMED = """program.py ran nothing.
hint: line 9 compares __name__ with "main", and Python names a started program "__main__". \
Write: if __name__ == "__main__":
"""
UNCALLED = """program.py ran nothing.
hint: line 10 names main and does not call it. Write: main()
"""
UNUSED = """program.py ran nothing.
hint: it only defines Talker. Write at its end: rclpy.init(), then rclpy.spin(Talker()).
"""


@pytest.mark.parametrize(
    ("source", "printed"),
    [
        (f"{NODE}def main():\n    pass\n\nif __name__ == 'main':\n    main()\n", UNNAMED),
        (f"{NODE}def main():\n    pass\n\nif __name__ == '__main__':\n    main\n", UNCALLED),
        (f"{NODE}RATE = 2.0  # [Hz]\n", UNUSED),
        (f"{NODE}def main():\n    pass\n", ""),
        (f"{NODE}def main():\n    pass\n\nmain()\n", ""),
        (f"{NODE}print('it runs')\nif __name__ == 'main':\n    pass\n", ""),
        ("def helper():\n    pass\n", ""),
    ],
)
def test_file_that_starts_no_node_is_reported_with_the_missing_call(
    source: str, printed: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "program.py"
    file.write_text(source)
    with use_graph(Graph(end_ns=START_NS + 10**9)):
        assert run_files([file], seed=0) == 0
    assert capsys.readouterr().err == printed


ASYNC = """
import asyncio
async def main():
    await asyncio.sleep(0.5)
    return "slept"
print(asyncio.get_event_loop().run_until_complete(main()))
"""


def test_each_concurrent_program_has_an_asyncio_event_loop(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run(tmp_path, ASYNC, ASYNC)
    assert capsys.readouterr() == ("slept\nslept\n", "")
