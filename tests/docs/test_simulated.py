"""docs/simulated.md: each row is shown by a test or by an example, and nothing listed as missing is there."""

import ast
import doctest
import importlib
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from itertools import takewhile
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.tools.ros2 import VERBS, ros2
from course_lib.tools.rqt.rqt import VIEWS
from course_lib.tools.sources import RecordingSource

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "simulated.md").read_text("utf-8")
JAZZY = tomllib.loads((ROOT / "tests" / "data" / "ros2cli_jazzy.toml").read_text("utf-8"))
OURS = {"connect", "disconnect"}
Row = tuple[str, ...]


def tables(last_column: str) -> Iterator[tuple[str, list[Row]]]:
    """Yield the section and the rows of the tables whose header ends with a name."""
    section, lines = "", iter(PAGE.splitlines())
    for line in lines:
        section = line if line.startswith("## ") else section
        if line.startswith("|") and line.endswith(f"| {last_column} |"):
            next(lines)
            rows = takewhile(lambda row: row.startswith("|"), lines)
            yield section, [tuple(cell.strip() for cell in row.strip("|").split(" | ")) for row in rows]


def code(cell: str) -> list[str]:
    return re.findall(r"`([^`]+)`", cell)


@cache
def claims() -> set[str]:
    files = (path.read_text("utf-8") for path in (ROOT / "tests").rglob("test_*.py"))
    return {
        name for text in files for name in re.findall(r"^(?:async )?def (test_\w+)\(", text, re.MULTILINE)
    }


SHOWN = [(section, row) for section, rows in tables("Shown by") for row in rows]


def test_simulated_page_has_table_rows() -> None:
    assert len(SHOWN) > 70
    assert {len(row) for _, row in SHOWN} == {4}


@pytest.mark.parametrize(("section", "row"), SHOWN, ids=[row[0] for _, row in SHOWN])
def test_every_row_has_claims_or_an_example(section: str, row: Row) -> None:
    names = code(row[3])
    assert set(names) <= claims()
    has_example = "```pycon" in PAGE.split(section)[1].split("\n## ")[0]
    assert names or row[3].startswith("example below")
    assert has_example or "example below" not in row[3]


def test_examples_of_the_page_print_the_documented_output() -> None:
    example = doctest.DocTestParser().get_doctest(
        "\n".join(re.findall(r"```pycon\n(.*?)```", PAGE, re.DOTALL)),
        {},
        "simulated.md",
        "docs/simulated.md",
        0,
    )
    assert example.examples
    with use_graph(Graph()):
        assert doctest.DocTestRunner().run(example).failed == 0


def missing_words() -> dict[str, set[str]]:
    """Return the options that the page lists as missing by command; an empty set means the whole command."""
    [(_, rows)] = tables("Instead")
    return {
        command.removeprefix("ros2 "): set(code(missing))
        for commands, missing, _ in rows
        for command in code(commands)
    }


def test_page_lists_exactly_the_missing_verbs_and_options_of_jazzy() -> None:
    there = {
        f"{verb.command} {verb.name}".strip(): {flag for one in verb.options for flag in one.flags}
        for verb in VERBS
    }
    missing = {
        verb: set(options) - there.get(verb, set()) if verb in there else set()
        for verb, options in JAZZY.items()
        if verb not in there or set(options) - there[verb]
    }
    assert missing_words() == missing, "docs/simulated.md lists what is missing, below The command line"
    assert {verb for verb in there if verb not in JAZZY and not verb.startswith("run ")} == OURS


@pytest.mark.parametrize("command", missing_words())
def test_options_documented_as_missing_are_rejected(command: str) -> None:
    for option in missing_words()[command] or {""}:
        with pytest.raises(CourseError, match="error: "):
            ros2([*command.split(), *option.split()], RecordingSource(Recording(())), lambda text: None)


[_, NAMES] = zip(*next(iter(tables("Missing")))[1], strict=True)


@pytest.mark.parametrize("name", [name for cell in NAMES for name in code(cell)])
def test_name_documented_as_missing_does_not_exist(name: str) -> None:
    with pytest.raises((ImportError, AttributeError)):
        find_object(name)


def find_object(name: str) -> object:
    """Return the module, class or function of a dotted name. All components except the last must exist."""
    module, _, rest = name.partition(".")
    drawable: object = importlib.import_module(module)
    parts = rest.split(".")
    for count, part in enumerate(parts, 1):
        try:
            drawable = getattr(drawable, part)
        except AttributeError:
            if count < len(parts) and not isinstance(drawable, type(ast)):
                pytest.fail(f"{name}: {part} should be there")
            drawable = importlib.import_module(f"{module}.{'.'.join(parts[:count])}")
    return drawable


def test_rqt_views_match_the_documented_views() -> None:
    [row] = [row for _, row in SHOWN if row[0] == "rqt"]
    assert set(re.split(r", | and ", row[2].split(" has ")[1].split(", each")[0])) == set(VIEWS)
