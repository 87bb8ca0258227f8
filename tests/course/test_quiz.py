from pathlib import Path

import pytest

from course_lib.course.installation import exercises_dir
from course_lib.course.questions import Answer, _quiz_form, load_predictions, load_quiz, quiz, verdict
from course_lib.errors import CourseError

QUIZZES = sorted((exercises_dir() / "quizzes").glob("*.toml"))


@pytest.mark.parametrize("path", QUIZZES, ids=lambda path: path.stem)
def test_every_quiz_has_4_to_6_questions_every_recall_3_and_every_review_8(path: Path) -> None:
    count = len(load_quiz(path.stem))
    if path.stem.endswith("_review"):
        assert count == 8
        return
    most = 10 if path.stem == "week06" else 6  # the original tutorial asks ten questions on tooling
    assert count == 3 if path.stem.endswith("_recall") else 4 <= count <= most


@pytest.mark.parametrize("path", QUIZZES, ids=lambda path: path.stem)
def test_every_answer_has_a_reason(path: Path) -> None:
    for question in (*load_quiz(path.stem), *load_predictions(path.stem)):
        assert 2 <= len(question.answers) <= 5
        assert all(len(answer.reason) > 20 for answer in question.answers)


def test_the_right_answer_is_not_always_at_the_same_place() -> None:
    places = {[a.right for a in q.answers].index(True) for path in QUIZZES for q in load_quiz(path.stem)}
    assert len(places) > 1


def test_without_a_page_the_questions_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    quiz("week01")
    printed = capsys.readouterr().out
    assert printed.startswith("1. ")
    assert all(f"( ) {a.text}" in printed for q in load_quiz("week01") for a in q.answers)


def test_every_answer_can_be_clicked_and_is_answered_in_words() -> None:
    questions = load_quiz("week01")
    for question, box in zip(questions, _quiz_form(questions).children, strict=True):
        _, choice, said = box.children
        for number, answer in enumerate(question.answers):
            choice.index = number
            assert said.value == verdict(answer)
    assert verdict(Answer("a", "because", True)) == "✔ Right. because"


def test_an_unknown_quiz_names_those_there_are() -> None:
    with pytest.raises(CourseError, match="week01"):
        quiz("week99")
