"""A measurement of the kit and its peers, and a Markdown page of all measurements."""

import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from importlib.metadata import PackageNotFoundError, version
from math import isnan
from pathlib import Path

import psutil

COLUMNS = ("measurement", "unit", "course_lib", "peer", "value of the peer", "times better")
PAGE = """# Benchmarks

Printed by `python -m tests.benchmarks --write` on {day}: {machine},
a load of {load:.1f} before the run. Versions: {versions}.

All rows were measured in one run on one machine, the kit and its peers in turn. Absolute numbers
depend on the machine. In the last column, a number above 1 means that the kit was better, and a number
below 1 that the peer was better.

{table}
"""


@dataclass(frozen=True, slots=True)
class Row:
    """A measurement of the kit and of peers.

    Attributes:
        what: The measurement.
        unit: Its unit.
        ours: The kit's value.
        peers: The values of the peers, by name; NaN where a peer can't do it.
        less: Whether less is better.
    """

    what: str
    unit: str
    ours: float
    peers: Mapping[str, float]
    less: bool = True

    def lines(self) -> list[tuple[str, ...]]:
        """Return the cells of a line for each peer that was measured."""
        values = {name: value for name, value in self.peers.items() if not isnan(value)}
        return [
            (self.what, self.unit, number(self.ours), name, number(value), number(self.times(name), 2))
            for name, value in values.items()
        ]

    def times(self, peer: str) -> float:
        """Return how many times better the kit is than a peer."""
        theirs = self.peers[peer]
        return theirs / self.ours if self.less else self.ours / theirs


def number(value: float, digits: int = 3) -> str:
    """Return that many significant digits, or all digits before the point."""
    return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.{digits}g}"


def markdown(rows: Iterable[Row]) -> str:
    """Return the table."""
    cells = [COLUMNS, tuple("---" for _ in COLUMNS), *(line for row in rows for line in row.lines())]
    return "\n".join(map(_line, cells))


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def refreshed(document: str, rows: Iterable[Row]) -> str:
    """Return a document whose lines of the table show these values."""
    new = {(line[0], line[3]): _line(line) for row in rows for line in row.lines()}
    lines = (line.strip("| ").split(" | ") for line in document.splitlines())
    keys = ((cells[0], cells[3]) if len(cells) == len(COLUMNS) else None for cells in lines)
    pairs = zip(keys, document.splitlines(), strict=True)
    return "\n".join(new.get(key, old) if key else old for key, old in pairs) + "\n"


def page(rows: Iterable[Row], versions: Mapping[str, str], load: float) -> str:
    """Return docs/benchmarks.md."""
    named = ", ".join(f"{name} {number}" for name, number in versions.items())
    return PAGE.format(day=date.today(), machine=machine(), load=load, versions=named, table=markdown(rows))


def machine() -> str:
    """Name this machine's processor, cores, memory, system and Python."""
    memory = psutil.virtual_memory().total / 2**30
    system = f"{platform.system()}, Python {platform.python_version()}"
    return f"{_processor()}, {os.cpu_count()} cores, {memory:.0f} GiB, {system}"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return next(iter(names), platform.processor() or platform.machine())


def installed(names: Sequence[str]) -> dict[str, str]:
    """Return the versions of distributions that are installed here."""
    found = {}
    for name in names:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found
