"""The files of marks, under several writers and with processes that are killed."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.grading.marking.by_hand import find_stale, mark_by_hand, update_reports
from course_lib.grading.marking.marking_queue import MarkingQueue
from course_lib.grading.marks import MarkEntry, MarksConflictError, read_marks, results_in
from course_lib.grading.store import Course, lock_folder, marks_path, report_path
from tests.grading.marking.bench import ESSAY, MOTTO
from tests.processes import Program

WRITER = """
import sys
from pathlib import Path
from course_lib.grading.marking.marking_queue import MarkingQueue
from course_lib.grading.marks import MarkEntry, MarksConflictError
out, name, first, last = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
queue = MarkingQueue(out)
keys = [item["key"] for item in queue.changes_since(0)["items"]]
for number in range(first, last):
    key = keys[number % len(keys)]
    while True:
        try:
            queue.save(key, [MarkEntry(number % 5, "", f"{name} {number}")], name, queue.item(key).revision)
            break
        except MarksConflictError:
            pass
    print(number, flush=True)
"""
COUNT = 100  # marks of each writer


def start_writer(out: Path, name: str, first: int) -> Program:
    words = (str(out), name, str(first), str(COUNT))
    return Program([sys.executable, "-c", WRITER, *words], stdout=subprocess.PIPE)


def comments(out: Path) -> list[str]:
    return [mark.comment for path in out.glob("marks/*/*.json") for mark in read_marks(path)]


def item(queue: MarkingQueue, student: str, task: str) -> str:
    items = queue.changes_since(0)["items"]
    (key,) = [one["key"] for one in items if (one["student"], one["task"]) == (student, task)]
    return str(key)


@pytest.mark.slow
def test_concurrent_writers_lose_no_marks_when_one_is_killed(kinds: Course, tmp_path: Path) -> None:
    out = tmp_path / "out"
    ann, ben = start_writer(out, "ann", 0), start_writer(out, "ben", 0)
    assert ann.stdout
    assert ben.stdout
    saved = [next(ann.stdout) for _ in range(COUNT // 2)]
    ann.kill()
    saved += ann.stdout.readlines()
    ann.wait()
    again = start_writer(out, "ann", len(saved))
    assert again.stdout
    assert len(again.stdout.readlines()) == COUNT - len(saved)
    assert len(ben.stdout.readlines()) == COUNT
    assert again.wait() == ben.wait() == 0
    found = comments(out)
    assert set(found) == {f"{name} {number}" for name in ("ann", "ben") for number in range(COUNT)}
    assert len(found) - len(set(found)) <= 1  # the mark that was on the disk, but not acknowledged
    assert list(out.glob("marks/*/.*")) == []


def test_save_with_an_outdated_revision_is_a_conflict_and_both_marks_can_be_kept(
    kinds: Course, tmp_path: Path
) -> None:
    queue = MarkingQueue(tmp_path / "out")
    key = item(queue, "ada", ESSAY)
    seen = queue.item(key).revision
    queue.save(key, [MarkEntry(5, "1", "clear")], "ann", seen)
    with pytest.raises(MarksConflictError, match=r"ann has marked week05\.essay in the meantime"):
        queue.save(key, [MarkEntry(3, "1", "vague")], "ben", seen)
    assert comments(tmp_path / "out") == ["clear"]
    queue.save(key, [MarkEntry(3, "1", "vague")], "ben", queue.item(key).revision)
    assert comments(tmp_path / "out") == ["clear", "vague"]


def test_mark_for_a_changed_submission_is_a_conflict(kinds: Course, tmp_path: Path) -> None:
    queue = MarkingQueue(tmp_path / "out")
    key = item(queue, "ada", ESSAY)
    seen = queue.item(key).revision
    path = next((tmp_path / "out/results/ada").glob("*.json"))
    content = json.loads(path.read_text())
    content["submission"]["sha256"] = "0" * 64
    path.write_text(json.dumps(content))
    with pytest.raises(MarksConflictError, match=r"the student has changed week05\.essay in the meantime"):
        queue.save(key, [MarkEntry(5, "1", "clear")], "ann", seen)
    queue.save(key, [MarkEntry(5, "1", "clear")], "ann", queue.item(key).revision)


def test_marks_for_different_tasks_of_a_student_do_not_conflict(kinds: Course, tmp_path: Path) -> None:
    queue = MarkingQueue(tmp_path / "out")
    essay, motto = item(queue, "ada", ESSAY), item(queue, "ada", MOTTO)
    revision = queue.item(motto).revision
    queue.save(essay, [MarkEntry(5, "1", "")], "ann", queue.item(essay).revision)
    queue.save(motto, [MarkEntry(60, "", "")], "ben", revision)
    assert len(comments(tmp_path / "out")) == 2


def test_repeated_save_request_is_stored_once(kinds: Course, tmp_path: Path) -> None:
    queue = MarkingQueue(tmp_path / "out")
    key = item(queue, "ada", ESSAY)
    revision = queue.item(key).revision
    for _ in range(2):
        queue.save(key, [MarkEntry(5, "1", ""), MarkEntry(15, "2", "fine")], "ann", revision)
    assert comments(tmp_path / "out") == ["", "fine"]


def test_marks_of_one_save_request_are_stored_atomically(kinds: Course, tmp_path: Path) -> None:
    queue = MarkingQueue(tmp_path / "out")
    key = item(queue, "ada", ESSAY)
    with pytest.raises(CourseError, match="16 points for an example: expected 0 to 15"):
        queue.save(key, [MarkEntry(5, "1", ""), MarkEntry(16, "2", "")], "ann", queue.item(key).revision)
    assert comments(tmp_path / "out") == []


def test_marks_are_saved_while_the_folder_is_locked_and_reports_are_updated_later(
    kinds: Course, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    queue = MarkingQueue(out)
    key = item(queue, "ada", ESSAY)
    with lock_folder(out):
        queue.save(
            key,
            [MarkEntry(5, "1", ""), MarkEntry(15, "2", "well <b>done</b>")],
            "ann",
            queue.item(key).revision,
        )
    assert find_stale(out) == [("ada", "week05_exercise")]
    page = report_path(out, "ada", "week05_exercise")
    assert "done" not in page.read_text()
    assert "Wrote 1 report," in update_reports(out, kinds)
    assert "an example: well &lt;b&gt;done&lt;/b&gt;" in page.read_text()
    assert "ada,week05_exercise,40.0" in (out / "gradebook.csv").read_text()
    assert find_stale(out) == []


def test_comment_without_points_keeps_the_points_and_the_last_comment_of_a_row_counts(
    kinds: Course, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    queue = MarkingQueue(out)
    key = item(queue, "ada", ESSAY)
    for comment in ("too short", "short"):
        queue.save(key, [MarkEntry(None, "", comment)], "ann", queue.item(key).revision)
    assert queue.item(key).state == "waiting"
    mark_by_hand(out, "ada", "week05", "essay", "5", row="1", comment="clear", course=kinds)
    mark_by_hand(out, "ada", "week05", "essay", "4", row="1", course=kinds)  # keeps the comment
    mark_by_hand(out, "ada", "week05", "essay", "15", row="2", course=kinds)
    (result,) = (one for one in results_in(out) if one.student == "ada")
    assert result.row.cells["score"] == 38
    page = report_path(out, "ada", "week05_exercise").read_text()
    assert "<p>short</p><p>names the parts: clear</p>" in page
    assert "too short" not in page


def test_marking_queue_reports_a_damaged_file_and_serves_the_others(kinds: Course, tmp_path: Path) -> None:
    out = tmp_path / "out"
    queue = MarkingQueue(out)
    before = queue.changes_since(0)
    file = marks_path(out, "bob", "week05_exercise")
    file.parent.mkdir(parents=True)
    file.write_text("[{")
    now = queue.changes_since(before["number"])
    assert [str(file) in problem for problem in now["problems"]] == [True]
    file.write_text(json.dumps([]))
    assert queue.changes_since(now["number"])["problems"] == []


def test_only_changed_items_are_sent(kinds: Course, tmp_path: Path) -> None:
    queue = MarkingQueue(tmp_path / "out")
    first = queue.changes_since(0)
    assert len(first["items"]) == 4
    assert queue.changes_since(first["number"])["items"] == []
    mark_by_hand(tmp_path / "out", "bob", "week05", "motto", "1", course=kinds)
    changed = queue.changes_since(first["number"])["items"]
    assert {one["student"] for one in changed} == {"bob"}
    assert [one["state"] for one in changed if one["task"] == MOTTO] == ["marked"]
