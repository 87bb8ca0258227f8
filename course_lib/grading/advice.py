"""Reasons and hints of a failed task: the kind of mistake, then numbers; by cause, then the ladder."""

import math
import re
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from fnmatch import fnmatchcase
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import NEEDS_ANOTHER, CheckResult, TaskResult
from course_lib.grading.task import HINTS, Task
from course_lib.ros.messages import to_plain

MAX_PLACES = 3
AFTER_AN_ERROR = (
    "Your code stopped with the error above. Fix that line first: the failed checks follow from it."
)


@cache
def hints_by_mistake() -> Mapping[str, str]:
    """Return the general hint for each kind of mistake; a * in a kind stands for any text."""
    text = resources.files("course_lib.grading.vocabulary").joinpath("hints.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


class Advice:
    """The hints that a student has seen; they are counted as long as the kernel lives."""

    def __init__(self) -> None:
        self._failed: set[tuple[str, str, str]] = set()
        self._hinted: set[tuple[str, str]] = set()
        self._rungs: Counter[str] = Counter()

    def reasons(self, result: TaskResult) -> TaskResult:
        """Return the result with the kind of mistake as the reason where a check fails for the first time."""
        return replace(result, checks=tuple(self._reason(result.task, check) for check in result.checks))

    def _reason(self, task: str, check: CheckResult) -> CheckResult:
        key = (task, check.scenario, check.title)
        if check.passed or key in self._failed or check.mistake in ("", NEEDS_ANOTHER):
            return check
        self._failed.add(key)
        return replace(check, message=check.mistake)

    def hint(self, task: Task, result: TaskResult) -> str:
        """Return the hint for the first cause, or the next of the task's own hints where that was shown.

        After an exception no check has seen what was meant: the cause is the exception. The ladder
        begins where the same one comes again.
        """
        for mistake in map(_without_place, result.errors[:1]) if result.errors else _first_cause(result):
            text = AFTER_AN_ERROR if result.errors else task.mistakes.get(mistake) or _general_hint(mistake)
            if text and (task.id, mistake) not in self._hinted:
                self._hinted.add((task.id, mistake))
                return f"Hint: {text}"
        self._rungs[task.id] = rung = min(self._rungs[task.id] + 1, HINTS)
        return f"Hint {rung} of {HINTS}: {task.hints[rung - 1]}"


def _without_place(error: str) -> str:
    """Return an error's text without the cell and the line, which change from run to run."""
    return re.sub(r" \((cell In\[\d+\], )?line \d+.*", "", error, flags=re.DOTALL)


def _first_cause(result: TaskResult) -> list[str]:
    """Return the kinds of mistakes of the first check that fails by itself."""
    failing = (check for check in result.checks if not check.passed and check.mistake != NEEDS_ANOTHER)
    first = next(failing, None)
    return first.mistake.split("; ") if first is not None else []


def _general_hint(mistake: str) -> str:
    table = hints_by_mistake()
    return table.get(mistake) or next((table[kind] for kind in table if fnmatchcase(mistake, kind)), "")


def returned_none(task: Task, evidence: Iterable[Evidence]) -> list[str]:
    """Ask for a return where a function came to its end and returned None."""
    ran = (one for one in evidence if not one.errors and not one.stopped)
    if task.kind == "function" and any(returned is None for one in ran for returned in one.returns):
        return [f"{task.name} returned None: is there a return?"]
    return []


def not_numbers(evidence: Iterable[Evidence]) -> list[str]:
    """Return a sentence with the first places of NaN, or nothing; of a topic its last message counts."""
    places: list[str] = []
    for one in evidence:
        for topic in {sample.topic: None for sample in one.samples if _may_hold_nan(sample.cdr)}:
            last = [to_plain(message) for _, message in one.messages(topic)[-1:]]
            places += (f"{place} on {topic}" for place in _places(last[0] if last else None, ""))
        places += (place for value in one.returns for place in _places(value, "the returned value"))
    found = list(dict.fromkeys(places))[:MAX_PLACES]
    cause = "a division 0 / 0, a root of a negative number, or a value that was never set?"
    return [f"NaN (not a number): {', '.join(found)}. Is it {cause}"] if found else []


def large_messages(evidence: Iterable[Evidence]) -> list[str]:
    """Return a sentence for the topic whose messages are so large that they take most of the time."""
    named = [one.large_message for one in evidence if one.large_message]
    told = "and each has to be made, sent and checked. Are that many points needed?"
    return [f"This took long: {text}, {told}" for text in named[:1]]


def _may_hold_nan(cdr: bytes) -> bool:
    """Return whether the bytes of any number can be a NaN: to look at a million points takes seconds."""
    body = cdr[4:]  # numbers are aligned from here
    doubles, floats = (np.frombuffer(body[: len(body) // size * size], f"<f{size}") for size in (8, 4))
    return bool(np.isnan(doubles).any() or np.isnan(floats).any())


def _places(value: Any, path: str) -> Iterator[str]:
    if isinstance(value, float) and math.isnan(value):
        yield path.removeprefix(".")
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _places(item, f"{path}.{key}")
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _places(item, f"{path}[{index}]")
