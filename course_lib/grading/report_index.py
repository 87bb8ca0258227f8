"""The instructor's page: a line per submission, and how often each check failed."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Any
from urllib.parse import quote
from zoneinfo import ZoneInfo

from course_lib.course.state import write_whole
from course_lib.grading.attention import concerns, flags
from course_lib.grading.gradebook import results_in, write_gradebook
from course_lib.grading.handin.copies import alike_in
from course_lib.grading.table import fill
from course_lib.grading.usage import read_usage

# Key in the result's row, heading; numbers are sorted as such.
COLUMNS = (
    ("student", "student"), ("exercise", "exercise"), ("final", "mark"), ("max_score", "of"),
    ("score", "before late policy"), ("days_late", "days late"), ("status", "status"), ("reason", "reason"),
    ("message", "message"), ("cpu_seconds", "CPU [s]"), ("memory_megabytes", "memory [MB]"),
)  # fmt: skip


def write_tables(out: Path, zone: ZoneInfo) -> list[Path]:
    """Write what is derived from all results and marks: the gradebook and the index."""
    return [write_gradebook(out), write_index(out, zone)]


def write_index(out: Path, zone: ZoneInfo) -> Path:
    """Write OUT/reports/index.html from all that OUT/results holds, times in a zone."""
    results = list(results_in(out))
    failures, alike = _failures(results), alike_in(out)
    page = fill(
        "index.html",
        headings=[heading for _, heading in COLUMNS],
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
    place = f"{row['student']}/{row['exercise']}.html"
    time = result["received"] and datetime.fromisoformat(result["received"]).astimezone(zone)
    return {
        "link": quote(place) if (out / "reports" / place).is_file() else "",
        "cells": [f"{v:g}" if isinstance(v, float) else v for v in (row.get(key, "") for key, _ in COLUMNS)],
        "received": time.isoformat(" ", "minutes") if time else "unknown",
        "notes": result["notes"],
    }


def _failures(results: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Each check with how many submissions did not pass it, the most first."""
    judged, failed = Counter[tuple[Any, ...]](), Counter[tuple[Any, ...]]()
    for result in results:
        for task in result.get("tasks", ()):
            for check in task["checks"]:
                key = task["task"], check["title"], check["scenario"], check["hidden"]
                judged[key] += 1
                failed[key] += check["score"] < 1
    shares = sorted(judged, key=lambda key: (-failed[key] / judged[key], key))
    return [{"names": key, "failed": failed[key], "of": judged[key]} for key in shares]
