from pathlib import Path

import pytest

from course_lib.course.questions import _prediction_form, compare, predict
from course_lib.course.state import State
from course_lib.errors import CourseError

OPTIONS = ["nothing", "a cube"]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / ".course").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_without_a_page_the_question_is_printed_and_nothing_is_kept(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    predict("week01.alpha", "What do you see?", OPTIONS)
    compare("week01.alpha", "nothing")
    printed = capsys.readouterr().out
    assert "( ) a cube" in printed
    assert "You predicted: none yet" in printed
    assert "What happened: nothing" in printed


def test_a_click_keeps_the_guess_and_the_result_is_shown_beside_it(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _prediction_form("week01.alpha", "What do you see?", OPTIONS, None).children[1].value = "a cube"
    assert State(folder).section("predictions") == {"week01.alpha": "a cube"}
    compare("week01.alpha", "nothing")
    compare("week01.alpha", "a cube")
    first, _, second, _ = capsys.readouterr().out.splitlines()
    assert first == "You predicted: a cube   → look again at why"
    assert second == "You predicted: a cube   ✔ as it happened"


def test_a_kept_guess_is_chosen_again_when_the_cell_runs_again() -> None:
    assert _prediction_form("k", "q", OPTIONS, "a cube").children[1].value == "a cube"
    assert _prediction_form("k", "q", OPTIONS, "an option of an older lesson").children[1].value is None


def test_one_option_is_no_choice() -> None:
    with pytest.raises(CourseError, match="two options"):
        predict("k", "q", ["only"])
