"""Setup of every test: ROS names come from the stand-in, and kernels need no port.

Also a small disk, and commands in this process.
"""

import gc
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import NamedTuple

import hypothesis
import pytest

from course_lib.ros.standin_path import install
from tests.kernels import listen_on_files

# What tests and the processes they start import is compiled once, also where images forbid to keep it.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # begun behind "&": children would, too
    signal.signal(signal.SIGINT, signal.default_int_handler)
install()
if os.name == "posix":  # Windows has no such sockets
    listen_on_files()
hypothesis.settings.register_profile("untimed", deadline=None)  # a busy machine is no mistake
hypothesis.settings.load_profile("untimed")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Keep what is there to stay out of collections of garbage: 0.4 s each, in the whole suite."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 160 kB."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ("mount", "-t", "tmpfs", "-o", "size=160k", "tmpfs", str(place))
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("no disk can be mounted here")
    yield place
    subprocess.run(("umount", "-l", str(place)), check=True)


class Typed(NamedTuple):
    """A command that has ended."""

    returncode: object
    stdout: str
    stderr: str


@pytest.fixture
def in_process(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Callable[..., Typed]:
    """Run `course WORDS` in this process: most of a second cheaper than in one of its own."""

    from course_lib import cli
    from course_lib.tools.run import HASH_SEED

    def run(*words: str, cwd: Path) -> Typed:
        monkeypatch.chdir(cwd)
        monkeypatch.setattr(sys, "argv", ["course", *words])
        monkeypatch.setenv("PYTHONHASHSEED", HASH_SEED)  # otherwise `course run` starts this process again
        with pytest.raises(SystemExit) as left:
            cli.main()
        return Typed(left.value.code, *capfd.readouterr())

    return run
