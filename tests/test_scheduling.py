"""Workers of pytest-xdist run files of different kinds at a time, long ones first."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.scheduling import LONGEST, WAITING, ByKind, kind_of, may_be_slow, pytest_ignore_collect

BROWSER_FILES = [f"tests/browser/test_{name}.py" for name in "bcd"]
WAITING_FILES = [f"tests/gateway/test_{name}.py" for name in "ef"]
FILES = [
    "tests/book/test_a.py",
    *BROWSER_FILES,
    *WAITING_FILES,
    *(f"tests/ros/test_{x}.py" for x in "ghijkl"),
]
Order = Callable[[list[str], int], list[list[str]]]


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
def order(pytestconfig: pytest.Config, monkeypatch: pytest.MonkeyPatch) -> Order:
    """Distribute files with one test each, all of which take equally long, to workers."""
    monkeypatch.setattr(pytestconfig.option, "loadscopereorder", False)

    def order(files: list[str], count: int) -> list[list[str]]:
        monkeypatch.setattr(pytestconfig.option, "tx", [f"{count}*popen"])
        scheduler, workers = ByKind(pytestconfig), [Worker() for _ in range(count)]
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


@pytest.mark.parametrize(
    ("count", "expected"),
    [
        (1, ["bcdaghijklef"]),
        (2, ["bcdike", "aghjlf"]),
        (3, ["bcdj", "aghk", "efil"]),
        (4, ["bcd", "ahj", "efk", "gil"]),
        (5, ["bdk", "ahl", "ef", "gi", "cj"]),
    ],
)
def test_each_worker_starts_with_files_of_one_kind_and_helps_the_others_afterwards(
    count: int, expected: list[str], order: Order
) -> None:
    assert ["".join(file[-4] for file in files) for files in order(FILES, count)] == expected


@pytest.mark.parametrize("kind", ["browser", "busy"])
def test_longest_files_of_each_kind_start_first(kind: str, order: Order) -> None:
    (files,) = order([*FILES, *reversed(LONGEST)], 1)
    expected = [file for file in LONGEST if kind_of(file) == kind]
    assert [file for file in files if kind_of(file) == kind][: len(expected)] == expected


def test_golden_outputs_follow_the_answers_whose_results_they_share() -> None:
    busy = [file for file in LONGEST if kind_of(file) == "busy"]
    assert (busy[0], busy[-1]) == ("tests/notebooks/test_answers.py", "tests/golden/test_golden.py")


@pytest.mark.parametrize("folder", WAITING)
def test_folder_of_waiting_tests_exists(folder: str, pytestconfig: pytest.Config) -> None:
    assert (pytestconfig.rootpath / folder).is_dir()


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
