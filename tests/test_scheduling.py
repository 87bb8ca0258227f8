"""Workers of pytest-xdist run browsers and other files at the same time, and collect no file in vain."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.scheduling import BrowsersBesideOthers, pytest_ignore_collect

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


def test_every_second_worker_starts_with_browsers_and_helps_the_others_afterwards(
    pytestconfig: pytest.Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pytestconfig.option, "tx", ["2*popen"])
    monkeypatch.setattr(pytestconfig.option, "loadscopereorder", False)
    scheduler, workers = BrowsersBesideOthers(pytestconfig), [Worker(), Worker()]
    for worker in workers:
        node: Any = worker
        scheduler.add_node(node)
        scheduler.add_node_collection(node, [f"{file}::test" for file in FILES])
    scheduler.schedule()
    for step in range(len(FILES)):
        for worker in workers:
            node = worker
            if step < len(worker.tests):
                scheduler.mark_test_complete(node, worker.tests[step])
    order = ["".join(FILES[number][-4] for number in worker.tests) for worker in workers]
    assert order == ["bcdgik", "aefhj"]


@pytest.mark.parametrize("mark", ["slow", "sample(3)", ""])
@pytest.mark.parametrize("selection", ["slow", "not slow", "slow or browser", ""])
def test_file_without_slow_tests_is_left_out_if_only_these_are_selected(
    mark: str, selection: str, tmp_path: Path, pytestconfig: pytest.Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pytestconfig.option, "markexpr", selection)
    path = tmp_path / "test_one.py"
    path.write_text(f"import pytest\n{mark and '@pytest.mark.'}{mark}\ndef test_one() -> None: ...\n")
    assert bool(pytest_ignore_collect(path, pytestconfig)) == (selection == "slow" and not mark)
