"""Workers of pytest-xdist run browsers beside other files, long files first, and collect no file in vain."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.scheduling import BROWSER, LONGEST, BrowsersBesideOthers, may_be_slow, pytest_ignore_collect

BROWSER_FILES = [f"tests/browser/test_{name}.py" for name in "bcd"]
FILES = ["tests/book/test_a.py", *BROWSER_FILES, *(f"tests/ros/test_{name}.py" for name in "efghijk")]


class Worker:
    """Records the tests that it is to run, by their numbers."""

    def __init__(self) -> None:
        self.tests = list[int]()
        self.shutting_down = False
        self.gateway = SimpleNamespace(id="worker")

    def send_runtest_some(self, numbers: list[int]) -> None:
        self.tests += numbers

    def shutdown(self) -> None:
        self.shutting_down = True


@pytest.fixture
def order(
    pytestconfig: pytest.Config, monkeypatch: pytest.MonkeyPatch
) -> Callable[[list[str]], list[list[str]]]:
    """Distribute files of one test each, all of which take equally long, to two workers."""
    monkeypatch.setattr(pytestconfig.option, "tx", ["2*popen"])
    monkeypatch.setattr(pytestconfig.option, "loadscopereorder", False)

    def order(files: list[str]) -> list[list[str]]:
        scheduler, workers = BrowsersBesideOthers(pytestconfig), [Worker(), Worker()]
        for worker in workers:
            node: Any = worker
            scheduler.add_node(node)
            scheduler.add_node_collection(node, [f"{file}::test" for file in files])
        scheduler.schedule()
        for step in range(len(files)):
            for worker in workers:
                node = worker
                if step < len(worker.tests):
                    scheduler.mark_test_complete(node, worker.tests[step])
        return [[files[number] for number in worker.tests] for worker in workers]

    return order


def test_every_second_worker_starts_with_browsers_and_helps_the_others_afterwards(
    order: Callable[[list[str]], list[list[str]]],
) -> None:
    assert ["".join(file[-4] for file in files) for files in order(FILES)] == ["bcdgik", "aefhj"]


def test_longest_files_start_first_on_the_workers_of_their_kind(
    order: Callable[[list[str]], list[list[str]]],
) -> None:
    first, second = order([*FILES, *reversed(LONGEST)])
    browsers = [file for file in LONGEST if file.startswith(BROWSER)]
    assert first[: len(browsers)] == browsers
    assert second[: len(LONGEST) - len(browsers)] == [file for file in LONGEST if file not in browsers]


@pytest.mark.parametrize("file", LONGEST)
def test_long_file_has_slow_tests(file: str, pytestconfig: pytest.Config) -> None:
    assert may_be_slow(pytestconfig.rootpath / file)


@pytest.mark.parametrize("mark", ["slow", "sample(3)", ""])
@pytest.mark.parametrize("selection", ["slow", "not slow", "slow or browser", ""])
def test_file_without_slow_tests_is_left_out_if_only_these_are_selected(
    mark: str, selection: str, tmp_path: Path, pytestconfig: pytest.Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pytestconfig.option, "markexpr", selection)
    path = tmp_path / "test_one.py"
    path.write_text(f"import pytest\n{mark and '@pytest.mark.'}{mark}\ndef test_one() -> None: ...\n")
    assert bool(pytest_ignore_collect(path, pytestconfig)) == (selection == "slow" and not mark)
