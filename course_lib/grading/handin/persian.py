"""Dates of the Persian calendar: the package that reads all others loses the half of the day in them."""

import re
from datetime import date, datetime, timedelta

MONTHS = (
    "فروردین", "اردیبهشت", "خرداد", "تیر", "مرداد", "شهریور", "مهر", "آبان", "آذر", "دی", "بهمن", "اسفند",
)  # fmt: skip
WEEKDAYS = (
    "یکشنبه", "دوشنبه", "سهشنبه", "چهارشنبه", "پنجشنبه", "شنبه", "جمعه",
    "یک شنبه", "دو شنبه", "سه شنبه", "چهار شنبه", "پنج شنبه",
)  # fmt: skip
HALVES = {  # the hours that they add
    **dict.fromkeys(("قبل از ظهر", "قبلازظهر", "ق.ظ.", "ق.ظ", "صبح", "am"), 0),
    **dict.fromkeys(("بعد از ظهر", "بعدازظهر", "ب.ظ.", "ب.ظ", "عصر", "pm"), 12),
}
LETTERS = str.maketrans("يك", "یک")  # Arabic ones, which some keyboards write
NEW_YEAR, FIRST = 1404, date(2025, 3, 21)
YEARS = range(1380, 1480)
LEAP = (1, 5, 9, 13, 17, 22, 26, 30)  # of 33 years
NAMED = re.compile(rf"(?P<day>\d{{1,2}}) (?P<name>{'|'.join(MONTHS)}) (?P<year>1[34]\d\d)\b")
NUMBERS = re.compile(r"\b(?P<year>1[34]\d\d)(?P<sign>[/-])(?P<month>\d{1,2})(?P=sign)(?P<day>\d{1,2})\b")
CLOCK = re.compile(r"\b(\d{1,2}):(\d\d)(?::(\d\d))?\b")


def persian_time(text: str) -> datetime | None:
    """Return the local time of a Persian date with a time, or None.

    Args:
        text: With digits 0-9 and no invisible characters.
    """
    text = text.translate(LETTERS).casefold()
    day = NAMED.search(text) or NUMBERS.search(text)
    clock = CLOCK.search(text)
    if day is None or clock is None:
        return None
    rest = text.replace(day[0], " ").replace(clock[0], " ").replace("ساعت", " ")
    words = " ".join(re.sub(r"[،,]", " ", rest).split())
    for weekday in sorted(WEEKDAYS, key=len, reverse=True):
        words = words.removeprefix(weekday).strip()
    hour, minute, second = (int(number or 0) for number in clock.groups())
    if words in HALVES and 1 <= hour <= 12:
        hour = hour % 12 + HALVES[words]
    elif words:
        return None  # another word, which may change the time
    found = day.groupdict()
    month = MONTHS.index(found["name"]) + 1 if "name" in found else int(found["month"])
    when = gregorian(int(found["year"]), month, int(found["day"]))
    if when is None or hour > 23 or minute > 59 or second > 59:
        return None
    return datetime(when.year, when.month, when.day, hour, minute, second)


def gregorian(year: int, month: int, day: int) -> date | None:
    """Return a day of the Persian calendar as others count it; None where there is no such day."""
    lengths = [*[31] * 6, *[30] * 5, 29 + (year % 33 in LEAP)]
    if year not in YEARS or not 1 <= month <= 12 or not 1 <= day <= lengths[month - 1]:
        return None
    early, late = sorted((year, NEW_YEAR))
    days = sum(365 + (one % 33 in LEAP) for one in range(early, late))
    first = FIRST + timedelta(days if year >= NEW_YEAR else -days)
    return first + timedelta(sum(lengths[: month - 1]) + day - 1)
