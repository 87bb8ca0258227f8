"""The stand-in against frozen outcomes of the real rclpy, probe by probe.

The probes of a file are one test. As a test each, the first 4,760 probes were a quarter of all tests, and
every worker of a run collects all of them.
"""

import json
import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from tests.python_messages import without_python_version
from tests.real_ros import differences
from tests.warm import run_course

HERE = Path(__file__).parent


def _content(file: str) -> dict[str, Any]:
    content: dict[str, Any] = json.loads((HERE / "frozen" / f"{file}.json").read_text("utf-8"))
    return content


def frozen_outcomes(file: str) -> dict[str, str]:
    """Return the outcomes of the real rclpy by probe."""
    outcomes: dict[str, str] = _content(file)["outcomes"]
    return outcomes


@cache
def _kits(file: str) -> dict[str, str]:
    process = run_course("run", "--seconds", "600", HERE / "probes" / f"{file}.py")
    assert process.returncode == 0, process.stderr
    outcomes: dict[str, str] = json.loads(process.stdout)
    return outcomes


FILES = sorted(
    file.stem
    for file in (HERE / "probes").glob("*.py")
    if file.stem not in ("probing", "names", "modules", "signatures")
)


@pytest.mark.parametrize("file", FILES)
def test_frozen_outcomes_are_from_rclpy_of_jazzy(file: str) -> None:
    assert _content(file)["rclpy"] == "7.1.6"
    assert set(frozen_outcomes(file)) == set(_kits(file))


@pytest.mark.parametrize("file", FILES)
def test_no_frozen_outcome_is_an_error_of_the_probe_itself(file: str) -> None:
    functions = set(
        re.findall(r"^def (\w+)", (HERE / "probes" / f"{file}.py").read_text("utf-8"), re.MULTILINE)
    )
    faulty = re.compile(rf"\b({'|'.join((*functions, 'outcome', 'probe', 'lines'))})\(\)")
    assert [name for name, outcome in frozen_outcomes(file).items() if faulty.search(outcome)] == []


@pytest.mark.parametrize("file", FILES)
def test_probe_has_the_outcome_of_the_real_rclpy(file: str) -> None:
    frozen, kits, wrong = frozen_outcomes(file), _kits(file), {}
    if sys.version_info >= (3, 14):
        # The outcomes were recorded with Python 3.12, in which gather creates an event loop.
        frozen.pop("task.asyncio_gather", None)
    for name, outcome in frozen.items():
        expected, actual = without_python_version(outcome), without_python_version(kits[name])
        difference = differences.PROBES.get(file, {}).get(name)
        if difference is None:
            if actual != expected:
                wrong[name] = f"rclpy:\n{expected}\nkit:\n{actual}"
        elif actual == expected:
            wrong[name] = f"agrees now: remove it from differences.py and the row {difference.row!r}"
        elif difference.kits not in actual:
            wrong[name] = f"kit, without {difference.kits!r}:\n{actual}"
    assert not wrong, "\n\n".join(f"{name}: {text}" for name, text in wrong.items())
