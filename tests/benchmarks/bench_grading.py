"""Grade a class: speed compared with nbgrader and Otter, memory, killed processes, and Dask.

The peers need packages that fight with the kit's, so they live in an environment of their own:

    python -m venv peers && peers/bin/pip install nbgrader otter-grader ipykernel
    python -m tests.benchmarks.bench_grading --peers peers/bin/python --count 1000 --kills 20

The first rows are the CPU of real submissions, week by week (--mutants 0 --weeks-only is quickest).
nbgrader runs the same solutions there, in a kernel that has the kit.
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil

from course_lib.grading.grade import grade
from course_lib.grading.store import Course
from tests.benchmarks.graded_weeks import nbgrader_cost, rows
from tests.benchmarks.table import Row, markdown
from tests.grading.conftest import CHECKS, COURSE, HIDDEN
from tests.grading.graders import fingerprint, start_grader, write_class
from tests.notebooks.graded import cells_of, solution

QUESTIONS = range(4)  # the same for all: a function that doubles, adds, ...; a public and a hidden check each
POINTS = "\n".join(f"q{n} = 25" for n in QUESTIONS)
EQUAL_COURSE = f"""
title = "Equal questions"
time_zone = "UTC"
[weeks.week01]
title = "Functions"
[weeks.week01.points]
{POINTS}
"""
EQUAL_TASKS = """
from course_lib.grading.task import Call, Scenario, Task
from course_lib.grading import expect_value
TASKS = tuple(Task(f"week01.q{n}", "Q", "function", f"q{n}", ("a", "b", "c"), (
    Scenario("public", calls=(Call(2.0),), checks=(expect_value(2.0 + n),)),)) for n in range(4))
"""
EQUAL_HIDDEN = """
from course_lib.grading.task import Call, Scenario
from course_lib.grading import expect_value
HIDDEN = {f"week01.q{n}": (Scenario("hidden", calls=(Call(-7.0),), checks=(expect_value(n - 7.0),)),)
          for n in range(4)}
"""
OTTER_TEST = """
OK_FORMAT = True
test = {{"name": "q{n}", "points": 25, "suites": [{{"cases": [
    {{"code": ">>> bool(abs(q{n}(2.0) - {public}) < 1e-6)\\nTrue", "hidden": False}},
    {{"code": ">>> bool(abs(q{n}(-7.0) - {hidden}) < 1e-6)\\nTrue", "hidden": True}}],
    "scored": True, "setup": "", "teardown": "", "type": "doctest"}}]}}
"""


def answer(number: int) -> str:
    return f"import numpy as np\ndef q{number}(x):\n    return float(np.add(x, {number}))\n"


def checks(number: int) -> str:
    values = {2.0: 2.0 + number, -7.0: number - 7.0}
    return "".join(f"assert abs(q{number}({x}) - {y}) < 1e-6\n" for x, y in values.items())


def notebook(cells: list[dict[str, object]]) -> str:
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return json.dumps(
        {"nbformat": 4, "nbformat_minor": 5, "metadata": {"kernelspec": kernel}, "cells": cells}
    )


def cell(source: str, name: str, **nbgrader: object) -> dict[str, object]:
    about = {"nbgrader": {"schema_version": 3, "grade_id": name, **nbgrader}} if nbgrader else {}
    code: dict[str, object] = {"cell_type": "code", "execution_count": None, "outputs": []}
    return {**code, "id": name, "metadata": about, "source": source}


def for_nbgrader() -> str:
    cells = []
    for n in QUESTIONS:
        cells.append(cell(answer(n), f"a{n}", grade=False, solution=True, locked=False, task=False))
        cells.append(cell(checks(n), f"t{n}", grade=True, solution=False, locked=True, task=False, points=25))
    return notebook(cells)


def plain() -> str:
    return notebook([cell(answer(n), f"a{n}") for n in QUESTIONS])


def make_course(top: Path, settings: str, tasks: str, hidden: str) -> Course:
    for name, text in {
        "exercises/course.toml": settings,
        "exercises/checks/week01.py": tasks,
        "solutions/checks/week01.py": hidden,
    }.items():
        (top / "course" / name).parent.mkdir(parents=True, exist_ok=True)
        (top / "course" / name).write_text(text)
    return Course(top / "course/exercises", top / "course/solutions")


def seconds(action: Callable[[], object]) -> float:
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


def ours(top: Path, count: int) -> float:
    """[s] for one more submission of a class, on one job with its jail; reports are written too.

    The jail's root depends on the class and the output folder, so a first submission there pays the
    start.
    """
    course = make_course(top, EQUAL_COURSE, EQUAL_TASKS, EQUAL_HIDDEN)
    for number in range(count):  # a comment each: identical files would be run once
        folder = top / "in" / f"s{number}"
        folder.mkdir(parents=True)
        text = notebook([cell(f"# {number}\n", "c"), *(cell(answer(n), f"a{n}") for n in QUESTIONS)])
        (folder / "week01_exercise.ipynb").write_text(text)
    grade(top / "in", top / "out", jobs=1, only="s0/*", course=course)
    took = seconds(lambda: grade(top / "in", top / "out", jobs=1, course=course))
    marks = (top / "out/gradebook.csv").read_text().count(",100.0,100.0,0,0.0,100.0,graded")
    assert marks == count, f"{marks} of {count} got full marks"
    return took / count


def nbgrader(top: Path, python: str, count: int) -> float:
    """[s] for one submission of `nbgrader autograde` in batch, its start included."""
    for folder in ("source/ps", *(f"submitted/s{number}/ps" for number in range(count))):
        (top / folder).mkdir(parents=True)
        (top / folder / "week01.ipynb").write_text(for_nbgrader())
    script = [python, "-m", "nbgrader"]
    path = os.pathsep.join([str(Path(python).parent), os.environ["PATH"]])  # it calls alembic by name
    quiet = {"cwd": top, "check": True, "capture_output": True, "env": {**os.environ, "PATH": path}}
    subprocess.run([*script, "generate_assignment", "ps", "--create"], **quiet)  # type: ignore[call-overload]
    run = [*script, "autograde", "ps", "--create"]
    took = seconds(lambda: subprocess.run(run, **quiet))  # type: ignore[call-overload]
    assert len(list(top.glob("autograded/*/ps/week01.ipynb"))) == count
    return took / count


def otter(top: Path, python: str, count: int) -> float:
    """[s] for one submission of Otter in one process, imports paid."""
    (top / "tests").mkdir(parents=True)
    for n in QUESTIONS:
        (top / "tests" / f"q{n}.py").write_text(OTTER_TEST.format(n=n, public=2.0 + n, hidden=n - 7.0))
    (top / "week01.ipynb").write_text(plain())
    code = f"""
import time, zipfile, otter.api, os
with zipfile.ZipFile("autograder.zip", "w") as archive:
    for n in range(4):
        archive.write(f"tests/q{{n}}.py")
    archive.writestr("otter_config.json", "{{}}")
start = time.perf_counter()
for _ in range({count}):
    got = otter.api.grade_submission("week01.ipynb", "autograder.zip", quiet=True)
    assert got.total == 100, got.total
print((time.perf_counter() - start) / {count})
"""
    done = subprocess.run([python, "-c", code], cwd=top, check=True, capture_output=True, text=True)
    return float(done.stdout.split()[-1])


def weeks(top: Path, most: int, python: str | None) -> None:
    """Print a row per week: CPU of its solution and mutants, and of nbgrader for the solution."""
    for week, ours, row in rows(most):
        print(row)
        if python:
            cells = [cell(source, f"c{n}") for n, source in enumerate(cells_of(solution(week)))]
            test = cell("assert True", "t", grade=True, solution=False, locked=True, task=False, points=1)
            theirs = nbgrader_cost(top / week, python, week, notebook([*cells, test]))
            print(f"    nbgrader: {theirs:.2f} s for the solution, {theirs / ours:.0f} times ours")


def peer_rows(top: Path, python: str | None, count: int = 20) -> Iterator[Row]:
    """Yield the time of a submission of four equal questions, ours in its jail."""
    own = 1e3 * ours(top / "ours", count)
    peers = (
        {one.__name__: 1e3 * one(top / one.__name__, python, count) for one in (nbgrader, otter)}
        if python
        else {}
    )
    yield Row("grading a submission of four functions", "ms", own, peers)


def class_size(top: Path, course: Course, count: int, jobs: int, *, dask: str | None = None) -> Path:
    """Grade the class and print the rate and the peak memory of the grader."""
    out, me = top / f"out{jobs}{'dask' * bool(dask)}", psutil.Process()
    before = me.memory_info().rss
    took = seconds(lambda: grade(top / "in", out, jobs=jobs, dask=dask, course=course))
    grown = (me.memory_info().rss - before) / 2**20
    where = "2 Dask workers" if dask else f"{jobs} jobs"
    print(f"{count} submissions, {where}: {took:.0f} s, {count / took:.1f}/s, memory +{grown:.0f} MB")
    return out


def killed(top: Path, course: Course, times: int) -> Path:
    """Kill the grader at random moments, going on each time."""
    out, chance = top / "killed", random.Random(0)
    for _ in range(times):
        grader = start_grader(course, out, 2, "resume")
        time.sleep(1.5 + chance.random() * 3)
        os.kill(grader.pid, signal.SIGKILL)
        grader.communicate()
    last = start_grader(course, out, 2, "resume")
    said = last.communicate()[0]
    assert last.returncode == 0, said
    return out


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="submissions of the class")
    parser.add_argument("--equal", type=int, default=20, help="submissions beside the peers")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--mutants", type=int, default=8, help="of each week's solution")
    parser.add_argument("--weeks-only", action="store_true")
    parser.add_argument("--peers", type=os.path.abspath, help="a Python that has nbgrader and otter-grader")
    options = parser.parse_args()
    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]  # a text stream
    with tempfile.TemporaryDirectory() as folder:
        top = Path(folder)
        weeks(top / "weeks", options.mutants, options.peers)
        if options.weeks_only:
            return
        print(markdown(peer_rows(top, options.peers, options.equal)))
        course = make_course(top, COURSE, CHECKS, HIDDEN)
        write_class(top, options.count)
        two = fingerprint(class_size(top, course, options.count, 2))
        assert fingerprint(class_size(top, course, options.count, 1)) == two
        assert fingerprint(killed(top, course, options.kills)) == two
        print(f"1 and 2 jobs, and {options.kills} kills: identical evidence and marks")
        from distributed import LocalCluster

        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
            out = class_size(top, course, options.count, 2, dask=cluster.scheduler_address)
        assert fingerprint(out) == two
        print("2 Dask workers: identical evidence and marks")


if __name__ == "__main__":
    main()
