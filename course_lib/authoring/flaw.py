"""Flaws that `course verify` finds: what is wrong, where, and under which heading."""

from dataclasses import dataclass

# The columns of the table: heading, and what must hold.
ASPECTS = {
    "files": "course.toml, check files and answers can be read",
    "fields": "message types and fields in checks and inputs exist",
    "solution": "the solution has full marks under every personal option",
    "stub": "the empty exercise has no points, and says what is missing",
    "empty": "a publisher without content has at most a tenth",
    "second": "another right solution has full marks",
    "wrong": "wrong answers and mutants fail, by a message that names the mistake",
    "can fail": "every check fails for some answer",
    "quiz": "each question has one right answer, and what a lesson asks for is there",
    "lesson": "lesson, exercise and solution follow the rules",
    "fresh": "the exercise is made from the solution of today",
}


@dataclass(frozen=True)
class Flaw:
    """One thing that is wrong.

    Args:
        aspect: A key of ASPECTS.
        text: What came in, what was expected.
        place: File, and the line where it is known.
    """

    aspect: str
    text: str
    place: str = ""

    def __str__(self) -> str:
        return f"{self.place}: {self.text}" if self.place else self.text
