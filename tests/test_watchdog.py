"""One thread limits the time of all tests of a file, where pytest's option starts one for each test."""

import faulthandler
import os
import sys
from pathlib import Path
from subprocess import run

import pytest

import tests.watchdog as watchdog
from tests.patience import PATIENCE

ROOT = Path(__file__).parents[1]
# The second test starts no thread, and hangs in C, where no handler of a signal runs.
HANGING = """
import ctypes, faulthandler
import pytest
from tests import watchdog
starts = []
@pytest.fixture(scope="session", autouse=True)
def count():
    start = faulthandler.dump_traceback_later
    faulthandler.dump_traceback_later = lambda *a, **k: (starts.append(a), start(*a, **k))
@pytest.mark.parametrize("n", range(5))
def test_short(n):
    assert starts == []
def test_that_hangs():
    ctypes.PyDLL(None).pause()
"""
PLUGIN = """
from tests import watchdog
watchdog.LIMIT = 3.0
def pytest_configure(config):
    config.pluginmanager.register(watchdog.Watchdog())
"""


@pytest.mark.skipif(os.name != "posix", reason="Windows has no pause()")
def test_test_that_hangs_outside_python_ends_the_process_with_its_stack(tmp_path: Path) -> None:
    (tmp_path / "pyproject.toml").write_text("[tool.pytest.ini_options]\n")
    (tmp_path / "conftest.py").write_text(PLUGIN)
    (tmp_path / "test_hanging.py").write_text(HANGING)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(tmp_path)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 1
    assert done.stdout.startswith(".....")
    assert "Timeout (0:00:03)!" in done.stderr
    assert "in test_that_hangs" in done.stderr


def test_time_limit_ends_with_the_tests_of_a_file(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = list[str]()
    monkeypatch.setattr(faulthandler, "dump_traceback_later", lambda *_, **__: calls.append("start"))
    monkeypatch.setattr(faulthandler, "cancel_dump_traceback_later", lambda: calls.append("end"))
    dog, item = watchdog.Watchdog(), request.node
    for following in (item, item, None):
        protocol = dog.pytest_runtest_protocol(item, following)
        next(protocol)
        with pytest.raises(StopIteration):
            next(protocol)
    assert calls == ["start", "end"]
