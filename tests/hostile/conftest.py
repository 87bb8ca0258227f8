"""A class of hostile, broken and honest submissions, graded once, with canaries around it."""

import csv
import hashlib
import json
import os
import socket
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

import course_lib
from course_lib.grading.grade import grade
from course_lib.grading.grade_one import Course
from course_lib.grading.jail.launch import shared_template
from tests.grading.conftest import CHECKS, COURSE, HIDDEN, RIGHT
from tests.hostile.submissions import ALL

SECRET = "canary-4711"
HONEST = ("aaa_honest", "mmm_honest", "zzz_honest")
IN_TIME = "2026-10-11 12:00:00 UTC"


@dataclass
class Graded:
    """What came of the class, and of the canaries."""

    top: Path
    rows: dict[str, dict[str, str]]
    connections: list[Any] = field(default_factory=list)
    library_before: str = ""

    def result(self, student: str) -> Any:
        return json.loads((self.top / "out/results" / student / "week01_exercise.json").read_text())

    def report(self, student: str) -> str:
        return (self.top / "out/reports" / student / "week01_exercise.html").read_text()


def library_hash() -> str:
    files = sorted(Path(course_lib.__file__).parent.glob("grading/**/*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()


def notebook(*cells: str, student: str) -> str:
    metadata = {"course": {"student": student}}
    rows = [{"cell_type": "code", "source": cell} for cell in cells]
    return json.dumps({"nbformat": 4, "nbformat_minor": 5, "metadata": metadata, "cells": rows})


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
    prelude = "".join(f"{name} = {str(value)!r}\n" for name, value in places.items())
    for name, text in {
        "course/exercises/course.toml": COURSE.replace("[limits]", "[limits]\ntotal_seconds = 12"),
        "course/exercises/checks/week01.py": CHECKS,
        "course/solutions/checks/week01.py": f"SECRET = {SECRET!r}\n{HIDDEN}",
    }.items():
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).write_text(text)
    right = RIGHT.split("# next cell\n")
    for student in HONEST:
        _hand_in(top, student, notebook(*right, student=student))
    for entry in ALL:
        cells = [entry.change(cell) for cell in right]
        is_magic = entry.cell.startswith("%%")
        attack = [entry.cell if is_magic else prelude + entry.cell] if entry.cell else []
        _hand_in(top, entry.name, notebook(*cells[:1], *attack, *cells[1:], student=entry.name))
    made = Graded(top, {}, library_before=library_hash())
    threading.Thread(target=_count, args=(listener, made.connections), daemon=True).start()
    grade(top / "in", top / "out", jobs=2, course=Course(top / "course/exercises", top / "course/solutions"))
    with (top / "out/gradebook.csv").open(newline="") as file:
        made.rows = {row["student"]: row for row in csv.DictReader(file)}
    yield made
    listener.close()
    del os.environ["GRADER_TOKEN"]
    shared_template().stop()


def _hand_in(top: Path, student: str, text: str) -> None:
    path = top / "in" / student / "week01_exercise.ipynb"
    path.parent.mkdir(parents=True)
    path.write_text(text)
    path.with_name("timestamp.txt").write_text(IN_TIME)


def _count(listener: socket.socket, connections: list[Any]) -> None:
    while True:
        try:
            connections.append(listener.accept())
        except OSError:
            return
