"""The places of NaN in what a student's code has published or returned."""

import math
from collections.abc import Iterable, Iterator
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.ros.messages import to_plain

MAX_PLACES = 3


def not_numbers(evidence: Iterable[Evidence]) -> list[str]:
    """Return a sentence with the first places of NaN, or nothing; of a topic its last message counts."""
    places: list[str] = []
    for one in evidence:
        for topic in one.topics:
            last = [to_plain(message) for _, message in one.messages(topic)[-1:]]
            places += (f"{place} on {topic}" for place in _places(last[0] if last else None, ""))
        places += (place for value in one.returns for place in _places(value, "the returned value"))
    found = list(dict.fromkeys(places))[:MAX_PLACES]
    cause = "a division 0 / 0, a root of a negative number, or a value that was never set?"
    return [f"NaN (not a number): {', '.join(found)}. Is it {cause}"] if found else []


def _places(value: Any, path: str) -> Iterator[str]:
    if isinstance(value, float) and math.isnan(value):
        yield path.removeprefix(".")
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _places(item, f"{path}.{key}")
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _places(item, f"{path}[{index}]")
