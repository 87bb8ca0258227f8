"""nbmake runs the solutions strictly: a check that fails raises."""

import os

import pytest

STRICT = "COURSE_STRICT"


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Set checks to strict for the kernels of this folder's notebooks."""
    os.environ[STRICT] = "1"


def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Restore the checks of other tests."""
    os.environ.pop(STRICT, None)
