"""Lists of a term that do not fit each other are told, and cost nobody anything."""

from dataclasses import replace
from pathlib import Path

from course_lib.course.course_file import CourseFile, Term
from course_lib.grading.term.term import Files, write_term
from tests.grading.term.simulated import write_results
from tests.grading.term.test_term import course, lines_of, toml, write

__all__ = ["course", "toml"]


def test_a_quiz_of_which_nobody_has_a_mark_counts_for_nobody(tmp_path: Path, course: CourseFile) -> None:
    write_results(tmp_path / "graded", ["ada", "bob", "cleo"], course, seed=2)
    roster = write(tmp_path / "roster.csv", "id,name", "ada,Ada", "bob,Bob")
    quizzes = write(tmp_path / "quizzes.csv", "id,week,percent", "ada,week01,80")
    plain = replace(course, term=Term(quiz_percent=10, group_weeks=("week02",)))
    said = write_term(tmp_path / "graded", Files(roster, quizzes=quizzes), plain)
    rows = lines_of(tmp_path / "graded/term.csv")
    assert (rows["ada"]["quizzes"], rows["bob"]["quizzes"]) == ("80", "0")
    assert any(
        line.startswith("No quiz of week02, week03") and line.endswith("nobody has a mark of it")
        for line in said
    )
    assert any(
        "extensions in course.toml for IDs that are not in the class list: s003" in line for line in said
    )
    assert any("group_weeks, but the class list no groups" in line for line in said)
