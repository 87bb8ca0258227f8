"""Which files are collected, and which worker of pytest-xdist runs which of them.

Pages draw in software, and their live nodes work for as long as a test waits: one browser keeps a
processor busy. Tests of networks wait without work. In the order of their names, all workers would
run browsers at the same time, and later all of them would wait.
"""

import re
from functools import cache
from pathlib import Path
from typing import Any, Literal

import pytest
from xdist.scheduler import LoadFileScheduling  # type: ignore[import-untyped]  # ships no types

# Tests that wait for links and processes take a quarter of a processor.
WAITING = ("tests/gateway/", "tests/real/", "tests/ros/dds/", "tests/ros/zenoh/")
BROWSER = "tests/browser/"
# The longest files, first those that take minutes. If one of them began last, the other workers
# would wait for its end.
LONGEST = (
    "tests/browser/test_lessons.py",
    "tests/notebooks/test_answers.py",
    "tests/browser/test_hub.py",
    "tests/browser/test_night.py",
    "tests/browser/test_many_views.py",
    "tests/browser/test_lesson_one.py",
    "tests/authoring/test_new_course.py",
    "tests/browser/test_marking.py",
    "tests/mistakes/test_mistakes.py",
    "tests/browser/test_book.py",
    "tests/ros/test_public_kinds.py",
    "tests/authoring/test_guide.py",
    "tests/browser/test_beside.py",
    "tests/authoring/test_flaws.py",
    # It needs the results of test_answers.py: two workers that began both files together would
    # wait for each other's results in turn.
    "tests/golden/test_golden.py",
)
Kind = Literal["browser", "busy", "waiting"]
# The kinds that the workers run first, and again from the fifth one on. The fourth one runs what
# the processors have time for while browsers and networks wait; two of five drive browsers, whose
# files take almost half of all processor time.
FIRST: tuple[Kind, ...] = ("browser", "busy", "waiting", "busy")
# What a worker takes that has no files of its kind left. A browser and a JupyterLab would be
# started for it.
AFTERWARDS: tuple[Kind, ...] = ("busy", "waiting", "browser")


def kind_of(file: str) -> Kind:
    """Return what a file's tests do most of the time."""
    if file.startswith(BROWSER):
        return "browser"
    return "waiting" if file.startswith(WAITING) else "busy"


class ByKind(LoadFileScheduling):  # type: ignore[misc]  # as above
    """Assign browsers to one worker, waiting tests to another one, and other files to the others.

    A worker runs the files of one kind one after the other: those with browsers share one and a
    JupyterLab. The longest files of each kind come first.
    """

    def _assign_work_unit(self, node: Any) -> None:
        own = FIRST[self.nodes.index(node) % len(FIRST)]

        def order(file: str) -> tuple[bool, int, int]:
            kind = kind_of(file)
            rank = LONGEST.index(file) if file in LONGEST else len(LONGEST)
            return kind != own, AFTERWARDS.index(kind), rank

        self.workqueue.move_to_end(min(self.workqueue, key=order), last=False)
        super()._assign_work_unit(node)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> ByKind | None:
    """Use this order where files are distributed."""
    return ByKind(config, log) if config.getoption("dist") == "loadfile" else None


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
