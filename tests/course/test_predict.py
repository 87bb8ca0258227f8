from pathlib import Path

import pytest

from course_lib.course import questions
from course_lib.course.questions import WIDTH, _prediction_form, compare, predict, read_prediction
from course_lib.course.state import State
from course_lib.errors import CourseError

RIGHT, WRONG = "on the ground", "0.5 m above the ground"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / ".course").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def choose(answer: str) -> str:
    """Choose an answer. Return the line below the options."""
    form = _prediction_form("week01.ground", read_prediction("week01.ground"), None)
    form.widget.children[1].value = answer
    return str(form.widget.children[2].value)


def test_prediction_outside_a_notebook_is_printed_and_not_stored(
    capsys: pytest.CaptureFixture[str],
) -> None:
    predict("week01.ground")
    compare("week01.ground")
    printed = capsys.readouterr().out
    assert f"( ) {WRONG}" in printed
    assert "You predicted: nothing\n" in printed
    assert f"What happened: {RIGHT}." in printed


def test_comparison_hides_the_answer_until_a_prediction_is_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    forms: list[questions.Form] = []
    monkeypatch.setattr(questions, "in_notebook", lambda: True)
    monkeypatch.setattr(questions, "show_form", lambda build, text: forms.append(build()))
    compare("week01.ground", "z = 0.0 m")
    (form,) = forms
    saved: list[tuple[str, str]] = []
    form.on_answer.append(lambda: saved.append(form.saved_output()))
    right = read_prediction("week01.ground").right
    assert right.text not in form.widget.value
    assert right.text not in form.saved_output()[1]
    assert right.text not in form.saved_output()[0]
    assert choose(WRONG) == "Kept. See the result below."
    assert f"You predicted: {WRONG}." in form.widget.value
    assert f"What happened: {RIGHT}." in form.widget.value
    assert "Measured: z = 0.0 m" in saved[0][1]
    choose(RIGHT)
    assert f"You predicted: {RIGHT}. ✔ Right." in form.widget.value


def test_wrong_prediction_shows_its_explanation_and_the_result(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    choose(WRONG)
    assert State(folder).section("predictions") == {"week01.ground": WRONG}
    compare("week01.ground")
    question = read_prediction("week01.ground")
    lines = capsys.readouterr().out.splitlines()
    wrong = question.answer(WRONG)
    assert wrong is not None
    message = f"You predicted: {WRONG}. ✘ Not this one. {wrong.reason}"
    happened = f"What happened: {RIGHT}. {question.right.reason}"
    assert " ".join(lines) == f"{message} {happened}"
    assert max(map(len, lines)) <= WIDTH


def test_correct_prediction_is_confirmed_with_the_measurement(capsys: pytest.CaptureFixture[str]) -> None:
    choose(RIGHT)
    compare("week01.ground", "z = 0.0 m")
    lines, *_, output_lines = capsys.readouterr().out.splitlines()
    assert lines.startswith(f"You predicted: {RIGHT}. ✔ Right. ")
    assert output_lines == "Measured: z = 0.0 m"


def test_stored_prediction_is_selected_when_the_cell_is_rerun() -> None:
    question = read_prediction("week01.ground")
    assert _prediction_form("k", question, RIGHT).widget.children[1].value == RIGHT
    assert _prediction_form("k", question, "an option of an older lesson").widget.children[1].value is None


def test_unknown_prediction_error_lists_the_predictions() -> None:
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
def test_malformed_question_file_is_reported(
    text: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "quizzes").mkdir()
    (tmp_path / "quizzes" / "week01.toml").write_text(text)
    monkeypatch.setattr(questions, "exercises_dir", lambda: tmp_path)
    with pytest.raises(CourseError, match=rf"week01\.toml.*{message}"):
        predict("week01.a")
