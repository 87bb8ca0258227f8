from pathlib import Path

import pytest

from course_lib.course import questions
from course_lib.course.questions import WIDTH, _prediction_form, compare, load_prediction, predict
from course_lib.course.state import State
from course_lib.errors import CourseError

RIGHT, WRONG = "on the ground", "0.5 m above the ground"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / ".course").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def choose(answer: str) -> None:
    _prediction_form("week01.ground", load_prediction("week01.ground"), None).children[1].value = answer


def test_without_a_page_the_question_is_printed_and_nothing_is_kept(
    capsys: pytest.CaptureFixture[str],
) -> None:
    predict("week01.ground")
    compare("week01.ground")
    printed = capsys.readouterr().out
    assert f"( ) {WRONG}" in printed
    assert "You predicted: nothing yet" in printed
    assert f"What happened: {RIGHT}." in printed


def test_a_wrong_guess_is_answered_by_its_own_reason_and_by_what_happened(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    choose(WRONG)
    assert State(folder).section("predictions") == {"week01.ground": WRONG}
    compare("week01.ground")
    question = load_prediction("week01.ground")
    lines = capsys.readouterr().out.splitlines()
    wrong = question.answer(WRONG)
    assert wrong is not None
    said = f"You predicted: {WRONG}. ✘ Not this one. {wrong.reason}"
    happened = f"What happened: {RIGHT}. {question.right.reason}"
    assert " ".join(lines) == f"{said} {happened}"
    assert max(map(len, lines)) <= WIDTH


def test_a_right_guess_is_confirmed_beside_what_was_measured(capsys: pytest.CaptureFixture[str]) -> None:
    choose(RIGHT)
    compare("week01.ground", "z = 0.0 m")
    said, *_, measured = capsys.readouterr().out.splitlines()
    assert said.startswith(f"You predicted: {RIGHT}. ✔ Right. ")
    assert measured == "Measured: z = 0.0 m"


def test_a_kept_guess_is_chosen_again_when_the_cell_runs_again() -> None:
    question = load_prediction("week01.ground")
    assert _prediction_form("k", question, RIGHT).children[1].value == RIGHT
    assert _prediction_form("k", question, "an option of an older lesson").children[1].value is None


def test_an_unknown_prediction_names_those_there_are() -> None:
    with pytest.raises(CourseError, match=r"no prediction 'week01.x'. Predictions of week01: week01.ground"):
        predict("week01.x")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[prediction]", "is not TOML"),
        ('[[prediction]]\nkey = "a"\ntext = "?"', "has no 'answer'"),
        ('[[prediction]]\nkey = "a"\ntext = "?"\nanswer = [{text = "yes"}]', "has no 'reason'"),
        (
            '[[prediction]]\nkey = "a"\ntext = "?"\nanswer = [{text = "y", reason = "r"}]',
            "exactly one answer",
        ),
    ],
)
def test_a_malformed_file_is_named(
    text: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "quizzes").mkdir()
    (tmp_path / "quizzes" / "week01.toml").write_text(text)
    monkeypatch.setattr(questions, "exercises_dir", lambda: tmp_path)
    with pytest.raises(CourseError, match=rf"week01\.toml.*{message}"):
        predict("week01.a")
