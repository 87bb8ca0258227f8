import csv
import json
import zipfile
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from course_lib.course.course_file import LatePolicy
from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.records import ReceiptTime
from course_lib.grading.store import Course
from course_lib.grading.submissions.collect import Collection, collect
from course_lib.grading.submissions.submission import find_submissions
from tests.grading.platforms import (
    NAME,
    Handed,
    canvas_json,
    canvas_zip,
    moodle_zip,
    notebook,
    packed,
    table,
    zipped,
)

PARIS = ZoneInfo("Europe/Paris")
TIME = datetime(2026, 3, 8, 23, 59, tzinfo=PARIS)
WORKSHEETS = {  # headings and ways of writing 8 March 2026, 23:59, of Moodle's grading worksheet
    "English": (
        ("Identifier", "Full name", "ID number", "Status", "Grade", "Maximum grade",
         "Last modified (submission)", "Last modified (grade)"),
        "Participant {}", "Sunday, 8 March 2026, 11:59 PM", "Monday, 16 March 2026, 10:00 AM"),
    "German": (
        ("ID", "Vollständiger Name", "ID-Nummer", "Status", "Bewertung", "Bestwertung",
         "Zuletzt geändert (Abgabe)", "Zuletzt geändert (Bewertung)"),
        "Teilnehmer/in{}", "Sonntag, 8. März 2026, 23:59", "Montag, 16. März 2026, 10:00"),
    "Spanish": (
        ("Identificador", "Nombre completo", "Número de ID", "Estado", "Calificación", "Calificación máxima",
         "Última modificación (entrega)", "Última modificación (calificación)"),
        "Participante {}", "domingo, 8 de marzo de 2026, 23:59", "lunes, 16 de marzo de 2026, 10:00"),
    "French": (
        ("Identifiant", "Nom complet", "Numéro d'identification", "Statut", "Note", "Note maximale",
         "Dernière modification (travail remis)", "Dernière modification (note)"),
        "Participant {}", "dimanche 8 mars 2026, 23:59", "lundi 16 mars 2026, 10:00"),
    "Arabic": (
        ("المعرف", "الاسم الكامل", "رقم الهوية", "الحالة", "التقدير", "الحد الأقصى",
         "آخر تعديل (تسليم المهام)", "آخر تعديل (التقدير)"),
        "مشارك {}", "الأحد، 8 مارس 2026، 11:59 م", "الاثنين، 16 مارس 2026، 10:00 ص"),
    "Arabic of the Levant, in its digits": (
        ("المعرف", "الاسم الكامل", "رقم الهوية", "الحالة", "التقدير", "الحد الأقصى",
         "آخر تعديل (تسليم المهام)", "آخر تعديل (التقدير)"),
        "مشارك {}", "الأحد، ٨ آذار ٢٠٢٦، ١١:٥٩ م", "الاثنين، ١٦ آذار ٢٠٢٦، ١٠:٠٠ ص"),  # noqa: RUF001
}  # fmt: skip
STUDENTS = [Handed(f"Student {n}", 4101000 + n, f"2023{n:04}") for n in range(6)]
Collect = Callable[..., Collection]


@pytest.fixture
def sort(tmp_path: Path) -> Collect:
    """Collects in.zip into out."""

    def do(**more: object) -> Collection:
        return collect(tmp_path / "in.zip", tmp_path / "out", PARIS, **more)  # type: ignore[arg-type]

    return do


@pytest.mark.sample(2)
@pytest.mark.parametrize("language", WORKSHEETS)
def test_moodle_worksheet_gives_times_and_ids_in_any_language(
    tmp_path: Path, sort: Collect, language: str
) -> None:
    headings, participant, submitted, graded = WORKSHEETS[language]
    moodle_zip(tmp_path / "in.zip", STUDENTS)
    rows: list[Sequence[str]] = [
        (participant.format(s.number), s.name, s.id, "-", "", "100,00", submitted, graded) for s in STUDENTS
    ]
    absent = (participant.format(4109999), "Absent", "20239999", "-", "", "100,00", "-", graded)
    table(tmp_path / "worksheet.csv", headings, [*rows, absent], ";" if language == "German" else ",")
    collection = sort(roster=tmp_path / "worksheet.csv")
    submissions = find_submissions(tmp_path / "out")
    assert [one.student for one in submissions] == [s.id for s in STUDENTS]
    assert {one.received.time for one in submissions} == {TIME}
    assert {one.received.source for one in submissions} == {f"received.csv (worksheet.csv, {headings[6]})"}
    assert (
        f"note: times are from worksheet.csv, {headings[6]}, interpreted as Europe/Paris" in collection.notes
    )


UNREAD = {"Islamic": "8 رمضان 1447، 23:59", "Thai": "8 มีนาคม 2569 23:59", "none": "8 Nonsense 2026, 23:59"}


@pytest.mark.parametrize("time", UNREAD.values(), ids=UNREAD)
def test_unreadable_times_are_reported_and_not_counted_as_late(
    tmp_path: Path, sort: Collect, time: str
) -> None:
    moodle_zip(tmp_path / "in.zip", STUDENTS)
    rows = [(f"Participant {s.number}", s.id, time) for s in STUDENTS]
    table(tmp_path / "worksheet.csv", ("Identifier", "ID number", "Modified"), rows)
    notes = sort(roster=tmp_path / "worksheet.csv").notes
    assert any(
        note.startswith(f"note: worksheet.csv, Modified: times like {time!r} can't be read") for note in notes
    )
    assert any("Without a time no submission is late" in note for note in notes)
    assert {one.received.time for one in find_submissions(tmp_path / "out")} == {None}


def test_grading_time_and_due_date_are_not_used_as_submission_time(tmp_path: Path, sort: Collect) -> None:
    moodle_zip(tmp_path / "in.zip", STUDENTS)
    due, graded = "Sonntag, 8. März 2026, 23:59", "Montag, 16. März 2026, 10:0{}"
    rows = [
        (f"Teilnehmer/in{s.number}", s.id, due, f"Freitag, 6. März 2026, 10:0{i}", graded.format(i))
        for i, s in enumerate(STUDENTS)
    ]
    headings = ("ID", "ID-Nummer", "Fällig", "Zuletzt geändert (Abgabe)", "Zuletzt geändert (Bewertung)")
    table(tmp_path / "worksheet.csv", headings, rows)
    sort(roster=tmp_path / "worksheet.csv")
    times = [one.received.time for one in find_submissions(tmp_path / "out")]
    assert times == [datetime(2026, 3, 6, 9, i, tzinfo=UTC) for i in range(6)]


def test_canvas_api_export_gives_submission_times(tmp_path: Path, sort: Collect) -> None:
    students = [
        Handed("ada", 11, "", "2026-03-08T22:59:00+00:00"),
        Handed("bob", 12, "", "2026-03-09T08:00:00+00:00", late=True),
        Handed("cleo", 13, ""),
    ]
    canvas_zip(tmp_path / "in.zip", students)
    canvas_json(tmp_path / "submissions.json", students)
    collection = sort(times=[tmp_path / "submissions.json"])
    by_student = {one.student: one.received for one in find_submissions(tmp_path / "out")}
    assert by_student["11"].time == TIME
    assert by_student["12"].time == datetime(2026, 3, 9, 8, tzinfo=UTC)
    assert (by_student["13"].time, by_student["13"].late) == (None, False)
    assert "note: cleo has no time of submission in submissions.json, submitted_at" in collection.notes


def test_canvas_submissions_csv_gives_submission_times(tmp_path: Path, sort: Collect) -> None:
    canvas_zip(tmp_path / "in.zip", [Handed("ada", 11, ""), Handed("bob", 12, "")])
    rows = [(number, "2026-03-01T00:00:00Z", "2026-03-08T22:59:00Z") for number in (11, 12)]
    table(tmp_path / "s.csv", ("user_id", "cached_due_date", "submitted_at"), rows)
    sort(times=[tmp_path / "s.csv"])
    assert {one.received.time for one in find_submissions(tmp_path / "out")} == {TIME}


def test_export_of_another_assignment_gives_no_submission_times(tmp_path: Path, sort: Collect) -> None:
    canvas_zip(tmp_path / "in.zip", [Handed("ada", 11, "")])
    other = [{"user_id": 11, "submitted_at": "2026-01-01T00:00:00Z", "attachments": [{"id": 7}]}]
    (tmp_path / "other.json").write_text(json.dumps(other))
    sort(times=[tmp_path / "other.json"])
    assert find_submissions(tmp_path / "out")[0].received.time is None


def test_download_time_of_a_zip_does_not_count_as_late(tmp_path: Path, sort: Collect, course: Course) -> None:
    moodle_zip(tmp_path / "in.zip", STUDENTS[:2])
    collection = sort()
    assert any("Moodle's zip has no times of submission: add --roster" in note for note in collection.notes)
    early = (course.exercises / "course.toml").read_text().replace("2026-10-11", "2026-03-09")
    (course.exercises / "course.toml").write_text(early)
    grade(tmp_path / "out", tmp_path / "graded", jobs=1, course=course)
    with (tmp_path / "graded/gradebook.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["days_late"] for row in rows] == ["0", "0"]
    assert all("time of receipt unknown: not counted as late" in row["message"] for row in rows)
    assert "Time of receipt unknown" in next((tmp_path / "graded/reports").glob("*/*.html")).read_text()


def test_corrections_of_the_instructor_are_kept_by_a_repeated_collect(tmp_path: Path, sort: Collect) -> None:
    moodle_zip(tmp_path / "in.zip", STUDENTS[:1])
    headings, participant, submitted, _ = WORKSHEETS["English"]
    row = (participant.format(4101000), "A", "20230000", "-", "", "100", submitted, "-")
    table(tmp_path / "w.csv", headings, [row])
    sort(roster=tmp_path / "w.csv")
    path = tmp_path / "out/received.csv"
    path.write_text(path.read_text().replace("2026-03-08T23:59:00+01:00", "2026-03-01 12:00"))
    collection = sort(roster=tmp_path / "w.csv")
    assert find_submissions(tmp_path / "out", zone=PARIS)[0].received.time == datetime(
        2026, 3, 1, 11, tzinfo=UTC
    )
    assert any("received.csv keeps 2026-03-01 12:00" in note for note in collection.notes)


DEADLINE = datetime(2026, 3, 8, 23, 59, tzinfo=PARIS)


@pytest.mark.parametrize(
    ("late", "receipt", "days", "remark", "notes"),
    [
        (
            True,
            "2026-03-01T12:00:00+00:00",
            1,
            "late according to the platform",
            ["not trusted, it is 0 days"],
        ),
        (False, "2026-03-20T12:00:00+00:00", 0, "not late according to the platform", ["it is 12 days late"]),
        (True, "nonsense", 1, "counted as 1 day", []),
    ],
)
def test_receipt_never_overrides_the_late_marker_of_canvas(
    tmp_path: Path, sort: Collect, late: bool, receipt: str, days: int, remark: str, notes: list[str]
) -> None:
    canvas_zip(
        tmp_path / "in.zip",
        [Handed("ada", 11, "", files={"a.zip": packed("x = 1", "ada", receipt)}, late=late)],
    )
    sort()
    (submission,) = find_submissions(tmp_path / "out")
    assert submission.received.time is None
    assert submission.received.days_late(DEADLINE, LatePolicy()) == days
    assert remark in submission.received.remark(DEADLINE, LatePolicy())
    said = submission.received.contradictions(DEADLINE, LatePolicy())
    assert len(said) == len(notes)
    assert all(part in line for part, line in zip(notes, said, strict=True))


def test_late_marker_contradicting_the_submission_time_is_reported() -> None:
    in_time = ReceiptTime(datetime(2026, 3, 1, tzinfo=UTC), "received.csv", late=True)
    assert in_time.days_late(DEADLINE, LatePolicy()) == 0
    assert in_time.contradictions(DEADLINE, LatePolicy()) == [
        "the platform marks it as late, but according to received.csv it is 0 days late"
    ]
    assert in_time.contradictions(None, LatePolicy()) == [
        "the platform marks it as late, but course.toml has no deadline"
    ]


def test_receipt_time_is_used_without_other_sources_and_noted_in_the_gradebook(tmp_path: Path) -> None:
    (tmp_path / "ada").mkdir()
    (tmp_path / "ada/a.zip").write_bytes(packed("x = 1", "ada", "2026-03-20T12:00:00+00:00"))
    (submission,) = find_submissions(tmp_path)
    assert (submission.received.source, submission.received.is_trusted) == ("receipt", False)
    assert "the student's machine" in submission.received.remark(DEADLINE, LatePolicy())


def test_student_supplied_received_csv_and_timestamp_are_ignored(tmp_path: Path, sort: Collect) -> None:
    moodle_zip(tmp_path / "in.zip", STUDENTS[:1])
    sort()
    folder = tmp_path / "out/participant4101000"
    (folder / "received.csv").write_text(f"file,received\n{NAME},2020-01-01T00:00:00Z\n")
    (folder / "timestamp.txt").write_text("2020-01-01 00:00:00 UTC")
    (submission,) = find_submissions(tmp_path / "out")
    assert submission.received.time is None
    assert sum("is not trusted" in note for note in submission.notes) == 2


def test_timestamp_in_a_student_zip_is_not_kept(tmp_path: Path, sort: Collect) -> None:
    inner = zipped({NAME: notebook(), "timestamp.txt": b"2020-01-01 00:00:00 UTC", "received.csv": b"a,b\n"})
    with zipfile.ZipFile(tmp_path / "in.zip", "w") as archive:
        archive.writestr("submitted/ada/week01/work.zip", inner)
    collection = sort()
    assert len(collection.rejected_lines) == 2
    assert find_submissions(tmp_path / "out")[0].received.time is None


def test_damaged_export_is_rejected(tmp_path: Path, sort: Collect) -> None:
    canvas_zip(tmp_path / "in.zip", [Handed("ada", 11, "")])
    for text in ("{", "[]", "[" * 100_000, '{"errors": "no"}'):
        (tmp_path / "s.json").write_text(text)
        with pytest.raises(CourseError, match=r"s\.json"):
            sort(times=[tmp_path / "s.json"])


def test_received_csv_may_be_next_to_the_submission_folder(tmp_path: Path) -> None:
    (tmp_path / "in/ada").mkdir(parents=True)
    (tmp_path / "in/ada" / NAME).write_bytes(notebook())
    (tmp_path / "received.csv").write_text(f"file,received\nin/ada/{NAME},2026-03-08T23:59:00+01:00\n")
    (submission,) = find_submissions(tmp_path / "in")
    assert (submission.received.time, submission.received.source) == (TIME, "received.csv")


@pytest.mark.parametrize(
    ("text", "utc"),
    [
        ("2026-03-08 22:59:00.123456 UTC", "22:59"),
        ("2026-03-08 22:59:00", "22:59"),
        ("2026-03-08 23:59:00 CET", "22:59"),
        ("2026-03-08 23:59:00 Europe/Paris", "22:59"),
        ("2026-03-08T23:59:00+01:00", "22:59"),
    ],
)
def test_nbgrader_timestamp_is_read_in_its_time_zone(tmp_path: Path, text: str, utc: str) -> None:
    folder = tmp_path / "ada/week01"
    folder.mkdir(parents=True)
    (folder / NAME).write_bytes(notebook())
    (folder / "timestamp.txt").write_text(text + "\n")
    (submission,) = find_submissions(tmp_path)
    assert submission.received.source == "timestamp.txt"
    assert f"{submission.received.time:%H:%M}" == utc


def test_timestamp_in_an_unpacked_download_is_ignored(tmp_path: Path) -> None:
    folder = tmp_path / "Ada_7_assignsubmission_file_"
    folder.mkdir()
    (folder / NAME).write_bytes(notebook())
    (folder / "timestamp.txt").write_text("2020-01-01 00:00:00 UTC")
    (submission,) = find_submissions(tmp_path)
    assert submission.received.time is None
