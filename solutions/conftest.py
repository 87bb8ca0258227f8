"""nbmake runs the solutions strictly: a check that fails raises."""

import os

import pytest

STRICT = "COURSE_STRICT"


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Make checks strict for the kernels of this folder's notebooks."""
    os.environ[STRICT] = "1"


def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Let other tests' checks be as they are."""
    os.environ.pop(STRICT, None)
