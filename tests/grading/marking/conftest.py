from collections.abc import Iterator
from pathlib import Path

import pytest

from course_lib.grading.records import Course
from tests.grading.marking.bench import Served, served, write_kinds, write_results


@pytest.fixture
def kinds(tmp_path: Path) -> Course:
    """A course of an essay, which persons mark, and a motto; results of ada and bob."""
    course = write_kinds(tmp_path / "course")
    write_results(course, tmp_path / "out", ("ada", "bob"))
    return course


@pytest.fixture
def server(kinds: Course, tmp_path: Path) -> Iterator[Served]:
    with served(kinds, tmp_path / "out") as running:
        yield running
