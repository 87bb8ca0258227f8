"""Files that instructors' commands read: a platform's tables and zips, class lists, course.toml."""

import json
import random
import tempfile
from collections.abc import Callable
from pathlib import Path
from zoneinfo import ZoneInfo

from course_lib.course.course_file import read_course_file
from course_lib.course.material import exercises_dir
from course_lib.grading.marks import read_marks, read_result
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.submissions.collect import collect
from course_lib.grading.submissions.roster import read_class, read_class_list, read_ids, read_times
from course_lib.grading.submissions.submission import Ledger, find_submissions
from tests.grading.platforms import NAME, notebook, zipped
from tests.hostile.made_up import spoilt

ZONE = ZoneInfo("Europe/Paris")
NUMBERS = ("101", "102")
PIECES = (
    "", " ", '"', '""', ",", ";", "\t", "\n", "\r\n", "\r", "\0", "=cmd|' /C calc'!A0", "../" * 9 + "passwd",
    "/", "\\", "NaN", "inf", "-1", "1e999", "9" * 400, "²", "٣", "\u202e", "\ufeff", "a\u0300" * 40, "🤖",
    "\ud7ff", "CON", "con.txt", "week01", "week99", "Sunday, 8 March 2026, 11:59 PM", "31/02/2026 25:61",
    "0000-00-00 00:00", "2026-03-08T23:59:00+99:99", "9999-12-31 23:59:59", "یکشنبه، 17 اسفند 1404، 11:59",
    "a" * 5000, "(" * 300, "[" * 3000, "{" * 3000, "'''", '"""', "# ", "[weeks.week01]\n", "points = 3\n",
    "true", "1979-05-27", "\x1b[31m", "<script>", "%s%n", "${HOME}", "..", ".", "~",
)  # fmt: skip
TABLES = {
    "roster": "id,name,email,section,group,login\nada1,Ada,ada@x.org,1,g1,ada\nbob2,Bob,bob@x.org,1,g1,bob\n",
    "received": "file,received,late,source,name,download_path,id_from\n"
    "ada1/week01_exercise.ipynb,2026-10-11T23:59:00+02:00,no,x,Ada,x,roster\n",
    "worksheet": 'Identifier,Full name,ID number,"Last modified (submission)",Grade\n'
    'Participant 101,Ada,ada1,"Sunday, 8 March 2026, 11:59 PM",\n'
    'Participant 102,Bob,bob2,"Monday, 9 March 2026, 8:00 AM",\n',
}
PATHS = (
    f"Ada_101_assignsubmission_file_/{NAME}", f"Bob_102_assignsubmission_file_{NAME}",
    f"ada_LATE_101_7_{NAME}", f"anon_x1_7_{NAME}", f"LATE_anon_x1_7_{NAME}", f"ada1/{NAME}",
    f"submitted/ada1/week01/{NAME}", f"inbound/ada1+week01+2026-03-08 23:59:00 UTC+x/{NAME}",
    f"Multi/Ada_Byron_ada1_101/20260308_235900_{NAME}", "ada1.zip", "received.csv",
)  # fmt: skip
API = [{"user_id": 101, "submitted_at": "2026-03-08T22:59:00Z", "attachments": [{"id": 1}], "late": False}]
RECORDS = {
    "marks": [{"task": "week01.a", "points": 1, "row": "", "comment": "", "by": "", "time": ""}],
    "result": {"student": "ada1", "exercise": "week01_exercise", "status": "graded", "tasks": []},
}
VALUES: tuple[object, ...] = (
    None,
    True,
    0,
    -1,
    2**70,
    1e308,
    float("nan"),
    "",
    "x",
    [],
    {},
    [None],
    [[]],
    {"id": None},
)


def mangled(chance: random.Random, text: str) -> bytes:
    """Return a text with random insertions, in a common encoding, occasionally corrupted."""
    for _ in range(chance.randint(0, 5)):
        at = chance.randint(0, len(text))
        text = text[:at] + chance.choice(PIECES) + text[at + chance.choice((0, 0, 1, 5, 30)) :]
    data = text.encode(chance.choice(("utf-8", "utf-8", "utf-8-sig", "utf-16", "latin-1")), "replace")
    return spoilt(chance, data) if chance.random() < 0.2 else data


def mangled_json(chance: random.Random, content: object) -> bytes:
    """Return JSON in which values are exchanged, or which is no JSON, or very deep."""
    if chance.random() < 0.1:
        return chance.choice(("[" * 100_000, '{"a":' * 50_000, "[NaN]", "1" * 5000)).encode()
    return mangled(chance, json.dumps(_changed(chance, content)))


def _changed(chance: random.Random, content: object) -> object:
    if chance.random() < 0.15:
        return chance.choice(VALUES)
    if isinstance(content, list):
        return [_changed(chance, item) for item in content] * chance.choice((1, 1, 1, 0, 3))
    if isinstance(content, dict):
        kept = {key: _changed(chance, value) for key, value in content.items() if chance.random() < 0.95}
        return {**kept, **{chance.choice(PIECES): 1 for _ in range(chance.randrange(2))}}
    return content


def mangled_zip(chance: random.Random) -> bytes:
    """Return a platform's download with unusual names, corrupt members, or a corrupt archive."""
    files = {}
    for _ in range(chance.randint(0, 5)):
        name = chance.choice(PATHS)
        if chance.random() < 0.5:
            at = chance.randint(0, len(name))
            name = name[:at] + chance.choice(PIECES) + name[at:]
        receipt = mangled_json(chance, {"exercise": "week01_exercise"})
        inner = {"week01_exercise.ipynb": notebook(), "receipt.json": receipt}
        data = zipped(inner) if chance.random() < 0.3 else notebook()
        name = name.encode("utf-8", "replace").decode()[:60_000]
        files[name] = spoilt(chance, data) if chance.random() < 0.3 else data
    made = zipped(files)
    return spoilt(chance, made) if chance.random() < 0.4 else made


def _course_file(chance: random.Random, top: Path) -> None:
    text = (exercises_dir() / "course.toml").read_text()
    start = chance.choice((0, text.index("[limits]"), text.index("[weeks.week07]")))
    read_course_file(written(top / "course.toml", mangled(chance, text[start : start + 700])))


def _roster(chance: random.Random, top: Path) -> None:
    read_class_list(written(top / "roster.csv", mangled(chance, TABLES["roster"])))


def _received(chance: random.Random, top: Path) -> None:
    written(top / "received.csv", mangled(chance, TABLES["received"]))
    written(top / "ada1" / NAME, notebook())
    written(top / "ada1" / "timestamp.txt", mangled(chance, "2026-03-08 23:59:00 UTC"))
    Ledger.read(top, ZONE).receipt_time(top / "ada1" / NAME, {})
    find_submissions(top, zone=ZONE)


def _worksheet(chance: random.Random, top: Path) -> None:
    path = written(top / "w.csv", mangled(chance, TABLES["worksheet"]))
    read = chance.choice((read_ids, read_times, read_class))
    if read is read_times:
        read_times(path, ZONE, NUMBERS)
    elif read is read_ids:
        read_ids(path, "", NUMBERS)
    else:
        read_class(path, "")


def _api(chance: random.Random, top: Path) -> None:
    read_times(written(top / "api.json", mangled_json(chance, API)), ZONE, NUMBERS)


def _download(chance: random.Random, top: Path) -> None:
    source = written(top / "in.zip", mangled_zip(chance))
    collect(source, top / "out", ZONE)
    for one in find_submissions(top / "out", zone=ZONE):
        working_files(one.path, ["open('notes.txt')"])


def _records(chance: random.Random, top: Path) -> None:
    kind = chance.choice(list(RECORDS))
    path = written(top / "ada1" / "week01_exercise.json", mangled_json(chance, RECORDS[kind]))
    {"marks": read_marks, "result": read_result}[kind](path)


def written(path: Path, data: bytes) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data)
    return path


def in_a_folder(read: Callable[[random.Random, Path], None]) -> Callable[[random.Random], None]:
    """Return a parser that writes its files into a separate folder."""

    def parse(chance: random.Random) -> None:
        with tempfile.TemporaryDirectory() as folder:
            read(chance, Path(folder))

    return parse


FILES = (
    _course_file, _roster, _received, _worksheet, _api, _download, _records,
)  # fmt: skip
STAFF = tuple(map(in_a_folder, FILES))
