"""A simulated class on disk: a course, and the platform's download of each week.

WEEK.declared.json has what must come of each hand-in; recompute.py compares it with the records.
"""

import json
import os
import random
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

from course_lib.course.material import checkout_root
from tests.grading.platforms import Handed, moodle_zip, table
from tests.grading.simulated.hand_ins import HandIn, handed_in, tasks_of

PACKAGE = "simulated_class"
FIRST = datetime(2027, 3, 7, 23, 59)  # the first deadline; clocks change within the weeks
WEEK, DAY = timedelta(days=7), timedelta(days=1)
MORNING, MINUTE = timedelta(hours=9), timedelta(minutes=1)
LATE = (  # started days, and the time from the deadline on
    *((0, -3 * DAY),) * 6, *((0, -5 * MINUTE),) * 6, (0, 10 * MINUTE),
    (1, MORNING), (2, DAY + MORNING), (8, 7 * DAY + MORNING),
)  # fmt: skip
EXTENSION = 3 * DAY
ENTRY = f"[course_lib.course]\n{PACKAGE} = {PACKAGE}\n"
HEADINGS = ("Identifier", "ID number", "Last modified (submission)", "Grade")
PROJECT = '[project]\nname = "simulated-class"\nversion = "1"\n'


@dataclass(frozen=True)
class SimulatedClass:
    """The folder of a class over some weeks.

    Args:
        top: The folder.
        students: IDs.
        weeks: "week01", ….
    """

    top: Path
    students: Sequence[str]
    weeks: Sequence[str]

    @property
    def course_toml(self) -> Path:
        return self.top / "exercises" / "course.toml"

    @property
    def environment(self) -> dict[str, str]:
        """Variables with which commands find the course: its distribution is in the folder."""
        before = filter(None, [os.environ.get("PYTHONPATH")])
        return {"PYTHONPATH": os.pathsep.join([str(self.top), *before])}

    def write(self) -> None:
        """Write all but the hand-ins."""
        for name in ("exercises", "solutions", "notebooks"):
            shutil.copytree(checkout_root() / name, self.top / name, dirs_exist_ok=True)
        info = self.top / f"{PACKAGE}-1.dist-info"
        for path, text in {
            info / "METADATA": "Metadata-Version: 2.1\nName: simulated-class\nVersion: 1\n",
            info / "entry_points.txt": ENTRY,
            self.top / PACKAGE / "__init__.py": "",
            self.top / "pyproject.toml": PROJECT,
            self.course_toml: self._settings((checkout_root() / "exercises" / "course.toml").read_text()),
        }.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)

    def deadline(self, week: str) -> datetime:
        return FIRST + (int(week.removeprefix("week")) - 1) * WEEK

    def extended(self, week: str) -> list[str]:
        return [one for one in self.students if random.Random(f"extend {week} {one}").random() < 0.03]

    def _settings(self, text: str) -> str:
        lines = ['time_zone = "Europe/Paris"']
        for line in text.replace("grace_minutes = 1 ", "grace_minutes = 15 ").splitlines():
            lines.append(line)
            if line.startswith("[weeks.") and (week := line[7:-1]) in self.weeks:
                lines.append(f"deadline = {self.deadline(week).isoformat()}")
        for week in self.weeks:
            lines.append(f"[weeks.{week}.extensions]")
            later = (self.deadline(week) + EXTENSION).isoformat()
            lines += [f"{one} = {later}" for one in self.extended(week)]
        return "\n".join(lines)

    def hand_in(self, week: str) -> list[HandIn]:
        """Write the platform's zip and table of a week, and record the expected results."""
        made = list(handed_in(week, self.students))
        numbers = {one: 1000 + number for number, one in enumerate(self.students)}
        days, times = self._times(week, [one.student for one in made])
        exercise = f"{week}_exercise"
        files = {one.student: {f"{exercise}.ipynb": one.data} for one in made}
        sent = [Handed(f"Student {one}", numbers[one], one, files=files[one]) for one in files]
        moodle_zip(self.top / f"{week}.zip", sent)
        rows = [(f"Participant {numbers[one]}", one, time, "") for one, time in times.items()]
        table(self.top / f"{week}.csv", HEADINGS, rows)
        declared = [
            {"student": one.student, "exercise": exercise, "kind": one.kind, "name": one.name}
            | {"tasks": dict(one.expected), "status": one.status, "days_late": days[one.student]}
            for one in made
        ]
        (self.top / f"{week}.declared.json").write_text(json.dumps(declared))
        return made

    def _times(self, week: str, senders: Sequence[str]) -> tuple[Mapping[str, int], Mapping[str, str]]:
        """Return the started late days and the platform's time string of each submission."""
        days, times = {}, {}
        for one in senders:
            late, after = random.Random(f"time {week} {one}").choice(LATE)
            due = self.deadline(week) + (EXTENSION if one in self.extended(week) else 0 * DAY)
            days[one], times[one] = late, f"{due + after:%A, %-d %B %Y, %-I:%M %p}"
        return days, times

    def by_hand(self, made: Sequence[HandIn], week: str, most: int) -> list[tuple[str, str, str]]:
        """Return `count` manual marks: student, task and points."""
        chance, rubric = random.Random(f"marks {week}"), [task.id for task in tasks_of(week) if task.rubric]
        read = [one.student for one in made if one.expected and one.kind != "copied"][:most]
        return [(one, task, f"{chance.randrange(20) / 2:g}") for one in read for task in rubric]
