"""The files of marks, under several writers and with processes that are killed."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.grading.marking.follow import follow_marks, stale
from course_lib.grading.marking.marking_queue import MarkingQueue
from course_lib.grading.marks.by_hand import mark_by_hand
from course_lib.grading.marks.mark import results_in
from course_lib.grading.marks.marks import Given, MarksConflictError, read_marks
from course_lib.grading.records import Course, marks_path, report_path, sole_use
from tests.grading.marking.bench import ESSAY, MOTTO

WRITER = """
import sys
from pathlib import Path
from course_lib.grading.marking.marking_queue import MarkingQueue
from course_lib.grading.marks.marks import Given, MarksConflictError
out, name, first, last = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
queue = MarkingQueue(out)
keys = [item["key"] for item in queue.since(0)["items"]]
for number in range(first, last):
    key = keys[number % len(keys)]
    while True:
        try:
            queue.save(key, [Given(number % 5, "", f"{name} {number}")], name, queue.item(key).revision)
            break
        except MarksConflictError:
            pass
    print(number, flush=True)
"""
COUNT = 100  # marks of each writer


def start_writer(out: Path, name: str, first: int) -> "subprocess.Popen[str]":
    words = (str(out), name, str(first), str(COUNT))
    return subprocess.Popen([sys.executable, "-c", WRITER, *words], stdout=subprocess.PIPE, text=True)


def comments(out: Path) -> list[str]:
    return [mark.comment for path in out.glob("marks/*/*.json") for mark in read_marks(path)]


def item(queue: MarkingQueue, student: str, task: str) -> str:
    items = queue.since(0)["items"]
    (key,) = [one["key"] for one in items if (one["student"], one["task"]) == (student, task)]
    return str(key)


def test_two_writers_one_of_them_killed_lose_none_of_200_marks(kinds: Course, tmp_path: Path) -> None:
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


def test_a_person_who_has_not_seen_the_last_mark_gets_a_conflict_and_both_marks_can_be_kept(
    kinds: Course, tmp_path: Path
) -> None:
    queue = MarkingQueue(tmp_path / "out")
    key = item(queue, "ada", ESSAY)
    seen = queue.item(key).revision
    queue.save(key, [Given(5, "1", "clear")], "ann", seen)
    with pytest.raises(MarksConflictError, match=r"ann has marked week05\.essay meanwhile"):
        queue.save(key, [Given(3, "1", "vague")], "ben", seen)
    assert comments(tmp_path / "out") == ["clear"]
    queue.save(key, [Given(3, "1", "vague")], "ben", queue.item(key).revision)
    assert comments(tmp_path / "out") == ["clear", "vague"]


def test_a_person_who_has_read_another_hand_in_gets_a_conflict(kinds: Course, tmp_path: Path) -> None:
    queue = MarkingQueue(tmp_path / "out")
    key = item(queue, "ada", ESSAY)
    seen = queue.item(key).revision
    path = next((tmp_path / "out/results/ada").glob("*.json"))
    content = json.loads(path.read_text())
    path.write_text(json.dumps(content | {"sha256": "0" * 64}))
    with pytest.raises(MarksConflictError, match=r"the student has changed week05\.essay meanwhile"):
        queue.save(key, [Given(5, "1", "clear")], "ann", seen)
    queue.save(key, [Given(5, "1", "clear")], "ann", queue.item(key).revision)


def test_marks_of_another_task_of_the_student_are_no_conflict(kinds: Course, tmp_path: Path) -> None:
    queue = MarkingQueue(tmp_path / "out")
    essay, motto = item(queue, "ada", ESSAY), item(queue, "ada", MOTTO)
    revision = queue.item(motto).revision
    queue.save(essay, [Given(5, "1", "")], "ann", queue.item(essay).revision)
    queue.save(motto, [Given(60, "", "")], "ben", revision)
    assert len(comments(tmp_path / "out")) == 2


def test_a_save_that_is_sent_twice_is_stored_once(kinds: Course, tmp_path: Path) -> None:
    queue = MarkingQueue(tmp_path / "out")
    key = item(queue, "ada", ESSAY)
    revision = queue.item(key).revision
    for _ in range(2):
        queue.save(key, [Given(5, "1", ""), Given(15, "2", "fine")], "ann", revision)
    assert comments(tmp_path / "out") == ["", "fine"]


def test_of_several_marks_in_one_save_all_are_stored_or_none(kinds: Course, tmp_path: Path) -> None:
    queue = MarkingQueue(tmp_path / "out")
    key = item(queue, "ada", ESSAY)
    with pytest.raises(CourseError, match="16 points for an example: expected 0 to 15"):
        queue.save(key, [Given(5, "1", ""), Given(16, "2", "")], "ann", queue.item(key).revision)
    assert comments(tmp_path / "out") == []


def test_marks_are_saved_while_the_folder_is_in_use_and_reports_follow_later(
    kinds: Course, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    queue = MarkingQueue(out)
    key = item(queue, "ada", ESSAY)
    with sole_use(out):
        queue.save(
            key, [Given(5, "1", ""), Given(15, "2", "well <b>done</b>")], "ann", queue.item(key).revision
        )
    assert stale(out) == [("ada", "week05_exercise")]
    page = report_path(out, "ada", "week05_exercise")
    assert "done" not in page.read_text()
    assert "Wrote 1 report," in follow_marks(out, kinds)
    assert "an example: well &lt;b&gt;done&lt;/b&gt;" in page.read_text()
    assert "ada,week05_exercise,40.0" in (out / "gradebook.csv").read_text()
    assert stale(out) == []


def test_a_comment_alone_changes_no_points_and_the_last_comment_of_a_row_counts(
    kinds: Course, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    queue = MarkingQueue(out)
    key = item(queue, "ada", ESSAY)
    for comment in ("too short", "short"):
        queue.save(key, [Given(None, "", comment)], "ann", queue.item(key).revision)
    assert queue.item(key).state == "waiting"
    mark_by_hand(out, "ada", "week05", "essay", "5", row="1", comment="clear", course=kinds)
    mark_by_hand(out, "ada", "week05", "essay", "4", row="1", course=kinds)  # keeps the comment
    mark_by_hand(out, "ada", "week05", "essay", "15", row="2", course=kinds)
    (result,) = (one for one in results_in(out) if one["student"] == "ada")
    assert result["row"]["score"] == 38
    page = report_path(out, "ada", "week05_exercise").read_text()
    assert "<p>short</p><p>names the parts: clear</p>" in page
    assert "too short" not in page


def test_the_queue_names_a_damaged_file_and_shows_the_others(kinds: Course, tmp_path: Path) -> None:
    out = tmp_path / "out"
    queue = MarkingQueue(out)
    before = queue.since(0)
    file = marks_path(out, "bob", "week05_exercise")
    file.parent.mkdir(parents=True)
    file.write_text("[{")
    now = queue.since(before["number"])
    assert [str(file) in problem for problem in now["problems"]] == [True]
    file.write_text(json.dumps([]))
    assert queue.since(now["number"])["problems"] == []


def test_only_what_has_changed_is_sent(kinds: Course, tmp_path: Path) -> None:
    queue = MarkingQueue(tmp_path / "out")
    first = queue.since(0)
    assert len(first["items"]) == 4
    assert queue.since(first["number"])["items"] == []
    mark_by_hand(tmp_path / "out", "bob", "week05", "motto", "1", course=kinds)
    changed = queue.since(first["number"])["items"]
    assert {one["student"] for one in changed} == {"bob"}
    assert [one["state"] for one in changed if one["task"] == MOTTO] == ["marked"]
