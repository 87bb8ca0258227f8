"""The table of programs from public repositories, and the judgement of a run."""

import tomllib

import pytest

from tests.benchmarks.wild_programs import ROWS, Row, judged

TABLE = [Row(**row) for row in tomllib.loads(ROWS.read_text())["program"]]


def test_at_least_98_percent_of_programs_with_all_dependencies_run() -> None:
    able = [row for row in TABLE if row.result in ("runs", "fails") and not row.theirs]
    assert len({row.repository for row in TABLE}) >= 90
    assert sum(row.result == "runs" for row in able) >= 0.98 * len(able)


def test_each_failed_program_has_a_reason() -> None:
    assert [row for row in TABLE if row.result != "runs" and not row.reason] == []


@pytest.mark.parametrize("row", [TABLE[0], Row("a/b", "1", 'x "y".py', args="1 2", theirs=True)])
def test_result_row_survives_a_round_trip(row: Row) -> None:
    assert Row(**tomllib.loads(row.text())["program"][0]) == row


@pytest.mark.parametrize(
    ("code", "err", "result"),
    [
        (0, "[INFO] [1.0] [talker]: hello\n", ("runs", "")),
        (1, "Traceback\nModuleNotFoundError: No module named 'torch.nn'\n", ("needs", "torch")),
        (1, "Traceback\nNameError: name 'x'\nhint: spell it\n", ("fails", "NameError: name 'x'")),
        (0, "x.py was stopped: it was still waiting\n", ("fails", "was still waiting after the end")),
        (3, "", ("fails", "exit code 3")),
        (1, "Traceback\nEOFError: EOF when reading a line\n", ("needs", "keyboard input")),
        (2, "usage: p.py [-h] name\np.py: error: no name\n", ("needs", "arguments")),
        (1, "x.PackageNotFoundError: package 'ur' not found, searching: []", ("needs", "ur")),
        (
            1,
            "x.ParameterUninitializedException: The parameter 'a' is not initialized",
            ("needs", "parameter a"),
        ),
        (2, "error: unterminated string\nhint: in Python 3.12, which", ("needs", "Python 3.12")),
    ],
)
def test_run_is_classified_by_its_exit_code_and_last_line(
    code: int, err: str, result: tuple[str, str]
) -> None:
    assert judged(code, err) == result


def test_program_with_a_second_shutdown_at_its_end_is_a_success() -> None:
    text = (
        "rclpy._rclpy_pybind11.RCLError: failed to shutdown: rcl_shutdown already called on the given context"
    )
    assert judged(1, f"Traceback\n{text}\nhint: rclpy is shut down") == ("runs", "")
