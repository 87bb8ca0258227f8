"""Mutants of a solution: general mistakes that a program makes in it, and those of the course."""

import re
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from course_lib.errors import CourseError


@dataclass(frozen=True)
class Operator:
    """A kind of mistake: every place where the pattern matches gives one mutant.

    Args:
        name: Kind of mistake, and which.
        pattern: Where it is made, a regular expression.
        replacement: What stands there then.
        names: What some message or kind of mistake must say of it, a regular expression.
        only_other_inputs: Whether it is right for the inputs of the public scenario.
    """

    name: str
    pattern: str
    replacement: str
    names: str
    only_other_inputs: bool = False


def operators(solutions: Path) -> tuple[Operator, ...]:
    """Return the general operators, and those that the course has in `answers/mutants.toml`.

    Raises:
        CourseError: The file is malformed.
    """
    return (*_read(Path(__file__).with_name("mutants.toml")), *_own(solutions))


def idle_operators(solutions: Path, cells: Sequence[str]) -> Iterator[str]:
    """Yield the names of the course's own operators that change no cell."""
    for operator in _own(solutions):
        if not any(re.search(operator.pattern, cell) for cell in cells):
            yield operator.name


def mutants(code: str, among: Iterable[Operator]) -> Iterator[tuple[Operator, str]]:
    """Yield (operator, mutated code) for every place where an operator applies."""
    for operator in among:
        for match in re.finditer(operator.pattern, code):
            yield operator, code[: match.start()] + match.expand(operator.replacement) + code[match.end() :]


def _own(solutions: Path) -> tuple[Operator, ...]:
    path = solutions / "answers" / "mutants.toml"
    return _read(path) if path.is_file() else ()


def _read(path: Path) -> tuple[Operator, ...]:
    try:
        rows = tomllib.loads(path.read_text(encoding="utf-8")).get("mutant", [])
        read = tuple(Operator(**row) for row in rows)
        for operator in read:
            re.compile(operator.names)
            re.sub(operator.pattern, operator.replacement, "")  # which compiles both
    except (TypeError, ValueError, LookupError, re.error) as error:
        raise CourseError(
            f"{path}: {error}; expected [[mutant]] with name, pattern, replacement, names"
        ) from error
    return read
