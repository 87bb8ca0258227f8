"""Right answers without one statement or one imported name: how many crash, and how many of these pass.

    python tests/benchmarks/bench_deletions.py [week01 …]

For each week, over its solution and its other right answers (whole files, and the variants of its
answers): the deletions, the pairs of a deletion and a task that needs it, the crashes, the false
passes (crashes that pass all public checks; each is listed), and the time. It ends with 1 if there
is a false pass.
"""

import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from course_lib.authoring.deletions import (
    Code,
    crash_message,
    deletions,
    false_passes,
    group_deletions,
    rehearsal_without,
)
from course_lib.authoring.edits import apply_changes, read_answers
from course_lib.authoring.rehearsal import rehearse
from course_lib.grading.executors import executors
from course_lib.grading.store import catalog_of, this_course
from course_lib.grading.task import Task

COURSE = this_course()


def right_answers(week: str, tasks: list[Task]) -> Iterator[tuple[str, Code, list[Task]]]:
    """Yield every right answer of a week: its name, its code, and the tasks that it is for."""
    solution = Code.from_notebook(COURSE.solutions / f"{week}_solution.ipynb")
    yield "solution", solution, tasks
    answers = read_answers(COURSE.solutions, week)
    if answers.other_right is not None:
        yield "other_right", Code.from_notebook(answers.other_right), tasks
    by_id = {task.id: task for task in tasks}
    for variant in answers.variants:
        if variant.way and variant.task in by_id:
            task, code = by_id[variant.task], solution
            for position, text in apply_changes(variant, task.name, solution.cells).items():
                code = code.with_cell(position, text)
            yield variant.way, code, [task]


def main(weeks: list[str]) -> int:
    """Print a line for each right answer, and the sums; return the number of false passes."""
    sums = [0, 0, 0, 0]
    with executors(os.cpu_count() or 1, None) as (_, pool, _):
        for week in weeks:
            tasks = [task for task in catalog_of(COURSE).tasks_of_week(week) if not task.rubric]
            for name, code, of in right_answers(week, tasks) if tasks else ():
                begin = time.monotonic()
                tried_deletions = list(deletions(code, of))
                groups = group_deletions(tried_deletions, code, of)
                rehearsals = [rehearsal_without(group, code, week) for group in groups]
                pairs = crashes = false = 0
                for group, rehearsal in zip(
                    groups, pool.map(rehearse, rehearsals, [COURSE] * len(groups)), strict=True
                ):
                    results = {result.task: result for result in rehearsal.results}
                    pairs_of_group = [
                        (deletion, results[task]) for deletion in group for task in deletion.tasks
                    ]
                    pairs += len(pairs_of_group)
                    crashes += sum(
                        bool(crash_message(deletion, result, rehearsal.tracebacks))
                        for deletion, result in pairs_of_group
                    )
                    for deletion_name, task, why in false_passes(group, rehearsal):
                        false += 1
                        print(f"FALSE PASS: {task}, {name}, {deletion_name}: {why}")
                took = time.monotonic() - begin
                print(f"{week}, {name}: {len(tried_deletions)} deletions, {pairs} pairs, {crashes} crashes, "
                      f"{false} false passes, {took:.0f} s", flush=True)  # fmt: skip
                sums = [
                    a + b for a, b in zip(sums, (len(tried_deletions), pairs, crashes, false), strict=True)
                ]
    print("all: {} deletions, {} pairs, {} crashes, {} false passes".format(*sums))
    return sums[3]


if __name__ == "__main__":
    sys.exit(bool(main(sys.argv[1:] or list(catalog_of(COURSE).course.weeks))))
