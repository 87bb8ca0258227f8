"""Expectations on what is not there: before a time, or any more."""

from collections.abc import Iterable

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.marker_state import each, shown
from course_lib.grading.vocabulary.wording import Problem, heard, nothing_on, number, word


@word("the markers on {topic} are gone")
def expect_gone(evidence: Evidence, topic: str) -> Iterable[Problem]:
    """Expect markers during the scenario, but none that is shown at its end."""
    if not any(True for _ in each(evidence, topic)):
        raise nothing_on(evidence, topic)
    left = len(shown(evidence, topic))
    message = f"{topic} still shows {left} marker{'s' * (left != 1)} at the end, expected none"
    return [Problem(message, "the count is wrong")] if left else []


@word("nothing on {topic} before {begin} s")
def expect_nothing_before(evidence: Evidence, topic: str, begin: float) -> Iterable[Problem]:
    """Expect messages on a topic, the first of them not before a time [s]."""
    first, _ = heard(evidence, topic)[0]
    message = (
        f"{topic} was published after {number(first, 's')}, expected nothing before {number(begin, 's')}"
    )
    return [Problem(message, "a message comes too early")] if first < begin else []
