"""Mutants of a solution: general mistakes that a program makes in it, and those of the course."""

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from course_lib.errors import CourseError

Replacement = str | Callable[[re.Match[str]], str]


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
    replacement: Replacement
    names: str
    only_other_inputs: bool = False


GEOMETRY = "position|[Dd]istance|size|scale|circle|point|width|height|line|at the end|turn|the part"

GENERAL = (
    Operator(
        "sign: sine",
        r"math\.sin\(",
        "-math.sin(",
        "direction|clockwise|sign|value|turned|orientation|position",
    ),
    Operator("sign: height", r"(position\.z = )", r"\1-", "position|height"),
    Operator("frame", r'frame_id = "map"', 'frame_id = "base_link"', "frame"),
    Operator("unit: centimetres", r"(?<=[=*] )(\d+\.\d+)(?=.*# \[m\])", r"\1 * 100", GEOMETRY),
    Operator("unit: degrees", r"2 \* math\.pi", "360", "turn|direction|circle|shorter way|swing"),
    Operator("stamp: not set", r"(marker|state)\.header\.stamp = .*", "pass", "stamp"),
    Operator(
        "stamp: late",
        r"((?:marker|state)\.header\.stamp) = .*",
        r'\1 = (self.get_clock().now() - __import__("rclpy").duration.Duration(seconds=1)).to_msg()',
        "stamp",
    ),
    Operator(
        "constant: length", r"(?<== )(\d+\.\d+)(?= .*# \[m\])", lambda m: f"{float(m[1]) + 0.1:.2f}", GEOMETRY
    ),
    Operator(
        "constant: color",
        r"(marker\.color\.[^=]*[ba] = .*)(?<=\D)1\.0|(?<=color\.a = )0\.8",
        r"\g<1>0.5",
        "color|wide",
    ),
    Operator(
        "constant: rate", r"create_timer\((\d\.\d)", r"create_timer(2 * \1", "rate|slow|turn|wrong time"
    ),
    Operator("off by one: first item lost", r"enumerate\((\w+)\)", r"enumerate(\1[1:])", "shows 2|count"),
    Operator("off by one: one number for all", r"id=number", "id=0", "shows 1|count"),
    Operator(
        "off by one: one id for all", r"id=int\([^)]*\)", "id=0", r"id|shows \d|count|no marker|place|turn"
    ),
    Operator("half forgotten", r" / 2(?= \+|  #)", "", GEOMETRY),
    Operator("comparison turned", r"(?<=score) >= ", " < ", "shows|count|no marker"),
    Operator("lifetime: none", r"marker\.lifetime = .*", "pass", "lifetime"),
    Operator(
        "frame: not copied",
        r"(marker\.header)( = message\.header)(?=\n)",
        r"\1.stamp\2.stamp",
        "frame",
    ),
    Operator(
        "stamp: not copied", r"(marker\.header)( = message\.header)(?=\n)", r"\1.frame_id\2.frame_id", "stamp"
    ),
    Operator(
        "unit: degrees for radians", r"math\.radians\((\w+)\)", r"\1", "degrees, where radians are wanted"
    ),
    Operator("type", r"Marker\.(CUBE|SPHERE|CYLINDER|LINE_STRIP)", "Marker.POINTS", "type|shows 0|POINTS"),
    Operator(
        "hard-coded: one student's value",
        r"my_values\(.*?\)\[.*?\]",
        "9.9",
        f"{GEOMETRY}|too slow|your robot|'Keep'|threshold|shows 0 markers|word behind",
    ),
    Operator(
        "hard-coded: as long as the public run",
        r"(self\.publisher\.publish\((marker|state)\))",
        r"(self.get_clock().now().nanoseconds < 1_700_000_006_500_000_000) and \1",
        "silent|too few",
        only_other_inputs=True,
    ),
)


def operators(solutions: Path) -> tuple[Operator, ...]:
    """Return the general operators, and those that the course has in `answers/mutants.toml`.

    Raises:
        CourseError: The file is malformed.
    """
    path = solutions / "answers" / "mutants.toml"
    if not path.is_file():
        return GENERAL
    try:
        rows = tomllib.loads(path.read_text(encoding="utf-8")).get("mutant", [])
        own = tuple(Operator(**row) for row in rows)
        for operator in own:
            re.compile(operator.names)
            re.sub(operator.pattern, operator.replacement, "")  # which compiles both
    except (TypeError, ValueError, LookupError, re.error) as error:
        raise CourseError(
            f"{path}: {error}; expected [[mutant]] with name, pattern, replacement, names"
        ) from error
    return (*GENERAL, *own)


def idle_operators(solutions: Path, cells: Sequence[str]) -> Iterator[str]:
    """Yield the names of the course's own operators that change no cell."""
    for operator in operators(solutions)[len(GENERAL) :]:
        if not any(re.search(operator.pattern, cell) for cell in cells):
            yield operator.name


def mutants(code: str, among: Iterable[Operator]) -> Iterator[tuple[Operator, str]]:
    """Yield (operator, mutated code) for every place where an operator applies."""
    for operator in among:
        for match in re.finditer(operator.pattern, code):
            put = operator.replacement
            new = put(match) if callable(put) else match.expand(put)
            yield operator, code[: match.start()] + new + code[match.end() :]
