"""Assignment of files to students: real names of each platform, and names chosen by students."""

import re
import unicodedata
from datetime import UTC, datetime
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from course_lib.errors import CourseError
from course_lib.grading.submissions.collect import collect
from course_lib.grading.submissions.readers import (
    BY_LAYOUT,
    LAYOUTS,
    READERS,
    Layout,
    Reader,
    add_blackboard_title,
    choose_layout,
    gradescope_records,
    sakai_time,
)
from course_lib.grading.submissions.submission import find_submissions
from tests.grading.platforms import NAME, notebook, zipped

ROOT = Path(__file__).parents[2]
PARIS = ZoneInfo("Europe/Paris")
EVENING = datetime(2026, 3, 8, 22, 59, tzinfo=UTC)
# For each platform: names as it writes them, with the key of the owner, the default ID, and the
# time.
NAMES: dict[str, list[tuple[str, str, str, datetime | None]]] = {
    "moodle": [
        (f"Ada Lovelace_4100001_assignsubmission_file_/{NAME}", "4100001", "participant4100001", None),
        (f"Bob O'Neil_4100002_assignsubmission_file_{NAME}", "4100002", "participant4100002", None),
        (f"Group A-Zoë Ågren_7_assignsubmission_file_/sub/{NAME}", "7", "participant7", None),
        (f"Teilnehmer_12_assignsubmission_file_{NAME}", "12", "participant12", None),
        ("Emma E_9_assignsubmission_onlinetext_/onlinetext.html", "9", "participant9", None),
    ],
    "canvas": [
        (f"lovelaceada_4100001_90001_{NAME}", "4100001", "4100001", None),
        ("oneilbob_LATE_4100002_90002_week01_exercise-1.ipynb", "4100002", "4100002", None),
        ("van_dijk_4100003_90003_my_work_v2.zip", "4100003", "4100003", None),
        ("doejane_LATE_4100004_text.html", "4100004", "4100004", None),
        ("doejane_4100005_link.html", "4100005", "4100005", None),
        ("poecleo_LATE_4100006_media.html", "4100006", "4100006", None),
        (f"sparksal_4100007_question_12_90007_{NAME}", "4100007", "4100007", None),
        (f"raymay_4100008_90008_question_12_90007_{NAME}", "4100008", "4100008", None),
    ],
    "anonymous": [
        (f"anon_aB3xy_90001_{NAME}", "aB3xy", "anon_ab3xy", None),
        (f"LATE_anon_12345_90002_{NAME}", "12345", "anon_12345", None),
        ("anon_Zz9_text.html", "Zz9", "anon_zz9", None),
    ],
    "blackboard": [
        (f"Week 1_alovelace_attempt_2026-03-08-23-59-00_{NAME}", "alovelace", "alovelace", EVENING),
        (f"Week 1_4100002_attempt_2026-03-08-23-59-00_{NAME}", "4100002", "4100002", EVENING),
        (f"Week 1_stu_ada_attempt_2026-03-08-23-59-00_{NAME}", "stu_ada", "stu_ada", EVENING),
    ],
    "brightspace": [
        (f"39786-640693 - Ada Lovelace - Mar 8, 2026 1159 PM/{NAME}", "39786", "39786", EVENING),
        (f"39787-640693 - Anne - Marie Smith - Mar 8, 2026 11:59 PM/{NAME}", "39787", "39787", EVENING),
        (f"39788-640693 - Bob Roe - Mar 8, 2026 1159 PM - {NAME}", "39788", "39788", EVENING),
        (f"39789-640693 - Cleo Poe - 8 March, 2026 2359/{NAME}", "39789", "39789", EVENING),
        (f"39790-640693 - Zoë Ågren - 8 mars 2026 2359/{NAME}", "39790", "39790", EVENING),
        (f"39791-640693 - Zoë Ågren - mars 8, 2026 23 h 59/{NAME}", "39791", "39791", EVENING),
        (f"39792-640693 - Jan Maier - 8. März 2026 2359/{NAME}", "39792", "39792", EVENING),
        (f"39793-640693 - Eva Gil - 8 de marzo de 2026 2359/{NAME}", "39793", "39793", EVENING),
    ],
    "sakai": [
        (f"Week 1/Lovelace, Ada(alovelace)/Submission attachment(s)/{NAME}", "alovelace", "alovelace", None),
        (f"Week 1/Roe, Bob(4100002)/Submission attachment(s)/sub/{NAME}", "4100002", "4100002", None),
        (f"Week 1/Poe, Cleo(cpoe001)_Submission attachment(s)_{NAME}", "cpoe001", "cpoe001", None),
    ],
    "gradescope": [
        (f"assignment_9100_export/submission_7001/{NAME}", "7001", "4100001", EVENING),
        (f"assignment_9100_export/submission_7002/sub/{NAME}", "7002", "bob@x.org", EVENING),
    ],
    "teams": [
        (f"Submitted files/Ada Lovelace/Week 1/Version 1/{NAME}", "Ada Lovelace", "adalovelace", None),
        (f"Submitted files/Bob O'Neil/Week 1/Version 2/{NAME}", "Bob O'Neil", "boboneil", None),
        (f"Student Work/Submitted files/Cleo/Week 1/Version 1/{NAME}", "Cleo", "cleo", None),
        (f"Übermittelte Dateien/Zoë Ågren/Woche/Version 1/{NAME}", "Zoë Ågren", "zoëågren", None),
    ],
    "ilias": [
        (f"Week 1/Abgaben/Lovelace_Ada_alovelace_7001/{NAME}", "7001", "alovelace", None),
        (f"Week 1/Submissions/Roe_Bob_broe_7002/sub/{NAME}", "7002", "broe", None),
        (f"Submissions/Team 3/Poe_Cleo_cpoe_7003/20260308225900_{NAME}", "7003", "cpoe", None),
        (f"Multi/Ada_Byron_ada1_101/20260308_235900_{NAME}", "101", "ada1", None),
    ],
    "codegrade": [
        (f"Ada Lovelace - 2026-03-08T22:59:00.000000/{NAME}", "Ada Lovelace", "adalovelace", EVENING),
        (f"Week 1/Bob Roe - 2026-03-08T22_59_00.123456/{NAME}", "Bob Roe", "bobroe", EVENING),
    ],
    "nbgrader": [
        (f"submitted/ada/week01/{NAME}", "ada", "ada", None),
        (f"submitted/ada/week01/sub/{NAME}", "ada", "ada", None),
        (f"inbound/bob+week01+2026-03-08 22:59:00.123456 UTC+c2Vj/{NAME}", "bob", "bob", None),
        (f"cleo+week01+2026-03-08 22:59:00 UTC/{NAME}", "cleo", "cleo", None),
    ],
}
METADATA = b"""submission_7001:
  :submitters:
  - :name: Ada Lovelace
    :sid: '4100001'
    :email: ada@x.org
  :created_at: 2026-03-08 22:59:00.123456789 Z
  :results: !ruby/hash:ActiveSupport::HashWithIndifferentAccess
    tests: []
submission_7002:
  :submitters:
  - :name: Bob
    :sid:
    :email: bob@x.org
  :created_at: 2026-03-08 17:59:00.000000000 -0500
"""


def exercise(code: str) -> bytes:
    return notebook(code, exercise="week01_exercise")


def layout_of(names: list[str], source: str = "download.zip") -> Layout:
    paths = [tuple(name.split("/")) for name in names]
    layout = choose_layout(paths, source, PARIS)
    if layout.name == "blackboard":
        layout = add_blackboard_title(layout, paths)
    if layout.name == "gradescope":
        records = gradescope_records(METADATA, PARIS)
        return Layout("gradescope", PARIS, records=records)
    return layout


@pytest.mark.parametrize("platform", NAMES)
def test_owner_and_time_are_parsed_from_real_file_names(platform: str) -> None:
    rows = NAMES[platform]
    layout = layout_of([name for name, *_ in rows])
    assert layout.name == platform
    for name, key, student, time in rows:
        download_name = layout.read(tuple(name.split("/")))
        found = download_name.time and download_name.time.replace(second=0, microsecond=0)
        assert (download_name.key, download_name.student, found) == (key, student, time), name


@pytest.mark.parametrize("platform", NAMES)
def test_each_file_name_matches_exactly_one_platform(platform: str) -> None:
    for name, *_ in NAMES[platform]:
        assert layout_of([name]).name == platform, name


def test_every_layout_has_a_table_of_file_names() -> None:
    assert {*BY_LAYOUT} == {*NAMES}, "NAMES above has names of each reader in READERS"
    assert {*NAMES, "folders", "google"} - {"anonymous"} == {*LAYOUTS}


def test_instructor_guide_describes_the_download_of_every_platform() -> None:
    guide = (ROOT / "docs" / "instructor.md").read_text("utf-8")
    rows = re.findall(r"^\| ([^|]+) \| [^|]+ \| [^|]+ \|$", guide.split("\n## Collect\n")[1], re.MULTILINE)
    named = {name.strip() for row in rows for name in row.split(",")}
    missing = {reader.title for reader in READERS} - named
    assert missing == set(), "docs/instructor.md has a table of platforms below Collect"


@pytest.mark.parametrize("reader", READERS, ids=lambda reader: str(reader.layout))
def test_download_of_another_platform_is_rejected_with_a_matching_example(reader: Reader) -> None:
    with pytest.raises(CourseError, match=re.escape(f"expected {reader.example}")):
        choose_layout([("ada", NAME)], "in.zip", PARIS, reader.layout)
    assert reader.match(tuple(reader.example.split(" and ")[0].split("/")))


# File names that a student may choose, including the names of every platform.
PIECES = [piece for rows in NAMES.values() for name, *_ in rows for piece in name.split("/")]
FILE_NAMES = st.lists(
    st.one_of(
        st.sampled_from([*PIECES, "_4100001_", "_90009_", " - ", "(4100001)", "+"]),
        st.just("attempt_2020-01-01-00-00-00_"),
        st.text("ab_-().+ 0123456789T:é", max_size=12),
    ),
    min_size=1,
    max_size=5,
).map(lambda parts: re.sub(r"[/\\]", "", "".join(parts))[:120] + f"_{NAME}")  # fmt: skip
FOLDER_NAMES = FILE_NAMES.map(lambda name: name.removesuffix(f"_{NAME}") or "x")
# The platform's prefix and suffix of Eve's file; her ID is 4100002.
EVES = {
    "moodle": ("Eve E_4100002_assignsubmission_file_", "4100002", None),
    "moodle folder": ("Eve E_4100002_assignsubmission_file_/", "4100002", None),
    "canvas": ("evee_4100002_90002_", "4100002", None),
    "blackboard": ("Week 1_4100002_attempt_2026-03-08-23-59-00_", "4100002", EVENING),
    "brightspace": ("4100002-64 - Eve E - Mar 8, 2026 1159 PM/", "4100002", EVENING),
    "brightspace flat": ("4100002-64 - Eve E - Mar 8, 2026 1159 PM - ", "4100002", EVENING),
    "sakai": ("Week 1/E, Eve(4100002)/Submission attachment(s)/", "4100002", None),
    "sakai flat": ("Week 1/E, Eve(4100002)_Submission attachment(s)_", "4100002", None),
    "teams": ("Submitted files/Eve E/Week 1/Version 1/", "Eve E", None),
    "ilias": ("Week 1/Abgaben/E_Eve_eve_4100002/", "4100002", None),
    "codegrade": ("Week 1/Eve E - 2026-03-08T22:59:00.000000/", "Eve E", EVENING),
    "nbgrader": ("submitted/4100002/week01/", "4100002", None),
    "folders": ("4100002/", "4100002", None),
}


@pytest.mark.sample(1)
@pytest.mark.parametrize("platform", EVES)
@settings(max_examples=150, deadline=None)
@given(name=FILE_NAMES, folder=st.one_of(st.just(""), FOLDER_NAMES))
@example(name=f"x_4100001_assignsubmission_file_{NAME}", folder="")
@example(name=f"x_4100001_attempt_2020-01-01-00-00-00_{NAME}", folder="")
@example(name=f"LATE_4100001_90001_{NAME}", folder="Ada(4100001)")
@example(name=NAME, folder="Submission attachment(s)")
@example(name=NAME, folder="Ann_Ann_ann_4100001")
@example(name=NAME, folder="Version 9")
def test_file_name_chosen_by_a_student_cannot_change_owner_or_time(
    platform: str, name: str, folder: str
) -> None:
    prefix, key, time = EVES[platform]
    others = [f"{one}{NAME}" for one in OTHERS[platform]]
    mine = f"{prefix}{folder}/{name}" if folder else f"{prefix}{name}"
    layout = layout_of([*others, mine])
    assert layout.name == platform.split()[0]
    download_name = layout.read(tuple(mine.split("/")))
    assert (download_name.key, download_name.time) == (key, time)
    for other in others:
        assert layout.read(tuple(other.split("/"))).key != key


OTHERS = {
    platform: [
        prefix.replace("4100002", number).replace("Eve E", who).replace("evee", who.replace(" ", "").lower())
        for number, who in (("4100001", "Ann A"), ("4100003", "Bob B"), ("4100004", "Cleo C"))
    ]
    for platform, (prefix, _, _) in EVES.items()
}


def test_file_is_never_collected_into_the_folder_of_another_student(tmp_path: Path) -> None:
    eves = f"Eve E_4100002_assignsubmission_file_x_4100001_assignsubmission_file_{NAME}"
    anns = f"Ann A_4100001_assignsubmission_file_{NAME}"
    (tmp_path / "in.zip").write_bytes(zipped({anns: exercise("ann = 1"), eves: exercise("eve = 1")}))
    collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    by_student = {
        one.student: one.notebook and one.notebook.cells for one in find_submissions(tmp_path / "out")
    }
    assert by_student == {"participant4100001": ("ann = 1",), "participant4100002": ("eve = 1",)}


def put(top: Path, files: dict[str, bytes]) -> Path:
    for name, data in files.items():
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).write_bytes(data)
    return top


STAMP = b"2026-03-08 22:59:00.000000 UTC"


@pytest.mark.parametrize("own", [b"", b"2020-01-01 00:00:00 UTC"])
def test_nbgrader_timestamp_applies_to_a_notebook_in_a_subfolder(tmp_path: Path, own: bytes) -> None:
    files = {"submitted/eve/week01/timestamp.txt": STAMP, f"submitted/eve/week01/sub/{NAME}": notebook()}
    files |= {"submitted/eve/week01/sub/timestamp.txt": own} if own else {}
    collect(put(tmp_path / "in", files), tmp_path / "out", PARIS)
    for top in (tmp_path / "out", tmp_path / "in/submitted"):
        (one,) = find_submissions(top)
        assert (one.student, one.received.time, one.received.source) == ("eve", EVENING, "timestamp.txt")


def test_timestamp_file_below_the_nbgrader_timestamp_is_ignored(tmp_path: Path) -> None:
    files = {f"submitted/eve/week01/a/{NAME}": notebook(), "submitted/eve/week01/a/timestamp.txt": STAMP}
    collect(put(tmp_path / "in", files), tmp_path / "out", PARIS)
    for top in (tmp_path / "out", tmp_path / "in/submitted"):
        (one,) = find_submissions(top)
        assert one.received.time is None


def test_timestamp_in_a_folder_not_written_by_nbgrader_is_rejected(tmp_path: Path) -> None:
    files = {f"{student}/week01/{NAME}": notebook(student) for student in ("ada", "eve")}
    collection = collect(
        put(tmp_path / "in", {**files, "eve/week01/timestamp.txt": STAMP}), tmp_path / "out", PARIS
    )
    assert ["timestamp.txt" in line for line in collection.rejected_lines] == [True]
    assert {one.received.time for one in find_submissions(tmp_path / "out")} == {None}


def test_gradescope_export_is_sorted_by_its_metadata(tmp_path: Path) -> None:
    top = "assignment_9100_export"
    files = {f"{top}/submission_{n}/{NAME}": notebook(f"x = {n}") for n in (7001, 7002)}
    (tmp_path / "in.zip").write_bytes(zipped({**files, f"{top}/submission_metadata.yml": METADATA}))
    collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    by_student = {one.student: one.received for one in find_submissions(tmp_path / "out")}
    assert {*by_student} == {"4100001", "bob@x.org"}
    assert {one.time and one.time.replace(second=0) for one in by_student.values()} == {EVENING}


def test_gradescope_folders_without_metadata_are_rejected(tmp_path: Path) -> None:
    (tmp_path / "in.zip").write_bytes(zipped({f"submission_7001/{NAME}": notebook()}))
    with pytest.raises(CourseError, match=r"not submission_metadata.yml.*whole export"):
        collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("text", [b"20260308225900000", b"2026-03-08T22:59:00Z"])
def test_sakai_time_is_read_from_the_student_folder(tmp_path: Path, text: bytes) -> None:
    files = {}
    for student in ("ada", "bob"):
        folder = f"Week 1/X, {student}({student})"
        files[f"{folder}/Submission attachment(s)/{NAME}"] = notebook(student)
        files[f"{folder}/timestamp.txt"] = text
    files["Week 1/X, bob(bob)/Submission attachment(s)/timestamp.txt"] = b"20200101000000000"
    files["Week 1/grades.csv"] = b"Display ID,ID\n"
    (tmp_path / "in.zip").write_bytes(zipped(files))
    collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    by_student = {one.student: one.received.time for one in find_submissions(tmp_path / "out")}
    assert by_student == {"ada": EVENING, "bob": EVENING}
    assert sakai_time(b"tomorrow") is None


def test_newest_attempt_of_blackboard_counts(tmp_path: Path) -> None:
    name = f"Week 1_ada_l_attempt_2026-03-0{{}}-10-00-00_{NAME}"
    files = {name.format(day): notebook(f"x = {day}") for day in (3, 8, 5)}
    files[f"Week 1_bob_attempt_2026-03-03-10-00-00_{NAME}"] = notebook("bob = 1")
    files["Week 1_bob_attempt_2026-03-03-10-00-00.txt"] = b"Name: Bob Roe (bob)"
    (tmp_path / "in.zip").write_bytes(zipped(files))
    collection = collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    by_student = {
        one.student: one.notebook and one.notebook.cells for one in find_submissions(tmp_path / "out")
    }
    assert (by_student, collection.rejected_lines) == ({"ada_l": ("x = 8",), "bob": ("bob = 1",)}, [])


def test_newest_version_of_teams_counts_and_working_files_do_not(tmp_path: Path) -> None:
    files = {f"Submitted files/Ada L/Week 1/Version {n}/{NAME}": notebook(f"x = {n}") for n in (1, 10, 2)}
    files[f"Working files/Ada L/Week 1/{NAME}"] = notebook("draft = 1")
    (tmp_path / "in.zip").write_bytes(zipped(files))
    collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    (one,) = find_submissions(tmp_path / "out")
    assert (one.student, one.notebook and one.notebook.cells) == ("adal", ("x = 10",))


def test_google_drive_files_belong_to_the_named_student_and_duplicate_claims_are_rejected(
    tmp_path: Path,
) -> None:
    files = {
        f"week1/{student}.ipynb": notebook(student, student=student, exercise="week01_exercise")
        for student in ("ada", "bob")
    }
    files["week1/Ada Lovelace.ipynb"] = notebook("eve", student="ada", exercise="week01_exercise")
    (tmp_path / "week1-20261011T100000Z-001.zip").write_bytes(zipped(files))
    collect(tmp_path / "week1-20261011T100000Z-001.zip", tmp_path / "out", PARIS)
    by_student = {one.student: one.reason for one in find_submissions(tmp_path / "out")}
    assert by_student == {"ada": "claimed twice", "bob": ""}


UNKNOWN = {
    "one folder of files": {"week1/a.ipynb": "1", "week1/b.ipynb": "2"},
    "folders in one folder": {f"week1/a/{NAME}": "1", f"week1/b/{NAME}": "2"},
    "folders without IDs": {f"week1/a/{NAME}": "", f"week1/b/{NAME}": ""},
    "two IDs of one student": {f"ada/{NAME}": "1", "ada/week01_exercise (1).ipynb": "2", f"bob/{NAME}": "3"},
}


@pytest.mark.parametrize("kind", UNKNOWN)
def test_unknown_layout_is_rejected_and_nothing_is_collected(tmp_path: Path, kind: str) -> None:
    files = {
        name: notebook(name, exercise="week01_exercise", **({"student": student} if student else {}))
        for name, student in UNKNOWN[kind].items()
    }
    (tmp_path / "in.zip").write_bytes(zipped(files))
    with pytest.raises(CourseError, match=r"nothing is collected.*--layout google.*--layout folders"):
        collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    assert not (tmp_path / "out").exists()
    assert collect(tmp_path / "in.zip", tmp_path / "2", PARIS, layout="folders").count == len(files)


WRAPPED = {  # a download in a separate folder, with files that contain no names
    "canvas": lambda who: f"submissions/{who}_41{len(who)}_9000_{NAME}",
    "teams": lambda who: f"Arbeiten/Übermittelte Dateien/{who}/Week 1/Version 1/{NAME}",
    "ilias": lambda who: f"Semaine 1/Soumissions/{who}_X_{who}_71/{NAME}",
    "nbgrader": lambda who: f"course/submitted/{who}/week01/{NAME}",
    "deep folders": lambda who: f"a/b/c/{who}/{NAME}",
    "two sections": lambda who: f"section {len(who) % 2}/{who}/{NAME}",
}


@pytest.mark.parametrize("kind", WRAPPED)
def test_download_inside_an_extra_folder_is_not_collected_as_one_student(tmp_path: Path, kind: str) -> None:
    files = {
        WRAPPED[kind](student): notebook(student, exercise="week01_exercise")
        for student in ("ada", "bobb", "cleos", "didier")
    }
    (tmp_path / "in.zip").write_bytes(zipped(files))
    with pytest.raises(CourseError, match=r"layout of this download is unknown and nothing is collected"):
        collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    assert not (tmp_path / "out").exists()


def test_copies_in_a_student_subfolder_do_not_reject_the_download(tmp_path: Path) -> None:
    files = {
        f"{student}/{NAME}": notebook(student, exercise="week01_exercise")
        for student in ("ada", "bob", "cleo")
    }
    files[f"ada/backup/{NAME}"] = notebook("old", exercise="week01_exercise")
    (tmp_path / "in.zip").write_bytes(zipped(files))
    assert collect(tmp_path / "in.zip", tmp_path / "out", PARIS).students == {"ada", "bob", "cleo"}


def test_folder_named_after_a_person_gives_a_normalized_id(tmp_path: Path) -> None:
    files = {
        f"{student}/{NAME}": notebook(student, exercise="week01_exercise")
        for student in ("Ada L", "Bob O'Neil (2)")
    }
    (tmp_path / "in.zip").write_bytes(zipped(files))
    collection = collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    assert (collection.students, collection.rejected_lines) == ({"adal", "boboneil2"}, [])
    files[f"Bob-ONeil 2/{NAME}"] = files[f"boboneil2/{NAME}"] = notebook("x", exercise="week01_exercise")
    (tmp_path / "in.zip").write_bytes(zipped(files))
    with pytest.raises(CourseError, match=r"would both belong to boboneil2, so nothing is collected"):
        collect(tmp_path / "in.zip", tmp_path / "2", PARIS)


def test_students_with_colliding_ids_are_rejected_without_a_roster(tmp_path: Path) -> None:
    files = {
        f"Submitted files/{student}/Week 1/Version 1/{NAME}": notebook(student)
        for student in ("Ada L", "Ada-L.", "AdaL")
    }
    (tmp_path / "in.zip").write_bytes(zipped(files))
    with pytest.raises(CourseError, match=r"'Ada L' and of 'AdaL' would both belong to adal.*--roster"):
        collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    (tmp_path / "roster.csv").write_text("Name,ID number\nAda L,s001\nada-l.,s002\nAdaL,s003\n")
    collection = collect(tmp_path / "in.zip", tmp_path / "out", PARIS, tmp_path / "roster.csv")
    assert collection.students == {"s001", "s002", "s003"}


def test_layout_that_does_not_match_is_rejected_with_an_example(tmp_path: Path) -> None:
    (tmp_path / "in.zip").write_bytes(zipped({f"ada/{NAME}": notebook()}))
    with pytest.raises(
        CourseError, match=r"do not follow Moodle.*ada/week01.*expected Ada Lovelace_4100001_"
    ):
        collect(tmp_path / "in.zip", tmp_path / "out", PARIS, layout="moodle")
    with pytest.raises(CourseError, match="--layout mudle is unknown: expected one of moodle, canvas"):
        collect(tmp_path / "in.zip", tmp_path / "out", PARIS, layout="mudle")


def test_name_matching_two_platforms_is_rejected_with_the_option_to_pass(tmp_path: Path) -> None:
    name = f"evee_4100002_90002_x_4100001_attempt_2020-01-01-00-00-00_{NAME}"
    (tmp_path / "in.zip").write_bytes(zipped({name: notebook()}))
    with pytest.raises(CourseError, match="Add --layout canvas or --layout blackboard"):
        collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
    assert collect(tmp_path / "in.zip", tmp_path / "out", PARIS, layout="canvas").students == {"4100002"}


def decomposed(text: str) -> str:
    """Return a name as macOS stores it."""
    return unicodedata.normalize("NFD", text)


ROSTERED = {
    "Teams": ("Submitted files/{}/Week 1/Version 1/", "Zoë Ågren", "Jürgen Öz"),
    "folders of full names": ("{}/", "Zoë Ågren", "D\u2019Arcy, Jürgen"),
    "OpenOlat": ("{}/1_submissions/", "Ågren_Zoë_zagren", "Öz_Jürgen_j_oez"),
    "ILIAS": ("Week 1/Abgaben/{}/", "Ågren_Zoë_zagren_7001", "Öz_Jürgen_j_oez_7002"),
}


@pytest.mark.parametrize("platform", ROSTERED)
@pytest.mark.parametrize("is_decomposed", [False, True])
def test_names_and_logins_of_folders_are_found_in_the_roster(
    tmp_path: Path, platform: str, is_decomposed: bool
) -> None:
    pattern, *folders = ROSTERED[platform]
    names = [pattern.format(decomposed(one) if is_decomposed else one) for one in folders]
    (tmp_path / "in.zip").write_bytes(zipped({f"{one}{NAME}": exercise(one) for one in names}))
    rows = 'Zoë Ågren,zagren,s001\nJürgen Öz,j_oez,s002\n"D\'Arcy, Jürgen",x,s003\nMia Oez,oez,s004\n'
    (tmp_path / "roster.csv").write_text(f"name,login,id\n{rows}", encoding="utf-8")
    collection = collect(tmp_path / "in.zip", tmp_path / "out", PARIS, tmp_path / "roster.csv", "id")
    assert collection.students == {"s001", "s003" if "D\u2019Arcy" in folders[1] else "s002"}


def test_folders_named_by_ids_are_not_changed_by_a_roster(tmp_path: Path) -> None:
    files = {f"{student}/{NAME}": exercise(student) for student in ("s_001", "s_002", "s_009")}
    (tmp_path / "in.zip").write_bytes(zipped(files))
    (tmp_path / "roster.csv").write_text("id,name,login\ns_001,Ada,002\ns_002,Bob,001\n")
    collection = collect(tmp_path / "in.zip", tmp_path / "out", PARIS, tmp_path / "roster.csv")
    assert collection.students == {"s_001", "s_002", "s_009"}
    assert "note: s_009 is not in the roster, and gets the ID s_009" in collection.notes


def test_folders_of_two_persons_with_one_id_are_rejected(tmp_path: Path) -> None:
    files = {f"{student}/{NAME}": exercise(student) for student in ("Anna Lee", "Annalee", "Bob Roe")}
    (tmp_path / "in.zip").write_bytes(zipped(files))
    with pytest.raises(CourseError, match="'Anna Lee' and of 'Annalee' would both belong to annalee"):
        collect(tmp_path / "in.zip", tmp_path / "out", PARIS)
