"""Tables that a platform exports: their cells, and the times of submission in them."""

import codecs
import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self
from zoneinfo import ZoneInfo

from course_lib.errors import CourseError, format_count

if TYPE_CHECKING:
    from dateparser.date import DateDataParser

BOMS = {codecs.BOM_UTF8: "utf-8", codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}
DELIMITERS = (",", ";", "\t", "|")
MAX_DATE = 80  # characters of a date with a time
YEARS = range(2000, 2100)  # other years overflow in zone conversions
TIME = re.compile(r"\d{1,2}\s*[:.hH]\s*\d{2}")
NUMERIC = re.compile(r"(\d{1,2})\s*([/.-])\s*(\d{1,2})\s*\2\s*(\d{4}|\d{2})\b(?!\.)")
FILLERS = re.compile(r"(?<=\d)\.? (?:gada|m\.|d\.)(?=[ ,]|$)")  # "year" and "day" in Latvian and Lithuanian
LOCALES = (None, ["ar-JO"], ["ar-MA"], ["ar-DZ"])  # any language; Arabic has four sets of month names
SETTINGS: Any = {
    "PARSERS": ["absolute-time"],  # excludes relative times like "yesterday"
    "STRICT_PARSING": True,
    "REQUIRE_PARTS": ["day", "month", "year"],
}


@dataclass
class LmsFile:
    """The raw cells of a table, with quotes. `ends` contains the line ends of all rows."""

    bom: bytes
    encoding: str
    delimiter: str
    rows: list[list[str]]
    ends: list[str]

    @classmethod
    def read(cls, path: Path, least: int = 2) -> Self:
        """Read a file of any common encoding, delimiter and line ending.

        Args:
            path: The file.
            least: The required number of columns, 1 or 2.

        Raises:
            CourseError: It can't be read, or contains no table.
        """
        try:
            data = path.read_bytes()
        except OSError as error:
            raise CourseError(
                f"{path} can't be read: {error.strerror}. Pass the platform's CSV file."
            ) from error
        bom = next((bom for bom in BOMS if data.startswith(bom)), b"")
        encoding = BOMS.get(bom) or ("utf-8" if _is_utf8(data) else "latin-1")  # latin-1 decodes any byte
        try:
            text = data.removeprefix(bom).decode(encoding, "surrogatepass" if bom else "strict")
        except UnicodeError as error:
            raise CourseError(
                f"{path} is not valid {encoding}, although its byte order mark says so: {error}. "
                "Export it again."
            ) from error
        first = re.split("[\r\n]", text, maxsplit=1)[0]
        delimiter = max(DELIMITERS, key=first.count)
        columns = first.count(delimiter) + 1 if first.strip() else 0
        if columns < least or "\0" in text:
            raise CourseError(
                f"{path} is not a CSV: its first line has no columns. Export it from the platform."
            )
        return cls(bom, encoding, delimiter, *_split(text, delimiter))

    def to_bytes(self) -> bytes:
        """Return the bytes of the whole file."""
        lines = (self.delimiter.join(row) + end for row, end in zip(self.rows, self.ends, strict=True))
        return self.bom + "".join(lines).encode(self.encoding, "surrogatepass" if self.bom else "strict")

    def text(self, row: int, column: int) -> str:
        """Return a cell without its quotes, or "" if the row is too short."""
        cells = self.rows[row]
        cell = cells[column].strip() if column < len(cells) else ""
        quoted = len(cell) > 1 and cell[0] == cell[-1] == '"'
        return (cell[1:-1].replace('""', '"') if quoted else cell).strip()

    @property
    def headings(self) -> list[str]:
        """The cells of the first row."""
        return [self.text(0, place) for place in range(len(self.rows[0]))]

    def reject_long_rows(self, path: Path) -> None:
        """Reject rows with cells beyond the headings, which unquoted delimiters cause.

        Raises:
            CourseError: A row has more cells than the first row.
        """
        width = len(self.rows[0])
        for number, row in enumerate(self.rows, 1):
            if any(cell.strip() for cell in row[width:]):
                raise CourseError(
                    f"{path}, row {number}: {len(row)} cells below {format_count(width, 'heading')}. "
                    f"Put double quotes around cells that contain {self.delimiter!r}"
                )

    def put(self, row: int, column: int, number: str) -> None:
        """Change a cell, keeping its quotes."""
        quote = '"' if self.rows[row][column].strip().startswith('"') else ""
        self.rows[row][column] = f"{quote}{number}{quote}"

    def put_text(self, row: int, column: int, text: str) -> None:
        """Change a cell to any text, in quotes."""
        self.rows[row][column] = '"{}"'.format(text.replace('"', '""'))

    def column(self, name: str) -> int:
        """Return the index of a column, by its heading or the part before the number in `Week 1 (12345)`.

        Raises:
            CourseError: No column or several columns match.
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
    """Split a CSV string into rows of raw cells, and return them with each row's line ending."""
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
    found = [match for match in map(NUMERIC.search, texts) if match]
    order = "MDY" if any(int(match[3]) > 12 for match in found) else ""
    if any(int(match[1]) > 12 or match[2] == "." for match in found):
        order = "DMY"
    return [_to_utc(_parse_iso(text) or _parse_words(text, order), zone) for text in texts]


def looks_like_time(cell: str) -> bool:
    """Return whether a string contains a time of day and enough digits for a date."""
    text = plain_digits(cell)
    digits = sum(char.isdigit() for char in text)
    return len(text) <= MAX_DATE and digits >= len("8261159") and bool(TIME.search(text))


def _parse_words(text: str, order: str) -> datetime | None:
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


def _parse_iso(text: str) -> datetime | None:
    try:
        return datetime.fromisoformat(text) if re.match(r"\d{4}-\d\d-\d\d[T ]\d", text) else None
    except ValueError:
        return None


def _to_utc(time: datetime | None, zone: ZoneInfo) -> datetime | None:
    if time is None or time.year not in YEARS:
        return None
    return (time if time.tzinfo else time.replace(tzinfo=zone)).astimezone(UTC)


def plain_digits(text: str) -> str:
    """Convert the digits of any script to 0-9, and remove directional marks."""
    text = unicodedata.normalize("NFKC", text).strip()
    kept = (char for char in text if unicodedata.category(char) != "Cf")
    return "".join(str(unicodedata.digit(char, char)) for char in kept)
