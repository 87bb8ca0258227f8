from collections.abc import Iterator
from pathlib import Path

import pytest

from course_lib.grading.store import Course
from tests.grading.marking.bench import Served, served, write_kinds, write_results


@pytest.fixture
def kinds(tmp_path: Path) -> Course:
    """A course of an essay, which is marked by hand, and a motto; results of ada and bob."""
    course = write_kinds(tmp_path / "course")
    write_results(course, tmp_path / "out", ("ada", "bob"))
    return course


@pytest.fixture(scope="module")
def unmarked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server of the same results for all tests of a file that save nothing: to start one costs most."""
    top = tmp_path_factory.mktemp("unmarked")
    course = write_kinds(top / "course")
    write_results(course, top / "out", ("ada", "bob"))
    with served(course, top / "out") as running:
        yield running


@pytest.fixture
def server(kinds: Course, tmp_path: Path) -> Iterator[Served]:
    with served(kinds, tmp_path / "out") as running:
        yield running
