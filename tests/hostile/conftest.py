"""A class of hostile, broken and honest submissions, graded once, with canaries around it."""

import csv
import hashlib
import json
import os
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

import course_lib
from course_lib.grading.grade import grade
from course_lib.grading.jail.filters import CHILD_SUBREAPER, prctl
from course_lib.grading.jail.launch import shared_template
from tests.grading.conftest import COURSE, HIDDEN, RIGHT, write_course
from tests.hostile.files import FILES
from tests.hostile.submissions import ALL

SECRET = "canary-4711"
HONEST = ("aaa_honest", "mmm_honest", "zzz_honest")
# Limit of CPU time for cells that hang. Waiting for a processor on a busy machine is not counted.
LIMITS = "cell_seconds = 2\nscenario_seconds = 2\ntotal_seconds = 40"
IN_TIME = "2026-10-11 12:00:00 UTC"


@dataclass
class Graded:
    """Outcome of the class and of the canaries."""

    top: Path
    rows: dict[str, dict[str, str]]
    connections: list[Any] = field(default_factory=list)
    library_before: str = ""
    left: set[int] = field(default_factory=set)  # processes
    hides_names: bool = True

    def result(self, student: str) -> Any:
        return json.loads((self.top / "out/results" / student / "week01_exercise.json").read_text())

    def report(self, student: str) -> str:
        return (self.top / "out/reports" / student / "week01_exercise.html").read_text()


def library_hash() -> str:
    files = sorted(Path(course_lib.__file__).parent.glob("grading/**/*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()


def notebook(*cells: str, student: str) -> bytes:
    metadata = {"course": {"student": student}}
    rows = [{"cell_type": "code", "source": cell} for cell in cells]
    return json.dumps({"nbformat": 4, "nbformat_minor": 5, "metadata": metadata, "cells": rows}).encode()


@pytest.fixture(scope="session")
def graded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Graded]:
    """The whole class, graded on two workers."""
    top = tmp_path_factory.mktemp("hostile")
    (top / "secret.txt").write_text(SECRET)
    os.environ["GRADER_TOKEN"] = SECRET
    listener = socket.create_server(("127.0.0.1", 0))
    places = {
        "TOP": top,
        "PORT": listener.getsockname()[1],
        "GRADER": os.getpid(),
        "LIB": course_lib.__file__,
    }
    settings = COURSE.replace("cell_seconds = 30\nscenario_seconds = 30", LIMITS)
    course = write_course(top / "course", settings, f"SECRET = {SECRET!r}\n{HIDDEN}")
    _hand_in_all(top, "".join(f"{name} = {str(value)!r}\n" for name, value in places.items()))
    made = Graded(top, {}, library_before=library_hash())
    threading.Thread(target=_count, args=(listener, made.connections), daemon=True).start()
    made.hides_names = shared_template().isolation.hides_names  # its process stays
    with orphans_become_ours():
        before = descendants()
        grade(top / "in", top / "out", jobs=2, course=course)
        ends = time.monotonic() + 20  # [s] within which a killed process has gone, on any machine
        while (left := descendants() - before) and time.monotonic() < ends:
            time.sleep(0.1)
    made.left = left
    with (top / "out/gradebook.csv").open(newline="") as file:
        made.rows = {row["student"]: row for row in csv.DictReader(file)}
    yield made
    listener.close()
    del os.environ["GRADER_TOKEN"]
    shared_template().stop()


@contextmanager
def orphans_become_ours() -> Iterator[None]:
    """Adopt processes whose parent has ended."""
    prctl(CHILD_SUBREAPER, 1)
    try:
        yield
    finally:
        prctl(CHILD_SUBREAPER, 0)


def descendants() -> set[int]:
    """Return all running descendants of this process, except Python's resource tracker."""
    parents: dict[int, int] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # it has just ended
            state, parent, *_ = (folder / "stat").read_text().rpartition(")")[2].split()
            if state != "Z" and b"resource_tracker" not in (folder / "cmdline").read_bytes():
                parents[int(folder.name)] = int(parent)
    found, more = set[int](), {os.getpid()}
    while more:
        more = {pid for pid, parent in parents.items() if parent in more}
        found |= more
    return found


def _hand_in_all(top: Path, prelude: str) -> None:
    """Write the submissions of the class; `prelude` defines the paths for the attacks."""
    right = RIGHT.split("# next cell\n")
    for student in HONEST:
        _hand_in(top, student, notebook(*right, student=student))
    for entry in ALL:
        cells = [entry.change(cell) for cell in right]
        is_magic = entry.cell.startswith("%%")
        attack = [entry.cell if is_magic else prelude + entry.cell] if entry.cell else []
        claimed = entry.claims or entry.name
        _hand_in(top, entry.name, notebook(*cells[:1], *attack, *cells[1:], student=claimed))
    for sent in FILES:
        _hand_in(top, sent.student, sent.data, sent.file)


def _hand_in(top: Path, student: str, data: bytes, name: str = "week01_exercise.ipynb") -> None:
    path = top / "in" / student / name
    path.parent.mkdir(parents=True)
    path.write_bytes(data)
    path.with_name("timestamp.txt").write_text(IN_TIME)


def _count(listener: socket.socket, connections: list[Any]) -> None:
    while True:
        try:
            connections.append(listener.accept())
        except OSError:
            return
