import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta, tzinfo
from pathlib import Path
from typing import Self
from zoneinfo import ZoneInfo

import pytest

from course_lib import cli
from course_lib.course import release as release_module
from course_lib.course import student_folder
from course_lib.course.course_file import CourseFile, LatePolicy, WeekSettings
from course_lib.course.exercise import BEGIN, END, read_notebook, source
from course_lib.course.material import checkout_root, lessons_dir, solutions_dir
from course_lib.course.release import EXTENSIONS, _copy, _without_extensions, release
from course_lib.course.student_folder import SOLUTIONS
from course_lib.errors import CourseError
from course_lib.grading.records import count_days_late
from tests.patience import PATIENCE


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("release") / "students"
    release(place)
    return place


def answers() -> list[str]:
    """The longer lines of all answers, except faulty starts, which are released."""
    lines = []
    for path in solutions_dir().glob("week*_solution.ipynb"):
        inside, outside = list[str](), set[str]()
        for cell in read_notebook(path)["cells"]:
            answer = False
            for line in source(cell).splitlines():
                answer = (answer or bool(BEGIN.match(line))) and line.strip() != END
                (inside.append if answer else outside.add)(line.strip())
        lines += [line for line in inside if len(line) > 60 and line not in outside]
    return [line for line in lines if not BEGIN.match(line)]


def test_release_has_no_solutions_hidden_checks_or_tests(out: Path) -> None:
    names = {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()}
    assert {"README.md", "pyproject.toml", "exercises/week01_exercise.ipynb", "course_lib/cli.py"} <= names
    kept = (".binder/", ".devcontainer/")  # with which a class runs it on a hub
    others = {name for name in names if not name.startswith(kept)}
    assert others < names
    assert not [
        name for name in others if name.startswith(("solutions", "tests", ".")) or "__pycache__" in name
    ]
    assert not [name for name in names if "HIDDEN = {" in (out / name).read_text(errors="replace")]


def test_release_contains_all_lessons_and_readme_images(out: Path) -> None:
    lessons = {path.name for path in lessons_dir().glob("*.ipynb")}
    assert {path.name for path in (out / "notebooks").glob("*.ipynb")} == lessons
    pictures = re.findall(r"docs/images/\w+\.png", (out / "README.md").read_text(encoding="utf-8"))
    assert len(pictures) > len(lessons) // 2
    assert [name for name in pictures if not (out / name).is_file()] == []


def test_exercises_contain_no_line_of_an_answer(out: Path) -> None:
    released = "\n".join(path.read_text() for path in (out / "exercises").rglob("*.ipynb"))
    assert len(answers()) > 50
    assert not [line for line in answers() if line in released]


def settings(**late: float) -> CourseFile:
    """A course whose week 1 ends on 7 March, for one student on 10 March, in UTC."""
    week = WeekSettings("One", datetime(2027, 3, 7, 12), extensions={"7": datetime(2027, 3, 10, 12)})
    return CourseFile(
        "", {"week01": week, "week02": WeekSettings("Two")}, ZoneInfo("UTC"), LatePolicy(**late)
    )


@pytest.mark.parametrize(
    ("late", "day"),
    [({}, 19), ({"accepted_days": 2}, 12), ({"accepted_days": 0}, 10), ({"percent_per_day": 100}, 10)],
)
def test_week_closes_after_the_last_late_day_of_the_last_extension(late: dict[str, float], day: int) -> None:
    assert settings(**late).closing_time("week01") == datetime(2027, 3, day, 12, tzinfo=UTC)


@pytest.mark.parametrize("deadline", [datetime(2026, 10, 24, 23, 59), datetime(2026, 3, 28, 23, 59)])
def test_week_closes_when_the_late_policy_ends_although_clocks_change(deadline: datetime) -> None:
    late = LatePolicy(accepted_days=2, grace_minutes=1)
    course = CourseFile("", {"week01": WeekSettings("One", deadline)}, ZoneInfo("Europe/Paris"), late)
    closing = course.closing_time("week01")
    end = course.deadline("week01", "7")
    days = [count_days_late(closing + timedelta(seconds=after), end, late) for after in (0, 1)]
    assert [late.is_accepted(one) for one in days] == [True, False]


@pytest.mark.parametrize(
    ("week", "late", "message"),
    [
        ("week02", {}, "week02 has no deadline"),
        ("week01", {"max_percent": 50}, "week01 can always be handed in late: set accepted_days"),
        ("week1", {}, "there is no week1 in course.toml. Did you mean week01"),
    ],
)
def test_week_without_an_end_never_closes(week: str, late: dict[str, float], message: str) -> None:
    with pytest.raises(CourseError, match=message):
        settings(**late).closing_time(week)


def test_solution_is_released_only_after_its_week_closes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(release_module, "shipped_course_file", lambda: settings(accepted_days=2))
    place = tmp_path / "students"
    until = "week01 can be handed in for points until 2027-03-12 12:00"
    before = datetime(2027, 3, 12, 11, 59, tzinfo=UTC)
    with clock_at(monkeypatch, before), pytest.raises(CourseError, match=until):
        release(place, ["week01"])
    assert not place.exists()
    with clock_at(monkeypatch, datetime(2027, 3, 12, 12, tzinfo=UTC)):
        release(place, ["week01"])
    (solution,) = (place / "exercises" / SOLUTIONS).iterdir()
    code = "\n".join(source(cell) for cell in read_notebook(solution)["cells"])
    assert "marker.pose.position.z" in code
    assert "# solution:" not in code
    assert END not in code


def test_released_solution_is_copied_to_a_separate_student_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    exercises = tmp_path / "exercises"
    (exercises / SOLUTIONS).mkdir(parents=True)
    (exercises / SOLUTIONS / "week01_solution.ipynb").write_text("{}")
    monkeypatch.setattr(student_folder, "exercises_dir", lambda: exercises)
    assert "solutions/week01_solution.ipynb" in student_folder.shipped_files()


@contextmanager
def clock_at(monkeypatch: pytest.MonkeyPatch, now: datetime) -> Iterator[None]:
    """Set the clock of the release."""

    class Clock(datetime):
        @classmethod
        def now(cls, tz: tzinfo | None = None) -> Self:
            return cls.fromtimestamp(now.timestamp(), tz)

    with monkeypatch.context() as patch:
        patch.setattr(release_module, "datetime", Clock)
        yield


def test_files_written_by_lessons_are_not_released(tmp_path: Path) -> None:
    (tmp_path / "notebooks/my_bag").mkdir(parents=True)
    for name in ("week01_x.ipynb", "week07_parts.py", "mine.rviz", "my_bag/metadata.yaml"):
        (tmp_path / "notebooks" / name).write_text("")
    copied = _copy(tmp_path / "notebooks", tmp_path / "out")
    assert sorted(path.name for path in copied.iterdir()) == ["week01_x.ipynb", "week07_parts.py"]


def test_folder_of_a_killed_release_is_rejected_with_the_reason(tmp_path: Path) -> None:
    (tmp_path / ".release.x1.draft").mkdir()
    with pytest.raises(CourseError, match="a release into it was killed and is not complete"):
        release(tmp_path)


def test_nonempty_release_folder_is_rejected_and_unchanged(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(CourseError, match="not an empty folder"):
        release(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
    with pytest.raises(CourseError, match="inside the released files"):
        release(checkout_root() / "exercises" / "out")


def test_read_only_disk_is_reported_before_the_weeks_are_verified(
    monkeypatch: pytest.MonkeyPatch, small_disk: Path
) -> None:
    monkeypatch.setattr("course_lib.authoring.verify.reject_broken", lambda *_: pytest.fail("verified"))
    subprocess.run(("mount", "-o", "remount,ro", str(small_disk)), check=True, timeout=PATIENCE)
    with pytest.raises(CourseError, match=f"Cannot write to {small_disk}. Choose a folder"):
        cli.release(small_disk / "new" / "release")


def test_outdated_exercise_prevents_the_release(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(release_module, "write_exercises", lambda: [Path("week01_exercise.ipynb")])
    with pytest.raises(CourseError, match=r"week01_exercise\.ipynb.*Review and commit"):
        release(tmp_path / "out")
    assert not (tmp_path / "out").exists()
    # The command reports this before it verifies the weeks, which takes minutes.
    monkeypatch.setattr("course_lib.authoring.verify.reject_broken", lambda *_: pytest.fail("verified"))
    with pytest.raises(CourseError, match="Review and commit"):
        cli.release(tmp_path / "out")


@pytest.mark.slow
def test_wheel_of_the_release_creates_a_student_folder(out: Path, tmp_path: Path) -> None:
    pytest.importorskip("hatchling")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run(
        [*pip, "--target", str(tmp_path / "site"), str(out)],
        check=True,
        capture_output=True,
        timeout=5 * PATIENCE,
    )
    code = (
        "from pathlib import Path; from course_lib.course import material, questions, student_folder\n"
        "print(material.PACKAGE); print(*student_folder.prepare(Path('mine')).added)\n"
        "questions.read_quiz('week01')"
    )
    environment = os.environ | {"PYTHONPATH": str(tmp_path / "site")}
    command = [sys.executable, "-c", code]
    process = subprocess.run(
        command,
        cwd=tmp_path,
        env=environment,
        check=True,
        capture_output=True,
        text=True,
        timeout=5 * PATIENCE,
    ).stdout.splitlines()
    assert process[0] == str(tmp_path / "site" / "course_lib")
    assert {"week00_welcome.ipynb", "week01_first_marker.ipynb", "week01_exercise.ipynb"} <= set(
        process[1].split()
    )
    assert not list((tmp_path / "site").rglob("*solution*"))


def test_extensions_are_not_released() -> None:
    text = (
        '[weeks.week01]\ntitle = "A"\n[weeks.week01.extensions]\nada = 2027-01-01T00:00:00\n[weeks.week02]\n'
    )
    assert EXTENSIONS.sub("", text) == '[weeks.week01]\ntitle = "A"\n[weeks.week02]\n'
    assert EXTENSIONS.sub("", text.split("[weeks.week02]")[0]) == '[weeks.week01]\ntitle = "A"\n'


def test_extensions_inside_released_files_are_rejected(tmp_path: Path) -> None:
    path = tmp_path / "course.toml"
    week = '[weeks.week01]\ntitle = "A"\nextensions = {ada = 2027-01-01T00:00:00}\n'
    path.write_text(f'title = "A"\ntime_zone = "UTC"\n{week}')
    with pytest.raises(CourseError, match=r"as a table, \[weeks\.week01\.extensions\]"):
        _without_extensions(path)


@pytest.mark.parametrize(
    "path", [".binder/postBuild", ".devcontainer/Dockerfile", ".devcontainer/devcontainer.json"]
)
def test_image_build_command_creates_the_student_folder(
    path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    match = re.search(r"course lab my_course --no-server", (checkout_root() / path).read_text())
    assert match
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", match.group().split())
    with pytest.raises(SystemExit) as left:
        cli.main()
    assert left.value.code == 0
    assert (tmp_path / "my_course" / "week00_welcome.ipynb").is_file()


def test_image_runs_as_non_root_and_its_settings_are_readable() -> None:
    image = (checkout_root() / ".devcontainer" / "Dockerfile").read_text()
    settings = json.loads((checkout_root() / ".devcontainer" / "devcontainer.json").read_text())
    assert re.findall(r"^USER (\w+)", image, re.MULTILINE) == [settings["remoteUser"]]


def test_release_of_a_custom_course_contains_a_student_readme(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "exercises").mkdir()
    (tmp_path / "exercises/course.toml").write_text('title = "Maps"\ntime_zone = "UTC"\n\n[weeks]\n')
    (tmp_path / "README.md").write_text("course verify")
    monkeypatch.setattr(release_module, "course_package", lambda: tmp_path / "maps")
    readme = release_module._readme(tmp_path)
    assert readme.startswith("# Maps\n")
    assert "course lab" in readme
    assert "verify" not in readme
    (tmp_path / "README_students.md").write_text("# Welcome")
    assert release_module._readme(tmp_path) == "# Welcome"


def test_release_on_a_full_disk_is_reported_and_leaves_the_folder_empty(small_disk: Path) -> None:
    with pytest.raises(CourseError, match="No space left on device"):
        release(small_disk)
    assert not list(small_disk.iterdir())


def test_killed_release_leaves_no_released_files(tmp_path: Path) -> None:
    code = (
        "import os, sys; from pathlib import Path; from course_lib.course import release as f\n"
        "f._readme = lambda root: os.kill(os.getpid(), 9)\n"
        "f.release(Path(sys.argv[1]))"
    )
    command = (sys.executable, "-c", code, str(tmp_path))
    assert subprocess.run(command, check=False, timeout=PATIENCE).returncode == -9
    assert all(path.name.endswith(".draft") for path in tmp_path.iterdir())
