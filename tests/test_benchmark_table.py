from itertools import takewhile
from math import nan

from tests.benchmarks.table import COLUMNS, Row, markdown, refreshed
from tests.checkout import ROOT

FASTER = Row("lookups", "1/s", 300.0, {"a": 100.0, "b": 600.0}, less=False)
SHORTER = Row("start", "s", 0.5, {"a": 1.25, "b": nan})


def test_ratio_above_one_means_the_kit_is_better() -> None:
    assert (FASTER.times("a"), FASTER.times("b"), SHORTER.times("a")) == (3.0, 0.5, 2.5)


def test_peer_without_a_measurement_has_no_line() -> None:
    assert markdown([SHORTER]).splitlines()[2:] == ["| start | s | 0.5 | a | 1.25 | 2.5 |"]


def test_only_lines_of_the_same_measurement_and_peer_are_refreshed() -> None:
    old = "# Title\n\n" + markdown([Row("start", "s", 9.0, {"a": 9.0, "b": 9.0})]) + "\n"
    assert refreshed(old, [SHORTER, FASTER]) == old.replace("| 9 | a | 9 | 1 |", "| 0.5 | a | 1.25 | 2.5 |")


def test_readme_benchmark_lines_are_in_the_last_table() -> None:
    header = f"| {' | '.join(COLUMNS)} |"
    readme = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    table = (ROOT / "docs/benchmarks.md").read_text(encoding="utf-8").splitlines()
    shown = [*takewhile(lambda line: line.startswith("|"), readme[readme.index(header) :])]
    assert len(shown) >= 5
    assert set(shown) <= set(table)


def test_last_benchmark_table_has_every_peer() -> None:
    lines = (ROOT / "docs/benchmarks.md").read_text(encoding="utf-8").splitlines()
    peers = {line.split(" | ")[3] for line in lines if line.count(" | ") == len(COLUMNS) - 1}
    assert peers >= {"meshcat", "viser", "pytransform3d", "rosbags", "nbgrader", "otter"}
