import pytest

from tests.hostile.conftest import HONEST, SECRET, Graded, library_hash
from tests.hostile.entry import FULL, Entry
from tests.hostile.files import FILES, Sent
from tests.hostile.submissions import ALL

# Without namespaces, files can be listed but not read.
WITHOUT_NAMESPACES = {"finds_files": "BROKEN"}


@pytest.mark.parametrize("entry", ALL, ids=lambda entry: entry.name)
def test_each_hostile_submission_gets_its_expected_mark_without_a_grader_error(
    graded: Graded, entry: Entry
) -> None:
    row, result = graded.rows[entry.name], graded.result(entry.name)
    judged = result["judgement"]
    said = judged["output"] + "".join(judged["cell_errors"]) + str(judged["tasks"])
    instead = "" if graded.hides_names else WITHOUT_NAMESPACES.get(entry.name, "")
    assert "BROKEN" not in said or instead == "BROKEN"
    assert SECRET not in said
    assert (row["status"], float(row["final"])) == (entry.status, entry.final)
    assert row["reason"] in [*entry.reason.split("|"), instead]
    assert entry.says in said


@pytest.mark.parametrize("sent", FILES, ids=lambda sent: sent.student)
def test_each_broken_file_is_read_or_rejected_with_a_reason(graded: Graded, sent: Sent) -> None:
    row = graded.rows[sent.student]
    assert (row["status"], row["final"]) == (
        ("rejected", "") if sent.final is None else ("graded", str(sent.final))
    )
    assert sent.says in row["message"]
    assert SECRET not in row["message"]


@pytest.mark.parametrize("student", HONEST)
def test_honest_submissions_among_hostile_ones_keep_full_marks(graded: Graded, student: str) -> None:
    assert (graded.rows[student]["status"], float(graded.rows[student]["final"])) == ("graded", FULL)


def test_canary_files_are_unchanged(graded: Graded) -> None:
    assert graded.connections == []
    assert library_hash() == graded.library_before
    assert (graded.top / "secret.txt").read_text() == SECRET
    assert sorted(path.name for path in graded.top.iterdir()) == ["course", "in", "out", "secret.txt"]


def test_reports_contain_no_student_script(graded: Graded) -> None:
    for student in ("forged_output", "forged_error"):
        assert "<script>alert" not in graded.report(student)
        assert "&lt;script&gt;alert" in graded.report(student)


def test_no_process_of_a_submission_survives_grading(graded: Graded) -> None:
    assert graded.left == set()


def test_hostile_submission_does_not_change_the_next_results(graded: Graded) -> None:
    """Honest submissions with equal personal values get equal results, in any order."""
    digests = [
        graded.result(student)["judgement"]["digests"] for student in (*HONEST, "poisons_the_next", "chance")
    ]
    assert all(digest == digests[0] for digest in digests)


def test_submission_with_a_foreign_id_is_graded_for_its_submitter_and_reported(graded: Graded) -> None:
    assert "aaa_honest" in str(graded.result("another_student")["notes"])
    assert graded.rows["another_student"]["student"] == "another_student"
