"""Setup of all tests: ROS's names are imported from the stand-in, and kernels need no port.

Also a small disk, and commands in this process.
"""

import gc
import os
import signal
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import hypothesis
import pytest

from course_lib.ros.programs.import_path import install
from tests.kernels import listen_on_files
from tests.patience import PATIENCE
from tests.scheduling import (  # noqa: F401  # two are hooks of pytest
    may_be_slow,
    pytest_ignore_collect,
    pytest_xdist_make_scheduler,
)
from tests.watchdog import Watchdog

if TYPE_CHECKING:
    from tests.once import Once

# Modules imported by tests and their processes are compiled once, even if images disable caching.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # begun behind "&": children would, too
    signal.signal(signal.SIGINT, signal.default_int_handler)
install()
if os.name == "posix":  # Windows has no such sockets
    listen_on_files()
hypothesis.settings.register_profile("untimed", deadline=None)  # a busy machine is no mistake
hypothesis.settings.load_profile("untimed")


def pytest_configure(config: pytest.Config) -> None:
    """Limit the time of all tests, those of notebooks, too."""
    config.pluginmanager.register(Watchdog())


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Exclude permanent objects from garbage collection, which takes 0.4 s each time in the whole suite."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.hookimpl(wrapper=True, optionalhook=True)
def pytest_xdist_auto_num_workers() -> Generator[None, int, int]:
    """Start one worker more than there are processors with `-n logical`.

    Many tests wait for kernels, processes and links: with a worker for each processor, a third of
    the processors' time was left over.
    """
    count = yield
    return count if os.environ.get("PYTEST_XDIST_AUTO_NUM_WORKERS") else count + 1


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the parameter sets of a test as slow that are beyond its sample.

    First, as pytest selects by marks in the same hook.

    Raises:
        UsageError: A slow test is in a file that `pytest -m slow` would leave out.
    """
    seen = Counter[str]()
    for item in items:
        sample = item.get_closest_marker("sample")
        if sample is not None:
            name = item.nodeid.partition("[")[0]
            seen[name] += 1
            if seen[name] > sample.args[0]:
                item.add_marker(pytest.mark.slow)
        if item.get_closest_marker("slow") is not None and not may_be_slow(item.path):
            raise pytest.UsageError(f"{item.nodeid} is slow: write pytest.mark.slow in its own file")


@pytest.fixture(scope="session")
def once(tmp_path_factory: pytest.TempPathFactory) -> "Once":
    """Results that the workers of this session share."""
    from tests.once import Once

    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "once"
    folder.mkdir(exist_ok=True)
    return Once(folder)


@pytest.fixture(scope="module", autouse=True)
def own_values_again() -> Iterator[None]:
    """Remove the values of a student that the modules of notebooks and mistakes give to this process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("course_lib.grading.inputs._values", None)
        yield


@pytest.fixture(autouse=True)
def package_paths() -> Iterator[None]:
    """Restore the search paths of packages, to which a program adds those of its workspace."""
    with pytest.MonkeyPatch.context() as environment:
        for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
            environment.setenv(variable, "")
            environment.delenv(variable)
        yield


@pytest.fixture
def restored_packages() -> Iterator[None]:
    """Remove the types of the packages that a test adds, because other tests list all."""
    from course_lib.ros.messages import definitions

    types = definitions.field_definitions()
    tables: list[dict[Any, Any]] = [definitions.DEFAULTS, definitions.RENAMED, definitions.UNSUPPORTED]
    names, kept_keys = set(types), [set(table) for table in tables]
    folders = list(definitions.FOLDERS)
    yield
    added = set(types) - names
    for name in added:
        del types[name]
    for table, keys in zip(tables, kept_keys, strict=True):
        for key in table.keys() - keys:
            del table[key]
    definitions.FOLDERS[:] = folders
    definitions.definition.cache_clear()
    packages = {name.partition("/")[0] for name in added}
    for module in [module for module in sys.modules if module.partition(".")[0] in packages]:
        del sys.modules[module]


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 160 kB."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ("mount", "-t", "tmpfs", "-o", "size=160k", "tmpfs", str(place))
    if subprocess.run(mount, capture_output=True, check=False, timeout=PATIENCE).returncode:
        pytest.skip("no disk can be mounted here")
    yield place
    subprocess.run(("umount", "-l", str(place)), check=True, timeout=PATIENCE)


class Typed(NamedTuple):
    """A command that has ended."""

    returncode: object
    stdout: str
    stderr: str


@pytest.fixture
def in_process(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Callable[..., Typed]:
    """Run `course WORDS` in this process, which saves most of a second of start-up."""

    from course_lib import cli
    from course_lib.usual_commands import HASH_SEED

    def run(*words: str, cwd: Path) -> Typed:
        monkeypatch.chdir(cwd)
        monkeypatch.setattr(sys, "argv", ["course", *words])
        monkeypatch.setenv("PYTHONHASHSEED", HASH_SEED)  # otherwise `course run` starts this process again
        with pytest.raises(SystemExit) as left:
            cli.main()
        return Typed(left.value.code, *capfd.readouterr())

    return run
