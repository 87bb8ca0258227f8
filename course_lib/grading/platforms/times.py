"""received.csv, as a platform's own times of receipt make it."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from course_lib.grading.handin.collect import write_list
from course_lib.grading.handin.ids import PLATFORM, ROSTER
from course_lib.grading.handin.received import ID_FROM, LIST
from course_lib.grading.reports.table import harmless


@dataclass(frozen=True)
class PlatformTime:
    """The platform's word on one student's files.

    Args:
        time: As the platform writes it, or "".
        source: Of the time.
        named: Whether a roster names the student.
    """

    time: str
    source: str
    named: bool


def write_receipts(top: Path, receipts: Mapping[str, PlatformTime]) -> None:
    """Write TOP/received.csv with a row for each file in the students' folders."""
    rows = list[dict[str, str]]()
    for student, receipt in receipts.items():
        known = {"received": harmless(receipt.time), "source": receipt.source}
        known[ID_FROM] = ROSTER if receipt.named else PLATFORM
        for path in sorted(path for path in (top / student).rglob("*") if path.is_file()):
            rows.append({"file": path.relative_to(top).as_posix(), **known})
    write_list(top / LIST, rows)
