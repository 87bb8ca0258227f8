"""Tables of all results: gradebook.csv, and the index with submissions to look at."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Any
from urllib.parse import quote
from zoneinfo import ZoneInfo

from course_lib.course.state import write_whole
from course_lib.errors import counted
from course_lib.grading.handin.copies import Alike, alike_in
from course_lib.grading.handin.ids import MISMATCH, NO_ID, UNVERIFIED
from course_lib.grading.marks.mark import COLUMNS, results_in
from course_lib.grading.reports.items import write_items
from course_lib.grading.reports.table import csv_of, few, fill
from course_lib.grading.run.run import read_usage


def write_gradebook(out: Path, results: Iterable[Mapping[str, Any]]) -> Path:
    """Write OUT/gradebook.csv from all results with their rows."""
    path = out / "gradebook.csv"
    write_whole(path, csv_of(COLUMNS, (result["row"].values() for result in results)))
    return path


SIMILAR = "similar code"
ADVICE = {
    MISMATCH: "marked, but not exported before you have looked. Wrong folder: move the file and grade again. "
    "Otherwise accept it by a mark: course mark OUT STUDENT EXERCISE TASK POINTS. "
    "Folders that are not named after IDs: course collect with --roster",
    NO_ID: "the files name no student; judged as who handed in, or as a guest if no roster says who",
    UNVERIFIED: "only the files say whose they are; collect with --roster to have it compared",
    SIMILAR: "to be read side by side in",
}


@dataclass(frozen=True)
class Flag:
    """A reason to look at a submission, and the page that shows more, or ""."""

    kind: str
    text: str
    link: str = ""


@dataclass(frozen=True)
class Concern:
    """A reason to look at several submissions, with pages in OUT/reports that show more."""

    text: str
    pages: tuple[str, ...] = ()

    def line(self, out: Path) -> str:
        """Return it for the terminal."""
        return " ".join([self.text, ", ".join(str(out / "reports" / page) for page in self.pages)]).rstrip()


def flags(result: Mapping[str, Any], alike: Mapping[tuple[str, str], Alike]) -> list[Flag]:
    """Return what to look at in one result."""
    word = result.get("id_flag")
    found = [Flag(word, word)] if word else []
    if similar := alike.get((result["student"], result["exercise"])):
        found.append(Flag(SIMILAR, f"{SIMILAR}: {few(similar.others)}", similar.link))
    return found


def concerns(results: Iterable[Mapping[str, Any]], out: Path) -> list[Concern]:
    """Return each kind of thing to look at, with those whom it concerns."""
    alike, who, pages = alike_in(out), defaultdict[str, list[str]](list), set[str]()
    for result in results:
        is_held = result["row"]["status"] == "needs_marking"
        for flag in (one for one in flags(result, alike) if one.kind != MISMATCH or is_held):
            who[flag.kind].append(f"{result['student']} {result['exercise']}")
            pages |= {flag.link.split("#")[0]} - {""}
    return [
        Concern(
            f"{kind}: {counted(len(who[kind]), 'submission')} ({few(who[kind])}): {advice}",
            tuple(sorted(pages)) if kind == SIMILAR else (),
        )
        for kind, advice in ADVICE.items()
        if kind in who
    ]


# Key in the result's row, heading; numbers are sorted as such.
INDEX_COLUMNS = (
    ("student", "student"), ("exercise", "exercise"), ("final", "mark"), ("max_score", "of"),
    ("score", "before late policy"), ("days_late", "days late"), ("status", "status"), ("reason", "reason"),
    ("message", "message"), ("cpu_seconds", "CPU [s]"), ("memory_megabytes", "memory [MB]"),
)  # fmt: skip


def write_tables(out: Path, zone: ZoneInfo) -> list[dict[str, Any]]:
    """Write the gradebook, the index and the analysis of all tasks; returns all results."""
    results = list(results_in(out))
    write_items(out, results)
    write_gradebook(out, results)
    write_index(out, zone, results)
    return results


def write_index(out: Path, zone: ZoneInfo, results: Sequence[dict[str, Any]]) -> Path:
    """Write OUT/reports/index.html from all results, times in a zone."""
    failures, alike = _failures(results), alike_in(out)
    page = fill(
        "index.html",
        headings=[heading for _, heading in INDEX_COLUMNS],
        lines=[{**_line(result, out, zone), "flags": flags(result, alike)} for result in results],
        concerns=concerns(results, out),
        counts=sorted(Counter(result["row"]["status"] for result in results).items()),
        isolations=Counter(result["isolation"] for result in results).most_common(),
        failures=[row for row in failures if row["failed"]],
        never=sum(not row["failed"] for row in failures),
        zone=zone.key,
    )
    path = out / "reports" / "index.html"
    write_whole(path, page.encode("utf-8", "replace"))
    return path


def _line(result: dict[str, Any], out: Path, zone: ZoneInfo) -> dict[str, Any]:
    usage = read_usage(out, result["attempts"][-1]["key"])
    row = {**result["row"], **(asdict(usage) if usage else {})}
    cells = [row.get(key, "") for key, _ in INDEX_COLUMNS]
    place = f"{row['student']}/{row['exercise']}.html"
    time = result["received"] and datetime.fromisoformat(result["received"]).astimezone(zone)
    return {
        "link": quote(place, errors="surrogateescape") if (out / "reports" / place).is_file() else "",
        "cells": [f"{v:g}" if isinstance(v, float) else v for v in cells],
        "received": time.isoformat(" ", "minutes") if time else "unknown",
        "notes": result["notes"],
    }


def _failures(results: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return each check with the number of submissions that did not pass it, the most first."""
    judged, failed = Counter[tuple[Any, ...]](), Counter[tuple[Any, ...]]()
    for result in results:
        for task in result.get("tasks", ()):
            for check in task["checks"]:
                key = task["task"], check["title"], check["scenario"], check["hidden"]
                judged[key] += 1
                failed[key] += check["score"] < 1
    shares = sorted(judged, key=lambda key: (-failed[key] / judged[key], key))
    return [{"names": key, "failed": failed[key], "of": judged[key]} for key in shares]
