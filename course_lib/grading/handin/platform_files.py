"""Tables that a platform exports: their cells, and the times of submission in them."""

import codecs
import re
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self
from zoneinfo import ZoneInfo

from course_lib.errors import CourseError, counted
from course_lib.grading.handin.persian import persian_time

if TYPE_CHECKING:
    from dateparser.date import DateDataParser

BOMS = {codecs.BOM_UTF8: "utf-8", codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}
DELIMITERS = (",", ";", "\t", "|")
MAX_DATE = 80  # characters of a date with its time
YEARS = range(2000, 2100)  # other years overflow when the zone changes
TIME = re.compile(r"\d{1,2}\s*[:.hH]\s*\d{2}")
NUMERIC = re.compile(r"(\d{1,2})\s*([/.-])\s*(\d{1,2})\s*\2\s*(\d{4}|\d{2})\b(?!\.)")
FILLERS = re.compile(r"(?<=\d)\.? (?:gada|m\.|d\.)(?=[ ,]|$)")  # "year" and "day" in Latvian and Lithuanian
LOCALES = (None, ["ar-JO"], ["ar-MA"], ["ar-DZ"])  # any language; Arabic has four sets of names of months
SETTINGS: Any = {
    "PARSERS": ["absolute-time"],  # "yesterday" is not a time of submission
    "STRICT_PARSING": True,
    "REQUIRE_PARTS": ["day", "month", "year"],
}


@dataclass
class LmsFile:
    """Rows of cells as they are written, with quotes; `ends` holds what follows the last cell of each row."""

    bom: bytes
    encoding: str
    delimiter: str
    rows: list[list[str]]
    ends: list[str]

    @classmethod
    def read(cls, path: Path, least: int = 2) -> Self:
        """Read a file of any usual encoding, delimiter and line ending.

        Args:
            path: The file.
            least: The number of columns that it needs, 1 or 2.

        Raises:
            CourseError: It can't be read, or holds no table.
        """
        try:
            data = path.read_bytes()
        except OSError as error:
            raise CourseError(f"{path} can't be read: {error.strerror}. Name the platform's CSV.") from error
        bom = next((bom for bom in BOMS if data.startswith(bom)), b"")
        encoding = BOMS.get(bom) or ("utf-8" if _is_utf8(data) else "latin-1")  # latin-1 has all bytes
        try:
            text = data.removeprefix(bom).decode(encoding, "surrogatepass" if bom else "strict")
        except UnicodeError as error:
            raise CourseError(f"{path} is not {encoding}, as it begins: {error}. Export it again.") from error
        first = re.split("[\r\n]", text, maxsplit=1)[0]
        delimiter = max(DELIMITERS, key=first.count)
        columns = first.count(delimiter) + 1 if first.strip() else 0
        if columns < least or "\0" in text:
            raise CourseError(
                f"{path} is not a CSV: its first line has no columns. Export it from the platform."
            )
        return cls(bom, encoding, delimiter, *_split(text, delimiter))

    def encoded(self) -> bytes:
        """Return the bytes of the whole file."""
        lines = (self.delimiter.join(row) + end for row, end in zip(self.rows, self.ends, strict=True))
        return self.bom + "".join(lines).encode(self.encoding, "surrogatepass" if self.bom else "strict")

    def text(self, row: int, column: int) -> str:
        """Return a cell without its quotes; "" where a row is too short."""
        cells = self.rows[row]
        cell = cells[column].strip() if column < len(cells) else ""
        quoted = len(cell) > 1 and cell[0] == cell[-1] == '"'
        return (cell[1:-1].replace('""', '"') if quoted else cell).strip()

    @property
    def headings(self) -> list[str]:
        """The first row."""
        return [self.text(0, place) for place in range(len(self.rows[0]))]

    def refuse_long_rows(self, path: Path) -> None:
        """Refuse texts without a heading: a delimiter in a name has moved all that follows.

        Raises:
            CourseError: A row has more cells than the first; names it.
        """
        width = len(self.rows[0])
        for number, row in enumerate(self.rows, 1):
            if any(cell.strip() for cell in row[width:]):
                raise CourseError(
                    f"{path}, row {number}: {len(row)} cells below {counted(width, 'heading')}. "
                    f"A text with {self.delimiter!r} in it needs double quotes around it"
                )

    def put(self, row: int, column: int, number: str) -> None:
        """Change a cell; it keeps its quotes, if it has any."""
        quote = '"' if self.rows[row][column].strip().startswith('"') else ""
        self.rows[row][column] = f"{quote}{number}{quote}"

    def column(self, name: str) -> int:
        """Return the place of a column, by its heading or the part before its number, `Week 1 (12345)`.

        Raises:
            CourseError: There is none, or more than one.
        """
        headings = self.headings
        found = [i for i, heading in enumerate(headings) if heading == name]
        found = found or [i for i, h in enumerate(headings) if re.fullmatch(re.escape(name) + r" \(\d+\)", h)]
        if len(found) != 1:
            known = ", ".join(map(repr, headings))
            raise CourseError(f"{len(found) or 'no'} columns are named {name!r}; expected one of {known}")
        return found[0]


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True


def _split(text: str, delimiter: str) -> tuple[list[list[str]], list[str]]:
    """Rows of raw cells, and each row's line ending; after the last line there is an empty row."""
    d = re.escape(delimiter)
    cells = re.findall(rf'( *"(?:[^"]|"")*"[^{d}\r\n]*|[^{d}\r\n]*)({d}|\r\n|\r|\n|\Z)', text)
    rows, ends = [list[str]()], list[str]()
    for cell, end in cells:
        rows[-1].append(cell)
        if end != delimiter:
            ends.append(end)
            rows.append([])
    return rows[:-1], ends


def parse_times(cells: Sequence[str], zone: ZoneInfo) -> list[datetime | None]:
    """Parse a column of dates with times, as Moodle, Canvas or a spreadsheet writes them.

    The order of day and month in dates of numbers alone is taken from the whole column; where it can't
    be told, such a date is None.

    Args:
        cells: The column's texts.
        zone: Of times that do not name theirs.

    Returns:
        The time in UTC of each cell, None where it is not a date with a time.
    """
    texts = [plain_digits(cell) for cell in cells]
    order = _order(texts)
    return [_in_utc(_persian(text) or _iso(text) or _in_words(text, order), zone) for text in texts]


def looks_like_time(cell: str) -> bool:
    """Return whether a text has a time of day and enough digits for a date."""
    text = plain_digits(cell)
    digits = sum(char.isdigit() for char in text)
    return len(text) <= MAX_DATE and digits >= len("8261159") and bool(TIME.search(text))


def _persian(text: str) -> datetime | None:
    return persian_time(text) if len(text) <= MAX_DATE else None


def _in_words(text: str, order: str) -> datetime | None:
    if not looks_like_time(text) or (not order and NUMERIC.search(text)):
        return None
    text = FILLERS.sub("", text)
    parsed = (parser.get_date_data(text).date_obj for parser in _parsers(order))
    return next((time for time in parsed if time), None)


@lru_cache(maxsize=3)
def _parsers(order: str) -> "list[DateDataParser]":
    from dateparser.date import DateDataParser

    settings = SETTINGS | ({"DATE_ORDER": order} if order else {})
    return [DateDataParser(locales=one, settings=settings, try_previous_locales=True) for one in LOCALES]


def _iso(text: str) -> datetime | None:
    try:
        return datetime.fromisoformat(text) if re.match(r"\d{4}-\d\d-\d\d[T ]\d", text) else None
    except ValueError:
        return None


def _in_utc(time: datetime | None, zone: ZoneInfo) -> datetime | None:
    if time is None or time.year not in YEARS:
        return None
    return (time if time.tzinfo else time.replace(tzinfo=zone)).astimezone(UTC)


def _order(texts: Iterable[str]) -> str:
    """Return the order of day and month in numeric dates: "DMY", "MDY", or "" where nothing tells it."""
    found = [match for match in map(NUMERIC.search, texts) if match]
    if any(int(match[1]) > 12 or match[2] == "." for match in found):
        return "DMY"
    return "MDY" if any(int(match[3]) > 12 for match in found) else ""


def plain_digits(text: str) -> str:
    """Return a text with digits of any script as 0-9, without marks of the reading direction."""
    text = unicodedata.normalize("NFKC", text).strip()
    kept = (char for char in text if unicodedata.category(char) != "Cf")
    return "".join(str(unicodedata.digit(char, char)) for char in kept)
