import pytest

from tests.hostile.conftest import HONEST, SECRET, Graded, library_hash
from tests.hostile.submissions import ALL, FULL, Entry


@pytest.mark.parametrize("entry", ALL, ids=lambda entry: entry.name)
def test_each_submission_gets_its_mark_and_breaks_nothing(graded: Graded, entry: Entry) -> None:
    row, result = graded.rows[entry.name], graded.result(entry.name)
    said = result["output"] + "".join(result["cell_errors"]) + str(result["tasks"])
    assert "BROKEN" not in said
    assert SECRET not in said
    assert (row["status"], float(row["final"])) == (entry.status, entry.final)
    assert row["reason"] in entry.reason.split("|")
    assert entry.says in said


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
