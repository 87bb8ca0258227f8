"""Which worker of pytest-xdist runs which files.

Pages draw in software, and their live nodes work for as long as a test waits: a few of them keep all
processors busy. Most other tests wait without work. In the order of their names, all workers would run
browsers at the same time, and later all of them would wait.
"""

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
