"""A class with constructed results, and servers of its marking page."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.request import Request, urlopen

from course_lib.grading.records import (
    Attempt,
    CheckResult,
    Judgement,
    ReceiptTime,
    Result,
    Submission,
    TaskResult,
)
from course_lib.grading.reports.report import report
from course_lib.grading.reports.tables import write_tables
from course_lib.grading.store import Course, catalog_of
from course_lib.grading.submissions.submission import content_hash
from course_lib.grading.task import Catalog
from tests.processes import Program

POINTS = """
title = "A course"
time_zone = "Europe/Paris"
[weeks.week05]
title = "Kinds"
[weeks.week05.points]
essay = 40
motto = 60
"""
TASKS = """
from course_lib.grading.task import Row, Scenario, Task
from course_lib.grading import expect_text

HINTS = ("a", "b", "c")
TASKS = (
    Task("week05.essay", "Why TF?", "written", "essay", HINTS,
         rubric=(Row("names the parts", 5), Row("an example", 15))),
    Task("week05.motto", "A motto", "text", "motto", HINTS, scenarios=(
        Scenario("public", checks=(expect_text("robot"),)),)),
)
"""
CODE = "essay = 'Frames.'"
ESSAY, MOTTO = "week05.essay", "week05.motto"
SERVE = """
import sys
from pathlib import Path
from course_lib.grading.marking.server import serve
from course_lib.grading.store import Course
top, out = Path(sys.argv[1]), Path(sys.argv[2])
serve(out, port=int(sys.argv[3]), browser=False, course=Course(top / "exercises", top / "solutions"))
"""
ADDRESS = r"http://127\.0\.0\.1:\d+/[\w-]+/"


def write_kinds(top: Path, tasks: str = TASKS) -> Course:
    """Write a course with one manually marked task and one checked task."""
    for name, text in {
        "exercises/course.toml": POINTS,
        "exercises/checks/week05.py": tasks,
        "solutions/checks/week05.py": "HIDDEN = {}",
    }.items():
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).write_text(text)
    return Course(top / "exercises", top / "solutions")


def write_results(
    course: Course, out: Path, students: Sequence[str], code: str = "essay = 'Frames.'"
) -> None:
    """Write results, reports and tables of students who submitted the same code."""
    catalog = catalog_of(course)
    cells = [{"cell_type": "code", "source": code}, {"cell_type": "code", "source": "motto = 'Be kind.'"}]
    data = json.dumps({"nbformat": 4, "metadata": {}, "cells": cells}).encode()
    for student in students:
        path = out.parent / "in" / student / "week05_exercise.ipynb"
        path.parent.mkdir(parents=True)
        path.write_bytes(data)
        received = ReceiptTime(None, "unknown")
        submission = Submission(
            student, "week05_exercise", path, received, sha256=content_hash(data, {}), key="none"
        )
        attempts, judgement = (Attempt("none", received),), _judgement(catalog)
        result = Result(submission, "graded", judgement=judgement, attempts=attempts, digest="d")
        result.write(out)
        report(result, out, catalog)
    write_tables(out, catalog.course.zone)


def _judgement(catalog: Catalog) -> Judgement:
    essay, motto = (catalog.tasks[name] for name in (ESSAY, MOTTO))
    failed = CheckResult(
        "the text has 'robot'", "public", False, 1.0, 0.0, "it has no 'robot'", "a text lacks a word"
    )
    tasks = (
        TaskResult(ESSAY, essay.title, 40, False, (), rubric=essay.rubric),
        TaskResult(MOTTO, motto.title, 60, False, (failed,)),
    )
    return Judgement(tasks, "none", (), "", {})


@dataclass
class Answer:
    """The response of a server."""

    code: int
    text: str
    headers: Any

    @property
    def content(self) -> Any:
        return json.loads(self.text)


class Served:
    """The page's server in a separate process."""

    def __init__(self, course: Course, out: Path, port: int = 0) -> None:
        words = (str(course.exercises.parent), str(out), str(port))
        self.out = out
        self.process = Program([sys.executable, "-c", SERVE, *words], stdout=subprocess.PIPE, env=os.environ)
        self.address = self.process.find(ADDRESS)

    @property
    def port(self) -> int:
        return int(self.address.split(":")[2].split("/")[0])

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()

    def items(self) -> list[Any]:
        return list(self.ask("api/queue?since=0").content["items"])

    def ask(self, path: str, body: object = None, **headers: str) -> Answer:
        """Request a path below the address, as the page does; with a body, save it."""
        return self.ask_plainly(self.address + path, body, **headers)

    def ask_plainly(self, url: str, body: object = None, **headers: str) -> Answer:
        data = body if isinstance(body, bytes) or body is None else json.dumps(body).encode()
        own = {"Origin": f"http://127.0.0.1:{self.port}", "Content-Type": "application/json"} if body else {}
        given = {name.replace("_", "-"): value for name, value in headers.items()}
        request = Request(url, data, {**own, **given})
        try:
            with urlopen(request, timeout=60) as answer:
                return Answer(answer.status, answer.read().decode(), answer.headers)
        except HTTPError as error:
            with error:
                return Answer(error.code, error.read().decode(), error.headers)


@contextmanager
def served(course: Course, out: Path, port: int = 0) -> Iterator[Served]:
    """Serve the page; the process is killed at the end."""
    server = Served(course, out, port)
    try:
        yield server
    finally:
        server.kill()


def save(item: Any, points: float | None, by: str, comment: str = "", row: str = "") -> dict[str, Any]:
    """Return the body of a request that saves one mark."""
    mark = {"row": row, "points": points, "comment": comment}
    return {"by": by, "revision": item["revision"], "marks": [mark]}
