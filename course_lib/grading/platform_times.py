"""Times of submission as a platform's own export has them, in the language of its site."""

import re
import unicodedata
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from functools import lru_cache
from typing import TYPE_CHECKING, Any
from zoneinfo import ZoneInfo

if TYPE_CHECKING:
    from dateparser.date import DateDataParser

MAX_DATE = 80  # characters of a date with its time
YEARS = range(2000, 2100)  # at the ends of time there is no changing of the zone
TIME = re.compile(r"\d{1,2}\s*[:.hH]\s*\d{2}")
NUMERIC = re.compile(r"(\d{1,2})\s*([/.-])\s*(\d{1,2})\s*\2\s*(\d{4}|\d{2})\b(?!\.)")
LOCALES = (None, ["ar-JO"], ["ar-MA"], ["ar-DZ"])  # any language; Arabic has four sets of names of months
SETTINGS: Any = {
    "PARSERS": ["absolute-time"],  # "yesterday" is not a time of submission
    "STRICT_PARSING": True,
    "REQUIRE_PARTS": ["day", "month", "year"],
}


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
    return [_in_utc(_iso(text) or _in_words(text, order), zone) for text in texts]


def _in_words(text: str, order: str) -> datetime | None:
    digits = sum(char.isdigit() for char in text)
    if len(text) > MAX_DATE or digits < len("8261159") or not TIME.search(text):
        return None
    if not order and NUMERIC.search(text):
        return None
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
