from datetime import datetime
from zoneinfo import ZoneInfo

import pytest

from course_lib.grading.submissions.readers import parse_times

PARIS = ZoneInfo("Europe/Paris")
TIME = datetime(2026, 3, 8, 23, 59, tzinfo=PARIS)
SAME_TIME = [
    "Sunday, 8 March 2026, 11:59 PM", "8.3.2026 23:59", "domenica, 8 marzo 2026, 23:59",
    "niedziela, 8 marca 2026, 23:59", "domingo, 8 de março de 2026 às 23:59", "8 Mart 2026, Pazar, 23:59",
    "воскресенье, 8 марта 2026, 23:59", "2026年03月8日 星期日 23:59", "zondag, 8 maart 2026, 23:59",
    "søndag 8. mars 2026 23.59", "sunnuntai, 8. maaliskuuta 2026, 23.59", "2026-03-08T22:59:00Z",
    "Κυριακή, 8 Μαρτίου 2026, 11:59 μμ", "יום ראשון, 8 מרץ 2026, 23:59", "2026-03-08 23:59:00+01:00",
    "svētdiena, 2026. gada 8. marts, 23:59", "svētdiena, 8. marts 2026, 23:59",
    "sekmadienis, 2026 m. kovo 8 d. 23:59",
]  # fmt: skip


@pytest.mark.slow
def test_dates_are_read_in_many_languages() -> None:
    assert [parse_times([text], PARIS) for text in SAME_TIME] == [[TIME]] * len(SAME_TIME)


NO_TIMES = ["", "-", "yesterday", "20231234", "100,00", "March", "8 March 2026", "Sunday, 8 March 26:99",
            "9999-12-31T23:59:59Z", "0001-01-01T00:00:00+14:00", "a" * 10_000, "1" * 10_000,
            "30 اسفند 1404 23:59", "17 اسفند 1404", "17 اسفند 1404، 11:59 شاید", "0 تیر 1404 23:59",
            "1404/13/01 23:59", "1404/12-17 23:59"]  # fmt: skip

# Times of the Persian calendar, as Moodle writes them: they are not read, and never read as other
# times.
PERSIAN = [
    "یکشنبه، 17 اسفند 1404، 11:59 عصر", "یکشنبه، ۱۷ اسفند ۱۴۰۴، ۲۳:۵۹",  # noqa: RUF001
    "یک\u200cشنبه 17 اسفند 1404 ساعت 23:59", "1404/12/17 23:59:00", "1404-12-17 23:59",  # noqa: RUF001
    "يكشنبه، 17 اسفند 1404، 11:59 بعد از ظهر", "17 اسفند 1404، 11:59 PM", "17/12/1404 23:59",
]  # fmt: skip


@pytest.mark.slow
def test_invalid_date_and_time_is_parsed_as_none() -> None:
    assert parse_times(NO_TIMES, PARIS) == [None] * len(NO_TIMES)


def test_time_in_the_persian_calendar_is_not_read() -> None:
    assert parse_times(PERSIAN, PARIS) == [None] * len(PERSIAN)


@pytest.mark.parametrize(
    ("column", "first"),
    [
        (["03/08/2026 23:59", "04/08/2026 10:00"], None),  # the order of day and month is ambiguous
        (["03/08/2026 23:59", "03/28/2026 10:00"], "2026-03-08T23:59:00+01:00"),
        (["03/08/2026 23:59", "28/08/2026 10:00"], "2026-08-03T23:59:00+02:00"),
    ],
)
def test_column_determines_the_order_of_day_and_month(column: list[str], first: str | None) -> None:
    assert parse_times(column, PARIS)[0] == (first and datetime.fromisoformat(first))
