from html import escape
from pathlib import Path

import pytest

from course_lib.course.material import exercises_dir
from course_lib.course.questions import (
    HOW_TO_ANSWER,
    Answer,
    Question,
    _quiz_form,
    quiz,
    read_quiz,
    verdict,
)
from course_lib.errors import CourseError

QUIZZES = sorted((exercises_dir() / "quizzes").glob("*.toml"))


@pytest.mark.parametrize("path", QUIZZES, ids=lambda path: path.stem)
def test_quizzes_recalls_and_reviews_have_the_documented_number_of_questions(path: Path) -> None:
    count = len(read_quiz(path.stem))
    if path.stem.endswith("_review"):
        assert count == 8
        return
    most = 10 if path.stem == "week06" else 6  # the original tutorial asks ten questions on tooling
    assert count == 3 if path.stem.endswith("_recall") else 4 <= count <= most


@pytest.mark.parametrize("path", QUIZZES, ids=lambda path: path.stem)
def test_every_quiz_answer_has_an_explanation(path: Path) -> None:
    for question in (*read_quiz(path.stem), *read_quiz(path.stem, "prediction")):
        assert 2 <= len(question.answers) <= 5
        assert all(len(answer.reason) > 20 for answer in question.answers)


def test_correct_answers_are_at_different_positions() -> None:
    places = {[a.right for a in q.answers].index(True) for path in QUIZZES for q in read_quiz(path.stem)}
    assert len(places) > 1


def test_questions_are_printed_outside_a_notebook(capsys: pytest.CaptureFixture[str]) -> None:
    quiz("week01")
    printed = capsys.readouterr().out
    assert printed.startswith("1. ")
    assert all(f"( ) {a.text}" in printed for q in read_quiz("week01") for a in q.answers)


def test_clicking_any_answer_shows_its_explanation() -> None:
    questions = read_quiz("week01")
    for question, box in zip(questions, _quiz_form("week01", questions).widget.children, strict=True):
        _, choice, said = box.children
        for number, answer in enumerate(question.answers):
            choice.index = number
            assert verdict(answer) in said.value
    assert verdict(Answer("a", "because", True)) == "✔ Right. because"


def test_unknown_quiz_error_lists_the_quizzes() -> None:
    with pytest.raises(CourseError, match="week01"):
        quiz("week99")


def test_answer_is_stored_and_shown_on_pages_without_a_kernel(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".course").mkdir()
    monkeypatch.chdir(tmp_path)
    questions = read_quiz("week01")
    right = questions[1].right
    form, calls = _quiz_form("week01", questions), []
    form.on_answer.append(lambda: calls.append(1))
    form.widget.children[1].children[1].index = questions[1].answers.index(right)
    assert calls == [1]
    for shown in (form, _quiz_form("week01", questions)):
        html, text = shown.saved_output()
        assert f"◉ <b>{escape(right.text)}</b>" in html
        assert html.count("◉") == 1
        assert escape(verdict(right)) in html
        assert f"(x) {right.text}" in text
    assert "◉" not in _quiz_form("week02", read_quiz("week02")).saved_output()[0]
    others = tuple(Answer(f"new {one.text}", one.reason, one.right) for one in questions[1].answers)
    changed = (questions[0], Question(questions[1].text, others))
    assert "◉" not in _quiz_form("week01", changed).saved_output()[0]


def test_questions_without_an_answer_state_how_to_answer_on_pages_without_a_kernel(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".course").mkdir()
    monkeypatch.chdir(tmp_path)
    questions = read_quiz("week01_recall")
    form = _quiz_form("week01_recall", questions)
    for number, question in enumerate(questions):
        assert all(HOW_TO_ANSWER in part for part in form.saved_output())
        form.widget.children[number].children[1].index = question.answers.index(question.right)
    assert not any(HOW_TO_ANSWER in part for part in form.saved_output())
