"""CPU time of submissions of each week, solution and mutants, compared with nbgrader."""

import json
import os
import re
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import Any

from course_lib.authoring.edits import mutants, operators
from course_lib.course.material import solutions_dir
from course_lib.grading.run.run import Job, plan_scenarios, run_scenarios
from tests.notebooks.graded import STUDENT, WEEKS, catalog, cells_of, solution


def submissions(week: str, max_count: int) -> list[list[str]]:
    """Return the cells of the solution and of so many of its mutants at most, spread over all of them."""
    cells, names = cells_of(solution(week)), "|".join(task.name for task in catalog().tasks_of_week(week))
    positions = [
        n for n, cell in enumerate(cells) if re.search(rf"^(class|def) ({names})\b", cell, re.MULTILINE)
    ]
    mutated = [
        [*cells[:position], mutant, *cells[position + 1 :]]
        for position in positions
        for _, mutant in mutants(cells[position], operators(solutions_dir()))
    ]
    step = max(len(mutated) // max(max_count, 1), 1)
    return [cells, *mutated[::step][:max_count]]


def cost(cells: list[str], week: str) -> tuple[float, float]:
    """Return the CPU time [s] of all processes in the jail, and of the grader."""
    steps = plan_scenarios(catalog().tasks_of_week(week), catalog(), with_hidden=True)
    begun = time.process_time()
    evidence = run_scenarios(Job(tuple(cells), STUDENT, steps, catalog().course.limits))
    return evidence.usage.cpu_seconds, time.process_time() - begun


def kernel(top: Path) -> Path:
    """Write the spec of a kernel with the kit for nbgrader, whose environment lacks it."""
    folder = top / "jupyter/kernels/python3"
    folder.mkdir(parents=True)
    start = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    spec = {"argv": start, "display_name": "Python 3", "language": "python"}
    (folder / "kernel.json").write_text(json.dumps(spec))
    return top / "jupyter"


def nbgrader_cost(top: Path, python: str, week: str, text: str) -> float:
    """[s] of CPU of `nbgrader autograde` for one submission, all its processes together, less its start."""
    for folder in ("source", *(f"submitted/s{number}" for number in range(2))):
        (top / folder / week).mkdir(parents=True)
        (top / folder / week / f"{week}.ipynb").write_text(text)
    path = os.pathsep.join([str(Path(python).parent), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "JUPYTER_PATH": str(kernel(top))}
    script = [python, "-m", "nbgrader"]
    quiet: dict[str, Any] = {"cwd": top, "check": True, "capture_output": True, "env": environment}
    subprocess.run([*script, "generate_assignment", week, "--create"], **quiet)
    for_one, for_two = (
        _children_cost([*script, "autograde", week, "--create", "--force", f"--student={students}"], quiet)
        for students in ("s0", "s*")
    )
    texts = [path.read_text() for path in top.glob(f"autograded/*/{week}/{week}.ipynb")]
    assert len(texts) == 2
    assert not [text for text in texts if '"output_type": "error"' in text], week
    return for_two - for_one


def _children_cost(command: list[str], options: dict[str, Any]) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, **options)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def rows(max_count: int) -> Iterator[tuple[str, float, str]]:
    """Yield (week, median of the jail's CPU [s], the row) for each week."""
    cost(cells_of(solution(WEEKS[0])), WEEKS[0])  # start of the template process
    for week in WEEKS:
        cost(cells_of(solution(week)), week)  # imports of the template for a week's first submission
        jail, grader = zip(*(cost(cells, week) for cells in submissions(week, max_count)), strict=True)
        middle = median(jail)
        yield (
            week,
            middle,
            (
                f"{week}: {len(jail)} submissions, CPU of one: {middle:.2f} s in the jail "
                f"({min(jail):.2f} to {max(jail):.2f}), {median(grader):.2f} s in the grader"
            ),
        )
