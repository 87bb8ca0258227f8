import subprocess
import sys
import time
from contextlib import suppress

import psutil
import pytest

from tests.patience import PATIENCE
from tests.processes import Program

# A program that starts another one, which keeps its output open, and neither ends.
ENDLESS = """
import subprocess, sys, time

other = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
print(other.pid, flush=True)
time.sleep(600)
"""


def has_ended(pid: int) -> bool:
    """Wait until a process has ended, and return whether it has."""
    deadline = time.monotonic() + PATIENCE
    with suppress(psutil.NoSuchProcess):
        while psutil.Process(pid).status() != psutil.STATUS_ZOMBIE:
            if time.monotonic() > deadline:
                return False
            time.sleep(0.01)
    return True


def test_program_over_its_limit_is_killed_with_its_children_and_waits_for_it_end() -> None:
    began = time.monotonic()
    program = Program([sys.executable, "-c", ENDLESS], limit=2.0, stdout=subprocess.PIPE)
    child = int(program.read_line())
    assert program.read_line() == ""
    with pytest.raises(subprocess.TimeoutExpired):
        program.communicate()
    assert has_ended(child)
    assert time.monotonic() - began < 60


def test_program_is_killed_with_its_children_at_the_end_of_a_with_block() -> None:
    with Program([sys.executable, "-c", ENDLESS], stdout=subprocess.PIPE) as program:
        child = int(program.find(r"[0-9]+"))
        assert psutil.pid_exists(child)
    assert program.returncode
    assert has_ended(child)


def test_end_of_the_output_without_the_expected_line_is_reported_with_the_output() -> None:
    with Program([sys.executable, "-c", "print('started')"], stdout=subprocess.PIPE) as program:
        with pytest.raises(AssertionError, match=r"no 'ready' in 'started\\n'"):
            program.find("ready")
        assert program.wait() == 0
