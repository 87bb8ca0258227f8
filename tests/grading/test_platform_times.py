from datetime import date, datetime
from zoneinfo import ZoneInfo

import pytest

from course_lib.grading.handin.persian import gregorian, persian_time
from course_lib.grading.handin.platform_files import parse_times

PARIS = ZoneInfo("Europe/Paris")
TIME = datetime(2026, 3, 8, 23, 59, tzinfo=PARIS)
SAME_TIME = [
    "Sunday, 8 March 2026, 11:59 PM", "8.3.2026 23:59", "domenica, 8 marzo 2026, 23:59",
    "niedziela, 8 marca 2026, 23:59", "domingo, 8 de março de 2026 às 23:59", "8 Mart 2026, Pazar, 23:59",
    "воскресенье, 8 марта 2026, 23:59", "2026年03月8日 星期日 23:59", "zondag, 8 maart 2026, 23:59",
    "søndag 8. mars 2026 23.59", "sunnuntai, 8. maaliskuuta 2026, 23.59", "2026-03-08T22:59:00Z",
    "Κυριακή, 8 Μαρτίου 2026, 11:59 μμ", "יום ראשון, 8 מרץ 2026, 23:59", "2026-03-08 23:59:00+01:00",
    "svētdiena, 2026. gada 8. marts, 23:59", "svētdiena, 8. marts 2026, 23:59",
    "sekmadienis, 2026 m. kovo 8 d. 23:59", "یکشنبه، 17 اسفند 1404، 11:59 عصر",
    "یکشنبه، ۱۷ اسفند ۱۴۰۴، ۲۳:۵۹",  # noqa: RUF001
    "یک\u200cشنبه 17 اسفند 1404 ساعت 23:59", "1404/12/17 23:59:00", "1404-12-17 23:59",  # noqa: RUF001
    "يكشنبه، 17 اسفند 1404، 11:59 بعد از ظهر", "17 اسفند 1404، 11:59 PM",
]  # fmt: skip


def test_dates_are_read_in_many_languages() -> None:
    assert [parse_times([text], PARIS) for text in SAME_TIME] == [[TIME]] * len(SAME_TIME)


NO_TIMES = ["", "-", "yesterday", "20231234", "100,00", "March", "8 March 2026", "Sunday, 8 March 26:99",
            "9999-12-31T23:59:59Z", "0001-01-01T00:00:00+14:00", "a" * 10_000, "1" * 10_000,
            "30 اسفند 1404 23:59", "17 اسفند 1404", "17 اسفند 1404، 11:59 شاید", "0 تیر 1404 23:59",
            "17 اسفند 1404، 13:59 عصر", "17 اسفند 1404 24:00",
            "1404/13/01 23:59", "1404/12-17 23:59"]  # fmt: skip


def test_what_is_not_a_date_with_a_time_is_none() -> None:
    assert parse_times(NO_TIMES, PARIS) == [None] * len(NO_TIMES)


@pytest.mark.parametrize(
    ("clock", "hour"),
    [("12:05 صبح", 0), ("12:05 عصر", 12), ("1:05 ب.ظ", 13), ("11:05 ق.ظ", 11), ("00:05", 0), ("12:05", 12)],
)
def test_halves_of_a_persian_day_are_told_apart(clock: str, hour: int) -> None:
    assert persian_time(f"شنبه، 16 اسفند 1404، {clock}") == datetime(2026, 3, 7, hour, 5)


@pytest.mark.parametrize(
    ("day", "same"),
    [
        ((1399, 12, 30), date(2021, 3, 20)),
        ((1400, 1, 1), date(2021, 3, 21)),
        ((1403, 12, 30), date(2025, 3, 20)),
        ((1404, 12, 30), None),
        ((1404, 6, 31), date(2025, 9, 22)),
        ((1404, 7, 31), None),
        ((1408, 12, 30), date(2030, 3, 20)),
        ((1479, 12, 29), date(2101, 3, 20)),
    ],
)
def test_days_of_the_persian_calendar_are_those_of_others(
    day: tuple[int, int, int], same: date | None
) -> None:
    assert gregorian(*day) == same


@pytest.mark.parametrize(
    ("column", "first"),
    [
        (["03/08/2026 23:59", "04/08/2026 10:00"], None),  # nothing tells the order
        (["03/08/2026 23:59", "03/28/2026 10:00"], "2026-03-08T23:59:00+01:00"),
        (["03/08/2026 23:59", "28/08/2026 10:00"], "2026-08-03T23:59:00+02:00"),
    ],
)
def test_the_column_tells_the_order_of_day_and_month(column: list[str], first: str | None) -> None:
    assert parse_times(column, PARIS)[0] == (first and datetime.fromisoformat(first))
