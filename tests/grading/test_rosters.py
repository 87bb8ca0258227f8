"""Rosters in any language, anonymous downloads, and the course's time zone."""

import csv
import json
from pathlib import Path
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import pytest

from course_lib.course import course_file
from course_lib.course.course_file import find_zone, read_course_file
from course_lib.errors import CourseError
from course_lib.grading.submissions.collect import Collection, collect
from course_lib.grading.submissions.readers import platform_name
from course_lib.grading.submissions.roster import read_class, read_class_list
from course_lib.grading.submissions.submission import UTC
from tests.grading.platforms import NAME, Handed, canvas_zip, moodle_zip, notebook, table, zipped
from tests.test_cli import course

STUDENTS = [Handed(f"Student {n}", 4101000 + n, f"s{n:03}") for n in range(4)]


def collected(tmp_path: Path, **more: object) -> Collection:
    return collect(tmp_path / "in.zip", tmp_path / "out", UTC, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("headings", "cell"),
    [
        (("Identifier", "ID number", "Full name"), "Participant {}"),
        (("Identifier", "ID number", "Full name"), "Participant_{}"),
        (("ID", "ID-Nummer", "Vollständiger Name"), "Teilnehmer/in{}"),
        (("المعرف", "رقم الهوية", "الاسم الكامل"), "\u200fمشارك {}"),  # noqa: RUF001
        (("識別子", "IDナンバー", "フルネーム"), "参加者 {}"),
        (("Number", "Student", "Name"), "{}"),
    ],
)
def test_roster_columns_are_identified_by_their_content(
    tmp_path: Path, headings: tuple[str, ...], cell: str
) -> None:
    moodle_zip(tmp_path / "in.zip", STUDENTS)
    rows = [(cell.format(s.number), s.id, f"{s.name} of class {n}") for n, s in enumerate(STUDENTS)]
    table(tmp_path / "roster.csv", headings, rows)
    assert collected(tmp_path, roster=tmp_path / "roster.csv").students == {s.id for s in STUDENTS}


def test_canvas_gradebook_headings_are_recognized_as_a_roster(tmp_path: Path) -> None:
    students = [Handed("ada", 11, "A1"), Handed("bob", 12, "B2")]
    canvas_zip(tmp_path / "in.zip", students)
    rows = [("", "", "", "", ""), ("    Points Possible", "", "", "", "100")]
    rows += [(s.name, str(s.number), s.id, f"{s.name}@x.org", "") for s in students]
    table(tmp_path / "gradebook.csv", ("Student", "ID", "SIS User ID", "SIS Login ID", "Week 1 (7)"), rows)
    assert collected(tmp_path, roster=tmp_path / "gradebook.csv").students == {"a1", "b2"}


def test_ambiguous_id_column_is_reported_with_the_option_to_pass(tmp_path: Path) -> None:
    moodle_zip(tmp_path / "in.zip", STUDENTS)
    rows = [(f"Teilnehmer/in{s.number}", f"login{s.id}", s.id) for s in STUDENTS]
    table(tmp_path / "roster.csv", ("ID", "Anmeldename", "ID-Nummer"), rows)
    with pytest.raises(CourseError, match=r"Add --id-column 'Anmeldename'; columns: 'ID', .*'ID-Nummer'"):
        collected(tmp_path, roster=tmp_path / "roster.csv")
    collection = collected(tmp_path, roster=tmp_path / "roster.csv", id_column="ID-Nummer")
    assert collection.students == {s.id for s in STUDENTS}


def test_unsuitable_roster_is_rejected_with_the_export_to_use(tmp_path: Path) -> None:
    moodle_zip(tmp_path / "in.zip", STUDENTS)
    table(tmp_path / "roster.csv", ("Vorname", "Nachname", "E-Mail"), [("Ada", "L", "ada@x.org")])
    with pytest.raises(CourseError, match=r"like 4101000; its columns: 'Vorname'.*grading worksheet"):
        collected(tmp_path, roster=tmp_path / "roster.csv")
    assert not (tmp_path / "out").exists()


def test_download_of_groups_is_rejected_with_the_folders_to_make(tmp_path: Path) -> None:
    """Moodle names the folders after groups if students submit in groups, with the groups' numbers."""
    moodle_zip(tmp_path / "in.zip", [Handed("Team A", 17, "a"), Handed("Team B", 18, "b")])
    rows = [(f"Participant {s.number}", s.name, s.id, f"Team {'AB'[n % 2]}") for n, s in enumerate(STUDENTS)]
    table(tmp_path / "w.csv", ("Identifier", "Full name", "ID number", "Group"), rows)
    message = (
        "'team a' twice in 'Group': if .* in groups, copy each group's file into a folder of each member"
    )
    with pytest.raises(CourseError, match=message):
        collected(tmp_path, roster=tmp_path / "w.csv", id_column="ID number")


def test_roster_for_a_download_without_numbers_is_ignored_with_a_note(tmp_path: Path) -> None:
    (tmp_path / "in/ada").mkdir(parents=True)
    (tmp_path / "in/ada/week01_exercise.ipynb").write_text("{}")
    table(tmp_path / "roster.csv", ("a", "b"), [("1", "2")])
    collection = collect(tmp_path / "in", tmp_path / "out", UTC, tmp_path / "roster.csv")
    assert any("so the exports are ignored" in note for note in collection.notes)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("Ada_4101000_assignsubmission_file_", ("moodle", "4101000", None, "")),
        ("Ada_4101000_assignsubmission_file", ("moodle", "4101000", None, "")),
        ("Participant_7_assignsubmission_file_a.ipynb", ("moodle", "7", None, "a.ipynb")),
        ("Teilnehmerin_7_assignsubmission_file_a_1_2_b.py", ("moodle", "7", None, "a_1_2_b.py")),
        ("lovelaceada_11_900_a.ipynb", ("canvas", "11", False, "a.ipynb")),
        ("van_dijk_LATE_11_900_a_b.ipynb", ("canvas", "11", True, "a_b.ipynb")),
        ("anon_aB3xy_900_a.ipynb", ("anonymous", "aB3xy", False, "a.ipynb")),
        ("LATE_anon_12345_900_a.ipynb", ("anonymous", "12345", True, "a.ipynb")),
        ("week01_exercise.ipynb", None),
        ("week01_exercise_20231234.zip", None),
    ],
)
def test_person_names_of_each_platform_are_parsed(name: str, expected: tuple[object, ...] | None) -> None:
    found = platform_name(name)
    assert (found and (found.platform, found.number, found.late, found.file)) == expected


def test_anonymous_download_is_reported_with_advice(tmp_path: Path) -> None:
    (tmp_path / "in.zip").write_bytes(zipped({f"anon_aB3xy_900_{NAME}": notebook()}))
    collection = collected(tmp_path)
    assert collection.students == {"anon_ab3xy"}
    assert any("turn off anonymous grading" in note and "--times" in note for note in collection.notes)
    entry = {"user_id": 11, "anonymous_id": "aB3xy", "submitted_at": "2026-03-08T22:59:00Z"}
    (tmp_path / "s.json").write_text(json.dumps([entry]))
    table(tmp_path / "gradebook.csv", ("Student", "ID", "SIS User ID"), [("Ada", 11, "A1")])
    times = [tmp_path / "s.json"]
    assert collect(tmp_path / "in.zip", tmp_path / "2", UTC, times=times).students == {"11"}
    collection = collect(tmp_path / "in.zip", tmp_path / "3", UTC, tmp_path / "gradebook.csv", times=times)
    assert collection.students == {"a1"}
    assert not any("anonymous" in note for note in collection.notes)


def test_course_without_a_time_zone_uses_the_zone_of_the_machine_with_one_notice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tzlocal.get_localzone", lambda: ZoneInfo("America/Lima"))  # the real one keeps it
    path = tmp_path / "course.toml"
    path.write_text('title = "A"\n[weeks.week01]\ntitle = "B"\ndeadline = 2026-03-08T23:59:00\n')
    course_file = read_course_file(path)
    assert course_file.zone.key == "America/Lima"
    assert "America/Lima, this machine's zone" in course_file.zone_note
    deadline = course_file.deadline("week01", "ada")
    assert deadline is not None
    assert deadline.utcoffset() == ZoneInfo("America/Lima").utcoffset(deadline)
    path.write_text('title = "A"\ntime_zone = "Europe/Paris"\n[weeks.week01]\ntitle = "B"\n')
    assert (read_course_file(path).zone.key, read_course_file(path).zone_note) == ("Europe/Paris", "")


def test_machine_without_a_time_zone_is_an_error_with_the_entry_to_write(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def conflicting() -> None:
        raise ZoneInfoNotFoundError("Multiple conflicting time zone configurations found")

    monkeypatch.setattr("tzlocal.get_localzone", conflicting)
    with pytest.raises(CourseError, match='time_zone = "Europe/Paris"'):
        course_file.machine_zone()


def test_unknown_time_zone_is_rejected() -> None:
    with pytest.raises(CourseError, match="Did you mean Europe/Paris"):
        find_zone("Europe/Pariss")


@pytest.mark.slow
def test_commands_read_a_worksheet_and_report_the_time_zone_once(tmp_path: Path) -> None:
    moodle_zip(tmp_path / "moodle.zip", STUDENTS)
    rows = [(f"Teilnehmer/in{s.number}", s.id, "Sonntag, 8. März 2026, 23:59") for s in STUDENTS]
    table(tmp_path / "w.csv", ("ID", "ID-Nummer", "Zuletzt geändert (Abgabe)"), rows)
    command = ("collect", "moodle.zip", "--out", "in", "--roster", "w.csv")
    process = course(*command, cwd=tmp_path)
    assert process.returncode == 0, process.stderr
    assert process.stdout.count("this machine's zone") == 1
    process = course(*command[:3], "in2", *command[4:], "--time-zone", "Asia/Tokyo", cwd=tmp_path)
    assert "this machine's zone" not in process.stdout
    with (tmp_path / "in2/received.csv").open(newline="") as file:
        assert {row["received"] for row in csv.DictReader(file)} == {"2026-03-08T23:59:00+09:00"}


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_class_list_with_only_ids_is_accepted(tmp_path: Path, end: str) -> None:
    path = tmp_path / "roster.csv"
    path.write_text(f"id{end}S001{end}s002{end}{end}", newline="")
    assert [member.id for member in read_class_list(path)] == ["s001", "s002"]
    assert read_class(path, "") == read_class(path, "id") == ["s001", "s002"]
