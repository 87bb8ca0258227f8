"""The table of programs from public repositories, and the judgement of a run."""

import tomllib

import pytest

from tests.benchmarks.wild_programs import ROWS, Row, judged

TABLE = [Row(**row) for row in tomllib.loads(ROWS.read_text())["program"]]


def test_at_least_98_in_100_programs_that_have_what_they_need_run() -> None:
    able = [row for row in TABLE if row.result in ("runs", "fails") and not row.theirs]
    assert len({row.repository for row in TABLE}) >= 90
    assert sum(row.result == "runs" for row in able) >= 0.98 * len(able)


def test_each_other_result_has_its_reason() -> None:
    assert [row for row in TABLE if row.result != "runs" and not row.reason] == []


@pytest.mark.parametrize("row", [TABLE[0], Row("a/b", "1", 'x "y".py', args="1 2", theirs=True)])
def test_a_row_is_read_as_it_was_written(row: Row) -> None:
    assert Row(**tomllib.loads(row.text())["program"][0]) == row


@pytest.mark.parametrize(
    ("code", "err", "result"),
    [
        (0, "[INFO] [1.0] [talker]: hello\n", ("runs", "")),
        (1, "Traceback\nModuleNotFoundError: No module named 'torch.nn'\n", ("needs", "torch")),
        (1, "Traceback\nNameError: name 'x'\nhint: spell it\n", ("fails", "NameError: name 'x'")),
        (0, "x.py was stopped: it went on waiting\n", ("fails", "went on waiting after the end")),
        (3, "", ("fails", "exit code 3")),
    ],
)
def test_a_run_is_judged_by_its_code_and_its_last_line(code: int, err: str, result: tuple[str, str]) -> None:
    assert judged(code, err) == result
