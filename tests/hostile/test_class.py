import pytest

from tests.hostile.conftest import HONEST, SECRET, Graded, library_hash
from tests.hostile.entry import FULL, Entry
from tests.hostile.files import FILES, Sent
from tests.hostile.submissions import ALL

# What then holds: files can be found but not read; empty files are bounded by time, not by number.
WITHOUT_NAMESPACES = {"finds_files": "BROKEN", "million_files": "time"}


@pytest.mark.parametrize("entry", ALL, ids=lambda entry: entry.name)
def test_each_submission_gets_its_mark_and_breaks_nothing(graded: Graded, entry: Entry) -> None:
    row, result = graded.rows[entry.name], graded.result(entry.name)
    said = result["output"] + "".join(result["cell_errors"]) + str(result["tasks"])
    instead = "" if graded.hides else WITHOUT_NAMESPACES.get(entry.name, "")
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
def test_honest_submissions_beside_them_keep_full_marks(graded: Graded, student: str) -> None:
    assert (graded.rows[student]["status"], float(graded.rows[student]["final"])) == ("graded", FULL)


def test_the_canaries_are_untouched(graded: Graded) -> None:
    assert graded.connections == []
    assert library_hash() == graded.library_before
    assert (graded.top / "secret.txt").read_text() == SECRET
    assert sorted(path.name for path in graded.top.iterdir()) == ["course", "in", "out", "secret.txt"]


def test_no_script_of_a_student_is_in_a_report(graded: Graded) -> None:
    for student in ("forged_output", "forged_error"):
        assert "<script>alert" not in graded.report(student)
        assert "&lt;script&gt;alert" in graded.report(student)


def test_no_process_of_a_submission_is_left(graded: Graded) -> None:
    assert graded.left == set()


def test_nobody_leaves_anything_to_the_next(graded: Graded) -> None:
    """Honest submissions with equal personal values bring out the same, whoever came before."""
    digests = [graded.result(student)["digests"] for student in (*HONEST, "poisons_the_next", "chance")]
    assert all(digest == digests[0] for digest in digests)


def test_a_file_that_names_another_student_is_graded_for_who_sent_it_and_noted(graded: Graded) -> None:
    assert "aaa_honest" in str(graded.result("another_student")["notes"])
    assert graded.rows["another_student"]["student"] == "another_student"
