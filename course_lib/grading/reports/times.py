"""Processor time of scenarios and checks, over all submissions of an exercise."""

import json
from collections import defaultdict
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from course_lib.course.state import write_whole
from course_lib.foreign import read_json
from course_lib.grading.judge import CHECK_SECONDS, Judgement
from course_lib.grading.records import check_times_path
from course_lib.grading.run.run import read_usage

SLOW = CHECK_SECONDS / 5  # [s] of a check, from which on it may fail on a slower machine
Name = tuple[str, ...]  # task and scenario, and of a check its title


@dataclass(frozen=True)
class Spent:
    """The processor time of one scenario or check: how often it was measured, median and maximum [s]."""

    count: int
    middle: float
    most: float

    @property
    def remark(self) -> str:
        """A reason to look at a check, or ""."""
        return f"slow: a check may take {CHECK_SECONDS:g} s" if self.most >= SLOW else ""


def keep_check_times(out: Path, key: str, judgement: Judgement) -> None:
    """Write the times of all checks beside the evidence: results are the same each time."""
    rows = [
        (task.task, check.scenario, check.title, round(check.seconds, 6))
        for task in judgement.tasks
        for check in task.checks
    ]
    write_whole(check_times_path(out, key), json.dumps(rows).encode())


def check_times(out: Path, keys: Iterable[str]) -> dict[Name, Spent]:
    """Return what each check took, by task, scenario and title."""
    return _spent(row for key in keys for row in _check_rows(out, key))


def scenario_times(out: Path, keys: Iterable[str]) -> dict[Name, Spent]:
    """Return what each scenario took in the jail, by task and name."""
    usages = (usage for key in keys if (usage := read_usage(out, key)))
    return _spent((name.partition("/")[::2], s) for usage in usages for name, s in usage.scenarios.items())


def _check_rows(out: Path, key: str) -> Iterator[tuple[Name, float]]:
    with suppress(OSError, ValueError, TypeError):  # missing or damaged: times are not worth an error
        for task, scenario, title, seconds in read_json(check_times_path(out, key).read_bytes()):
            yield (task, scenario, title), float(seconds)


def _spent(rows: Iterable[tuple[Name, float]]) -> dict[Name, Spent]:
    found = defaultdict[Name, list[float]](list)
    for name, seconds in rows:
        found[name].append(seconds)
    return {name: Spent(len(all_), median(all_), max(all_)) for name, all_ in found.items()}
