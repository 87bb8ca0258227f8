import os
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from tests.patience import PATIENCE
from tests.warm import run_course

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are forked on Linux only")
# Everything of a process that a program may depend on.
PROGRAM = """
import os, random, signal, sys, threading
import numpy as np
import rclpy
print(sys.argv, os.getcwd(), sorted(os.environ.items()), hash("a"), sys.flags, sys.path)
print(os.getpgid(0), signal.getsignal(signal.SIGINT), threading.active_count(), os.getppid() > 1)
print(random.random(), np.random.rand(), sys.stdin.read(), sys.stdout.isatty(), sys.stdout.encoding)
print([name for name in os.listdir("/proc/self/fd")])
rclpy.init()
rclpy.create_node("one").nothing
"""


@pytest.mark.parametrize("words", [("run", "a.py", "--", "x", "y"), ("run", "no.py"), ("nothing",)])
def test_forked_command_equals_a_new_process(words: tuple[str, ...], tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text(PROGRAM)
    cold = subprocess.run(
        [sys.executable, "-m", "course_lib", *words],
        cwd=tmp_path,
        env=os.environ | {"FRUIT": "ä", "PWD": str(tmp_path)},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    warm = run_course(*words, cwd=tmp_path, env={"FRUIT": "ä", "PWD": str(tmp_path)})
    assert cold.returncode
    assert (warm.stdout, warm.stderr, warm.returncode) == (cold.stdout, cold.stderr, cold.returncode)


def test_errors_are_in_the_order_of_the_output_if_both_are_merged(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text(
        "import sys\nfor n in range(3):\n    print(n, flush=True)\n    print('!', file=sys.stderr)\n"
    )
    assert run_course("run", "a.py", cwd=tmp_path, is_merged=True).stdout == "0\n!\n1\n!\n2\n!\n"


def test_command_that_exceeds_its_time_is_killed(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("while True: pass\n")
    with pytest.raises(subprocess.TimeoutExpired):
        run_course("run", "a.py", "--real-time", cwd=tmp_path, timeout=5)
    folders = [process.info["cwd"] for process in psutil.process_iter(["cwd"])]
    assert folders
    assert str(tmp_path) not in folders
    assert run_course("--version", cwd=tmp_path).returncode == 0


def test_variable_of_the_interpreter_is_followed_after_another_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.py").write_text("import sys\nprint(sys.warnoptions)\n")
    before = run_course("run", "a.py", cwd=tmp_path).stdout
    monkeypatch.setenv("PYTHONWARNINGS", "error::ImportWarning")
    assert run_course("run", "a.py", cwd=tmp_path).stdout == "['error::ImportWarning']\n" != before
