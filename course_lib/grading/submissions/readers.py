"""Exports of platforms: tables with times of submission, and downloads.

A download's reader determines the owner of a file from the platform's part of its path.
"""

import re
import unicodedata
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, tzinfo
from functools import lru_cache
from itertools import takewhile
from typing import TYPE_CHECKING, Any, Literal
from zoneinfo import ZoneInfo

import yaml

from course_lib.course.exercise import EXTRA_CHARACTERS, MAX_LENGTH, is_allowed_in_id, normalise
from course_lib.errors import CourseError

if TYPE_CHECKING:
    from dateparser.date import DateDataParser


MAX_DATE = 80  # limit on the characters of a date with a time
YEARS = range(2000, 2100)  # other years overflow in zone conversions
TIME = re.compile(r"\d{1,2}\s*[:.hH]\s*\d{2}")
NUMERIC = re.compile(r"(\d{1,2})\s*([/.-])\s*(\d{1,2})\s*\2\s*(\d{4}|\d{2})\b(?!\.)")
FILLERS = re.compile(r"(?<=\d)\.? (?:gada|m\.|d\.)(?=[ ,]|$)")  # "year" and "day" in Latvian and Lithuanian
LOCALES = (None, ["ar-JO"], ["ar-MA"], ["ar-DZ"])  # None: any; Arabic has four sets of month names
SETTINGS: Any = {
    "PARSERS": ["absolute-time"],  # excludes relative times like "yesterday"
    "STRICT_PARSING": True,
    "REQUIRE_PARTS": ["day", "month", "year"],
}


def parse_times(cells: Sequence[str], zone: ZoneInfo) -> list[datetime | None]:
    """Parse a column of dates with times, as written by Moodle, Canvas or a spreadsheet.

    The order of day and month in purely numeric dates is inferred from the whole column; if it is
    ambiguous, such dates become None.

    Args:
        cells: The texts of the column.
        zone: The zone of times without one.

    Returns:
        The time of each cell in UTC, or None if it is not a date with a time.
    """
    texts = [plain_digits(cell) for cell in cells]
    # The order of day and month is ambiguous if no number exceeds 12 and no dot separates them.
    matches = [match for match in map(NUMERIC.search, texts) if match]
    order = "MDY" if any(int(match[3]) > 12 for match in matches) else ""
    if any(int(match[1]) > 12 or match[2] == "." for match in matches):
        order = "DMY"
    return [_parse_time(text, order, zone) for text in texts]


def looks_like_time(cell: str) -> bool:
    """Return whether a string contains a time of day and enough digits for a date."""
    text = plain_digits(cell)
    digits = sum(char.isdigit() for char in text)
    return len(text) <= MAX_DATE and digits >= len("8261159") and bool(TIME.search(text))


def _parse_time(text: str, order: str, zone: ZoneInfo) -> datetime | None:
    time: datetime | None = None
    if re.match(r"\d{4}-\d\d-\d\d[T ]\d", text):
        with suppress(ValueError):
            time = datetime.fromisoformat(text)
    if time is None and looks_like_time(text) and (order or not NUMERIC.search(text)):
        parsed = (parser.get_date_data(FILLERS.sub("", text)).date_obj for parser in _parsers(order))
        time = next(filter(None, parsed), None)
    if time is None or time.year not in YEARS:
        return None
    return (time if time.tzinfo else time.replace(tzinfo=zone)).astimezone(UTC)


@lru_cache(maxsize=3)
def _parsers(order: str) -> "list[DateDataParser]":
    from dateparser.date import DateDataParser

    settings = SETTINGS | ({"DATE_ORDER": order} if order else {})
    return [DateDataParser(locales=group, settings=settings, try_previous_locales=True) for group in LOCALES]


def plain_digits(text: str) -> str:
    """Convert the digits of any script to 0-9, and remove directional marks."""
    text = unicodedata.normalize("NFKC", text).strip()
    characters = (char for char in text if unicodedata.category(char) != "Cf")
    return "".join(str(unicodedata.digit(char, char)) for char in characters)


Components = tuple[str, ...]  # the components of a path, with archives as folders
# platforms for whose bulk upload `course feedback` writes
Platform = Literal["moodle", "anonymous", "canvas"]

STAMP = "timestamp.txt"  # file name in nbgrader's and Sakai's folders
METADATA = "submission_metadata.yml"  # file name in Gradescope's export
FOLDERS, GOOGLE, NBGRADER, GRADESCOPE, SAKAI = "folders", "google", "nbgrader", "gradescope", "sakai"
PERSON = re.compile(r"[\w .,'\u2019()-]+")
WORDS = re.compile(r"[^\W\d][.,]?\s+[^\W\d]")  # matches a name of several words, which is not an ID
WEEK = re.compile(r"week[ _-]?0*(\d{1,2})(?!\d)", re.IGNORECASE)
GOOGLE_ZIP = re.compile(r"(?:.*-)?\d{8}T\d{6}Z(?:-\d+)*(?:\.zip)?", re.IGNORECASE)

ATTEMPT = "_attempt_"
_ATTEMPT = r"(?P<time>\d{4}-\d\d-\d\d-\d\d-\d\d-\d\d)"
# Like "Oct 10, 2025 234 PM": file systems do not allow colons.
_D2L_TIME = (
    r"(?P<time>[^\W\d]{3,12}\.? \d{1,2}, \d{4} \d{1,2}:?\d\d ?[AaPp][Mm]"
    r"|[^\W\d]{3,12}\.? \d{1,2}, \d{4} \d{1,2} h \d\d"
    r"|\d{1,2}\.? (?:de )?[^\W\d]{3,12}\.?,? (?:de )?\d{4},? (?:\d{1,2}[:.h]?\d\d|\d{1,2} h \d\d))"
)
_SUBMITTED = "|".join((
    "Submitted ?files", "Übermittelte Dateien", "Eingereichte Dateien", "Fichiers envoyés", "Fichiers remis",
    "Archivos enviados",
))  # fmt: skip


@dataclass(frozen=True)
class DownloadName:
    """A file of a download, as named by its platform.

    Args:
        layout: The name of the reader.
        key: The platform's key of the student: a number, a user name, or a name.
        name: The student's name for display.
        student: The student's ID without a roster; "" if only the file itself has an ID.
        below: The path in the student's folder, including archives.
        keys: All strings by which a roster may identify the student.
        assignment: The exercise in the platform's title of the assignment, or "".
        time: The time of submission, if the platform writes it.
        late: Canvas's flag; None for other platforms.
        attachment: Canvas's number of the file.
        download_path: The path in the download, for platforms to which feedback is returned.
        is_named: True if the student's ID is known from the platform or the instructor, instead of
            being derived from the platform's key.
    """

    layout: str
    key: str
    name: str
    student: str
    below: Components
    keys: tuple[str, ...] = ()
    assignment: str = ""
    time: datetime | None = None
    late: bool | None = None
    attachment: str = ""
    download_path: str = ""
    is_named: bool = False

    @property
    def path_in_folder(self) -> Components:
        """The path in the student's folder without archives, because notebooks refer to files by folder."""
        return (*(part for part in self.below[:-1] if not is_zip(part)), *self.below[-1:])


@dataclass(frozen=True)
class Reader:
    """The naming scheme of one platform.

    Args:
        layout: Its name, for --layout.
        title: The platform's name for display.
        example: The path of a file, for the error about a download with other names.
        patterns: Patterns of whole paths. The groups are `number`, `login`, `name`, `late`, `time`,
            `title` (of the assignment), `attachment`, `folder` (of an attempt, created by the
            platform) and `below`, the part that the student chose.
        extras: Pattern of files that the platform adds.
        student: The default ID, a format string with the names of groups.
        is_utc: True if times are in UTC instead of the site's local time.
        no_times: Where to find times of submission if the download has none.
    """

    layout: str
    title: str
    example: str
    patterns: tuple[str, ...]
    extras: str = ""
    student: str = "{number}"
    is_utc: bool = False
    no_times: str = ""

    def match(self, path: Components) -> re.Match[str] | None:
        """Return the match of a path, or None."""
        text = "/".join(path)
        return next(filter(None, (re.fullmatch(p, text, re.DOTALL) for p in self.patterns)), None)

    def is_extra(self, path: Components) -> bool:
        """Return whether a file was written by the platform itself."""
        return bool(self.extras) and re.fullmatch(self.extras, "/".join(path), re.DOTALL) is not None

    def read(self, path: Components, zone: ZoneInfo) -> DownloadName | None:
        """Return the owner and data of a path, or None if the platform creates no such paths."""
        match = self.match(path)
        if match is None:
            return None
        groups = {
            "number": "",
            "login": "",
            "name": "",
            "folder": "",
            "title": "",
            "time": "",
            "attachment": "",
        }
        groups |= {key: value for key, value in match.groupdict().items() if value}
        name = " ".join((groups["name"] or groups["number"]).split())
        folder = re.sub(r"[^\w .-]", "", groups["folder"])
        below = tuple(filter(None, (folder, *groups["below"].split("/"))))
        is_returned = self.layout in ("moodle", "canvas", "anonymous")
        # In "Poe_Cleo_c_poe_7003", the login is "poe" or "c_poe".
        logins = _endings(f"{groups['name']}_{groups['login']}") if groups["login"] else ()
        is_nbgrader = self.layout == NBGRADER
        student = normalise(groups["number"]) if is_nbgrader else id_of(self.student.format(**groups))
        return DownloadName(
            self.layout,
            groups["number"] or name,
            name,
            student,
            below,
            _keys(*logins, groups["number"], name),
            find_exercise_title(groups["title"]) if self.layout in (NBGRADER, "teams") else "",
            _platform_time(groups["time"], UTC if self.is_utc else zone),
            bool(groups.get("late")) if "late" in match.groupdict() else None,
            groups["attachment"],
            "/".join(path) if is_returned else "",
            is_nbgrader,
        )


READERS: tuple[Reader, ...] = (
    Reader(
        "moodle",
        "Moodle",
        "Ada Lovelace_4100001_assignsubmission_file_/week01_exercise.ipynb",
        # With "download in folders" the first part is a folder.
        (
            r"(?P<name>[^/]+?)_(?P<number>\d+)_assignsubmission_(?:file|onlinetext|comments)(?:_?/|_)(?P<below>.+)",
        ),
        student="participant{number}",
        no_times="Moodle's zip has no times of submission: add --roster WORKSHEET.csv, the assignment's "
        "grading worksheet",
    ),
    Reader(
        "anonymous",
        "Canvas",
        "anon_aB3xy_90001_week01_exercise.ipynb",
        (
            r"(?P<late>LATE_)?(?P<name>anon_(?P<number>[^\W_]+))_(?P<attachment>\d+)_(?P<below>.+)",
            r"(?P<late>LATE_)?(?P<name>anon_(?P<number>[^\W_]+))_(?P<below>[a-z]+\.html)",
        ),
        student="anon_{number}",
        no_times="Canvas hid the students (anon_…), so marks can't be returned: turn off anonymous "
        "grading and download again, or add --times SUBMISSIONS.json, with user_id and anonymous_id",
    ),
    Reader(
        "canvas",
        "Canvas",
        "lovelaceada_4100001_90001_week01_exercise.ipynb",
        (
            r"(?!LATE_anon_|anon_)(?P<name>(?:(?!_\d+_question_\d)[^/])+?)_(?P<late>LATE_)?(?P<number>\d+)_"
            r"(?P<attachment>\d+)_(?P<below>.+)",
            # A file handed in as the answer to a question of a quiz.
            r"(?!LATE_anon_|anon_)(?P<name>[^/]+?)_(?P<late>LATE_)?(?P<number>\d+)_question_\d+_"
            r"(?P<attachment>\d+)_(?P<below>.+)",
            # Text entries, links and recordings have no attachment number.
            r"(?!LATE_anon_|anon_)(?P<name>[^/]+?)_(?P<late>LATE_)?(?P<number>\d+)_(?P<below>[a-z]+\.html)",
        ),
        no_times="Canvas's zip has no times of submission, only LATE: add --times SUBMISSIONS.json, the "
        "API's list of the assignment's submissions",
    ),
    Reader(
        "blackboard",
        "Blackboard",
        "Week 1_alovelace_attempt_2026-03-08-22-59-00_week01_exercise.ipynb",
        (rf"(?P<title>[^/]+?)_(?P<number>[^/_]+)_attempt_{_ATTEMPT}_(?P<below>.+)",),
        rf"[^/]+?_[^/_]+_attempt_{_ATTEMPT}\.txt",
    ),
    Reader(
        "brightspace",
        "Brightspace",
        "39786-640693 - Ada Lovelace - Mar 8, 2026 1059 PM/week01_exercise.ipynb",
        (rf"(?P<number>\d+)-\d+ - (?P<name>[^/]+?) - {_D2L_TIME}(?:/| - )(?P<below>.+)",),
        r"index\.html",
    ),
    Reader(
        SAKAI,
        "Sakai",
        "Week 1/Lovelace, Ada(alovelace)/Submission attachment(s)/week01_exercise.ipynb",
        (
            r"(?:[^/()]+/)?(?P<name>[^/]*)\((?P<number>[^/()]+)\)/Submission attachment\(s\)/(?P<below>.+)",
            r"(?:[^/()]+/)?(?P<name>[^/]+?)\((?P<number>[^/()]+)\)_Submission attachment\(s\)_(?P<below>.+)",
        ),
        r"(?:[^/()]+/)?(?:grades\.(?:csv|xlsx?)"
        r"|[^/]*\([^/()]+\)/(?:[^/]+\.(?:txt|html)|Feedback [Aa]ttachment\(s\)/.*))",
        no_times="the download has no timestamp.txt in the students' folders",
    ),
    Reader(
        GRADESCOPE,
        "Gradescope",
        f"assignment_9100_export/submission_7001/week01_exercise.ipynb and {METADATA}",
        (r"(?:assignment_\d+_export/)?submission_(?P<number>\d+)/(?P<below>.+)",),
        rf"(?:assignment_\d+_export/)?{re.escape(METADATA)}",
        student="submission_{number}",
        no_times=f"{METADATA} has no times of submission",
    ),
    Reader(
        "teams",
        "Teams",
        "Submitted files/Ada Lovelace/Week 1/Version 1/week01_exercise.ipynb",
        (
            rf"(?:Student Work/)?(?:{_SUBMITTED})/"
            r"(?P<name>[^/]+)/(?P<title>[^/]+)/(?P<folder>[^\W\d]+ \d+)/(?P<below>.+)",
            r"(?P<name>[^/]+)/(?P<title>[^/]+)/(?P<folder>[^\W\d]+ \d+)/(?P<below>.+)",
        ),
        r"(?:Student Work/)?(?:Working ?files|Arbeitsdateien)/.*",
        student="{name}",
        no_times="the folders of Teams and OneDrive have no times of submission",
    ),
    Reader(
        "ilias",
        "ILIAS",
        "Week 1/Abgaben/Lovelace_Ada_alovelace_7001/week01_exercise.ipynb",
        (
            r"(?:[^/]+/)?(?:Submissions|submissions|Abgaben|abgaben)/(?:Team[ _][^/]+/)?"
            r"(?P<name>[^/]+)_(?P<login>[^/_]+)_(?P<number>\d+)/(?P<below>.+)",
            r"(?:[^/]+/)?(?:Team[ _][^/]+/)?"
            r"(?P<name>[^/_]+_[^/]+)_(?P<login>[^/_]+)_(?P<number>\d+)/(?P<below>.+)",
        ),
        r"(?:[^/]+/)?(?:status\.(?:csv|xlsx?)|README\.md)",
        student="{login}",
        no_times="the zip of ILIAS has no times of submission",
    ),
    Reader(
        "codegrade",
        "CodeGrade",
        "Week 1/Ada Lovelace - 2026-03-08T22:59:00.123456/week01_exercise.ipynb",
        (
            r"(?:[^/]+/)?(?P<name>[^/]+?) - (?P<time>\d{4}-\d\d-\d\dT\d\d[:_.-]?\d\d[^/ ]{0,20})/"
            r"(?P<below>.+)",
        ),
        student="{name}",
        is_utc=True,
    ),
    Reader(
        NBGRADER,
        "nbgrader",
        "submitted/ada/week01/week01_exercise.ipynb",
        # The exchange's inbound/ has a folder per attempt: STUDENT+ASSIGNMENT+TIME+SECRET.
        (
            r"(?:inbound/)?(?P<number>[^/+]+)\+(?P<title>[^/+]+)\+"
            r"(?P<folder>\d{4}-\d\d-\d\d \d\d:\d\d:\d\d[^/+]*)(?:\+[^/]*)?/(?P<below>.+)",
            r"submitted/(?P<number>[^/]+)/(?P<folder>(?P<title>[^/]+))/(?P<below>.+)",
            r"(?:submitted|inbound)/(?P<number>[^/]+)/(?P<below>[^/]+)",
        ),
        r"(?:source|release|autograded|feedback)/.*|gradebook\.db|nbgrader_config\.py",
    ),
)
BY_LAYOUT: Mapping[str, Reader] = {reader.layout: reader for reader in READERS}
LAYOUTS = (*(layout for layout in BY_LAYOUT if layout != "anonymous"), FOLDERS, GOOGLE)
# Downloads of these platforms may be mixed with folders that the instructor created.
_MIXABLE = ("moodle", "anonymous", "canvas", "blackboard", "brightspace")


@dataclass(frozen=True)
class Layout:
    """The rules for reading the names of one download.

    Args:
        name: The name of the reader; "folders" and "google" have none.
        zone: The zone of local times in names.
        above: Path components above the download: the name of nbgrader's folder.
        title: The part before the user name in Blackboard's names.
        records: Data from the platform's own files by key: Gradescope's submitters, Sakai's times.
        is_chosen: True if the instructor selected the layout.
    """

    name: str
    zone: ZoneInfo
    above: Components = ()
    title: str = ""
    records: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    is_chosen: bool = False

    @property
    def reader(self) -> Reader | None:
        """The platform's reader, or None if the layout does not belong to a platform."""
        return BY_LAYOUT.get(self.name)

    def is_extra(self, path: Components) -> bool:
        """Return whether a file was written by the platform itself."""
        reader = self.reader
        return reader is not None and reader.is_extra((*self.above, *path))

    def read(self, path: Components) -> DownloadName:
        """Return the owner and data of a path.

        Raises:
            CourseError: The path does not belong to this layout, or has no owner.
        """
        reader = self.reader
        download_name = reader.read((*self.above, *path), self.zone) if reader else None
        if download_name is not None:
            return self._complete(download_name, path[0].split(ATTEMPT)[0])
        if reader is not None and (len(path) == 1 or self.name not in _MIXABLE):
            raise CourseError(f"its name does not follow {reader.title}'s scheme, so its owner is unknown")
        top = path[1:] if self.name == GOOGLE and len(path) > 1 and not is_zip(path[0]) else path
        if len(top) == 1:
            # Only the ID in the file identifies its owner.
            return DownloadName(self.name, top[0], top[0], "", top)
        if is_zip(top[0]) or self.name == GOOGLE:
            # Files of one archive stay together; the IDs in them count without verification.
            return DownloadName(self.name, top[0], top[0], id_of(top[0].rsplit(".", 1)[0]), top[1:])
        # macOS decomposes umlauts.
        name = unicodedata.normalize("NFC", top[0])
        if not PERSON.fullmatch(name) or (_own_id(name) and not WORDS.search(name)):
            # Like "Lovelace_Ada_alovelace" of OpenOlat: a roster may contain only the login.
            keys = _keys(*_endings(name))
            return DownloadName(self.name, name, name, normalise(name), top[1:], keys, is_named=True)
        # A person's name, like "Bob O'Neil": characters that are invalid in IDs are removed.
        return DownloadName(self.name, name, name, id_of(name), top[1:], _keys(name))

    def _complete(self, download_name: DownloadName, head: str) -> DownloadName:
        """Complete the owner's data from the other names and the platform's own files.

        Args:
            download_name: The file's data from its own name.
            head: The part before the time in Blackboard's names.
        """
        if self.title and head.startswith(self.title) and head != self.title:
            user = head.removeprefix(self.title)
            return replace(download_name, key=user, name=user, student=id_of(user), keys=_keys(user))
        record = self.records.get(download_name.key)
        if record is None:
            if self.name == GRADESCOPE:
                raise CourseError(
                    f"{METADATA} has no submitter for submission_{download_name.key}. Export the "
                    "submissions from Gradescope again, and pass the whole zip"
                )
            return download_name
        return replace(download_name, **record)

    def owner(self, path: Components) -> str:
        """Return a name of the owner, whose archives share a limit."""
        try:
            download_name = self.read(path)
        except CourseError:
            return path[0]
        if download_name.is_named or not download_name.student:
            return download_name.key
        return (
            f"{download_name.name} ({download_name.key})"
            if download_name.name != download_name.key
            else download_name.key
        )


def choose_layout(
    paths: Sequence[Components],
    source: str,
    zone: ZoneInfo,
    name: str = "",
) -> Layout:
    """Choose the layout of a download by all its names.

    Args:
        paths: Paths of the files in the download; archives in it are files.
        source: The file name of the download.
        zone: The zone of local times in names.
        name: The layout selected by the instructor, or "".

    Raises:
        CourseError: The layout is unknown or ambiguous, or is not the selected one.
    """
    above = (source,) if source in ("submitted", "inbound") else ()
    if name in (FOLDERS, GOOGLE):
        return Layout(name, zone, is_chosen=True)
    if name and name not in BY_LAYOUT:
        raise CourseError(f"--layout {name} is unknown: expected one of {', '.join(LAYOUTS)}")
    candidates = [
        (depth, reader.layout)
        for reader in READERS
        if (depth := _depth(reader, [(*above, *path) for path in paths])) is not None
    ]
    if name:
        fits = [fit for _, fit in candidates if fit == name or (fit, name) == ("anonymous", "canvas")]
        if not fits:
            raise CourseError(
                f"the names of this download do not follow {BY_LAYOUT[name].title}'s scheme. The "
                f"first is {'/'.join(paths[0])}; expected {BY_LAYOUT[name].example}"
            )
        return Layout(fits[0], zone, above, is_chosen=True)
    nearest = min((depth for depth, _ in candidates), default=0)
    layouts = [layout for depth, layout in candidates if depth == nearest]
    if len(layouts) > 1:
        raise CourseError(
            f"the names of this download follow the schemes of {' and '.join(layouts)}, so nothing "
            f"is collected. Add --layout {layouts[0]} or --layout {layouts[1]}"
        )
    if layouts:
        return Layout(layouts[0], zone, above)
    is_one_folder = len({path[0] for path in paths}) == 1 and all(len(path) == 2 for path in paths)
    if GOOGLE_ZIP.fullmatch(source) and (is_one_folder or all(len(path) == 1 for path in paths)):
        return Layout(GOOGLE, zone)
    return Layout(FOLDERS, zone)


def _depth(reader: Reader, paths: Sequence[Components]) -> int | None:
    """Return the depth of the component with the owner, or None if the download is not of this platform.

    All files must be the platform's. If the platform's names begin at the top, folders of another
    kind are allowed as long as they are not the majority.
    """
    units = defaultdict[str, list[int]](list)  # by the first component: the depth of each file, or -1
    for path in paths:
        if reader.is_extra(path):
            continue
        match = reader.match(path)
        if match is None and (len(path) == 1 or reader.layout not in _MIXABLE):
            return None
        name_start = match and min(
            match.start(key) for key in ("name", "number") if match.groupdict().get(key)
        )
        units[path[0]].append(-1 if match is None else match.string[:name_start].count("/"))
    depths = [max(unit_depths) for unit_depths in units.values()]
    matched = sum(depth >= 0 for depth in depths)
    return max(depths) if depths and 2 * matched >= len(depths) else None


def add_blackboard_title(layout: Layout, paths: Collection[Components]) -> Layout:
    """Return Blackboard's layout with the common prefix of all names, because user names may contain "_"."""
    heads = sorted({path[0].split(ATTEMPT)[0] for path in paths if ATTEMPT in path[0]})
    # The common prefix of sorted strings is the common prefix of the first and the last one.
    pairs = zip(heads[0], heads[-1], strict=False) if heads else ()
    common = "".join(first for first, _ in takewhile(lambda pair: pair[0] == pair[1], pairs))
    return replace(layout, title=common[: common.rfind("_") + 1] if len(heads) > 1 else "")


def gradescope_records(data: bytes, zone: ZoneInfo) -> dict[str, dict[str, Any]]:
    """Return the owner's data in Gradescope's submission_metadata.yml by submission number.

    Raises:
        CourseError: It is not a file that Gradescope wrote.
    """
    try:
        content = yaml.load(data, Loader=_MetadataLoader)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise CourseError(
            f"{METADATA} can't be read: {str(error).splitlines()[0]}. Export it again"
        ) from error
    if not isinstance(content, dict):
        raise CourseError(f"{METADATA} has no submissions. Export it again from Gradescope")
    records: dict[str, dict[str, Any]] = {}
    for folder, entry in content.items():
        number = str(folder).removeprefix("submission_")
        people = entry.get(":submitters") if isinstance(entry, dict) else None
        first = people[0] if isinstance(people, list) and people and isinstance(people[0], dict) else {}
        sid, email, name = (str(first.get(key) or "").strip() for key in (":sid", ":email", ":name"))
        if not (sid or email or name):
            continue
        # Gradescope writes fractions of a second and separates the zone by a space.
        text = re.sub(r"\.\d+", "", str(entry.get(":created_at") or "")).replace(" Z", "+00:00").strip()
        text = re.sub(r" ([+-]\d\d:?\d\d)$", r"\1", text)
        records[number] = {
            "name": name or sid or email,
            "student": _own_id(sid) or id_of(email or name),
            "keys": _keys(sid, email, name),
            "time": parse_times([text], zone)[0],
            "is_named": bool(_own_id(sid)),
        }
    return records


class _MetadataLoader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """Loads Gradescope's file as strings, ignoring its Ruby types."""


_MetadataLoader.yaml_implicit_resolvers = {}
_MetadataLoader.add_multi_constructor(
    "!",
    lambda loader, tag, node: loader.construct_mapping(node) if isinstance(node, yaml.MappingNode) else None,
)


def sakai_time(data: bytes) -> datetime | None:
    """Return the time in Sakai's timestamp.txt, which is in UTC."""
    text = data[:100].decode("utf-8", "replace").strip()
    if match := re.fullmatch(r"(\d{4})(\d\d)(\d\d)(\d\d)(\d\d)(\d\d)\d*", text):
        text = "{}-{}-{}T{}:{}:{}".format(*match.groups())
    return parse_times([text], ZoneInfo("UTC"))[0]


def sakai_key(path: Components) -> str:
    """Return the student's key if a path is Sakai's timestamp.txt, else ""."""
    match = re.fullmatch(rf"(?:[^/()]+/)?[^/]*\(([^/()]+)\)/{re.escape(STAMP)}", "/".join(path))
    return match[1] if match else ""


def _platform_time(text: str, zone: tzinfo) -> datetime | None:
    """Parse the time in a platform's file name, where characters such as colons may be missing."""
    if not text:
        return None
    if match := re.match(r"(\d{4}-\d\d-\d\d)[T-](\d\d)\D?(\d\d)\D?(\d\d)?", text):
        text = f"{match[1]}T{match[2]}:{match[3]}:{match[4] or '00'}"
    else:
        text = re.sub(r"(\d{4}),? (\d{1,2}?)(?:[:.h]| h )?(\d\d)(?= ?[AaPp][Mm]|$)", r"\1 \2:\3", text)
    (time,) = parse_times([text], ZoneInfo("UTC"))
    return time.replace(tzinfo=zone).astimezone(UTC) if time else None


def fold_key(text: str) -> str:
    """Return a name or login for comparison, ignoring case, spaces and Unicode normalization."""
    plain = unicodedata.normalize("NFKC", text).replace("\u2019", "'")
    return " ".join(unicodedata.normalize("NFKC", plain.casefold()).split())


def _keys(*texts: str) -> tuple[str, ...]:
    """Return possible roster keys of a student, including "Ada Lovelace" for "Lovelace, Ada"."""
    flipped = (re.sub(r"([^,]+), ([^,]+)", r"\2 \1", text) for text in texts)
    return tuple(dict.fromkeys(fold_key(text) for text in (*texts, *flipped) if text))


def _endings(text: str) -> tuple[str, ...]:
    """Return a string and all its suffixes after a "_", longest first, because a login may contain "_"."""
    parts = text.split("_")
    return tuple("_".join(parts[first:]) for first in range(len(parts)))


def _own_id(text: str) -> str:
    try:
        return normalise(text)
    except CourseError:
        return ""


def id_of(text: str) -> str:
    """Derive an ID from a student's name on a platform, which may contain any characters."""
    plain = unicodedata.normalize("NFKC", text)
    characters = "".join(filter(is_allowed_in_id, plain)).lstrip(EXTRA_CHARACTERS)
    try:
        return normalise(characters[:MAX_LENGTH])
    except CourseError as error:
        raise CourseError(f"{text!r} has no letter or digit, so no ID can be derived") from error


def find_exercise_title(title: str) -> str:
    """Return the exercise in an assignment's title, "week01_exercise", or ""."""
    match = WEEK.search(title)
    return f"week{int(match[1]):02}_exercise" if match else ""


def is_zip(part: str) -> bool:
    """Return whether a path component is an archive."""
    return part.lower().endswith(".zip")


@dataclass(frozen=True)
class PlatformName:
    """The parts of the name that Moodle or Canvas gives to a file.

    Args:
        platform: The platform; "anonymous" is Canvas with hidden students.
        name: The student's name.
        number: The platform's number of the student, or the anonymous ID.
        attachment: Canvas's number of the file.
        late: Canvas's flag; None for other platforms.
        file: The file's name as chosen by the student; "" if a folder has the platform's name.
    """

    platform: Platform
    name: str
    number: str
    attachment: str
    late: bool | None
    file: str


def platform_name(part: str) -> PlatformName | None:
    """Parse a path component as a name given by Moodle or Canvas, for returning feedback, or return None."""
    platforms: tuple[Platform, ...] = ("moodle", "anonymous", "canvas")
    for platform in platforms:
        # The name of a Moodle folder ends where the student's part of a file name begins.
        for text in (part, f"{part}/", f"{part}_"):
            match = BY_LAYOUT[platform].match((f"{text}\0" if text != part else text,))
            if match and (text == part or platform == "moodle"):
                groups = match.groupdict()
                is_late = None if platform == "moodle" else bool(groups["late"])
                file = groups["below"].removesuffix("\0")
                return PlatformName(
                    platform, groups["name"], groups["number"], groups.get("attachment") or "", is_late, file
                )
    return None
