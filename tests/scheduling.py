"""Which files are collected, and which worker of pytest-xdist runs which of them.

Pages draw in software, and their live nodes work for as long as a test waits: a few of them keep all
processors busy. Most other tests wait without work. In the order of their names, all workers would run
browsers at the same time, and later all of them would wait.
"""

import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from xdist.scheduler import LoadFileScheduling  # type: ignore[import-untyped]  # ships no types

BROWSER = "tests/browser/"


class BrowsersBesideOthers(LoadFileScheduling):  # type: ignore[misc]  # as above
    """Assign the files with browsers to every second worker first, and other files to the others.

    A worker runs the files of one kind one after the other: they share a browser and a JupyterLab.
    """

    def _assign_work_unit(self, node: Any) -> None:
        takes_browsers = self.nodes.index(node) % 2 == 0
        own = (file for file in self.workqueue if file.startswith(BROWSER) == takes_browsers)
        self.workqueue.move_to_end(next(own, next(iter(self.workqueue))), last=False)
        super()._assign_work_unit(node)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> BrowsersBesideOthers | None:
    """Use this order where files are distributed."""
    return BrowsersBesideOthers(config, log) if config.getoption("dist") == "loadfile" else None


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leave out files without slow tests if only these are selected.

    To collect all files takes each worker 12 s of processor time, the files with slow tests 4 s.
    """
    if config.getoption("markexpr") != "slow" or collection_path.suffix != ".py":
        return None
    return None if may_be_slow(collection_path) else True


@cache
def may_be_slow(path: Path) -> bool:
    """Return whether a file names a mark of slow tests."""
    return re.search(r"\bmark\.(slow|sample)\b", path.read_text("utf-8")) is not None
