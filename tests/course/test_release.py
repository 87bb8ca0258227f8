import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from course_lib import cli
from course_lib.course import hand_out
from course_lib.course.exercise import BEGIN, END, read_notebook, source
from course_lib.course.hand_out import EXTENSIONS, _copy, _without_extensions, release
from course_lib.course.installation import checkout_root, lessons_dir, solutions_dir
from course_lib.errors import CourseError


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("release") / "students"
    release(place)
    return place


def answers() -> list[str]:
    """The longer lines of all answers, but those that are handed out as faulty starts."""
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


def test_no_solution_no_hidden_check_and_no_test_is_inside(out: Path) -> None:
    names = {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()}
    assert {"README.md", "pyproject.toml", "exercises/week01_exercise.ipynb", "course_lib/cli.py"} <= names
    kept = (".binder/", ".devcontainer/")  # with which a class runs it on a hub
    others = {name for name in names if not name.startswith(kept)}
    assert others < names
    assert not [
        name for name in others if name.startswith(("solutions", "tests", ".")) or "__pycache__" in name
    ]
    assert not [name for name in names if "HIDDEN = {" in (out / name).read_text(errors="replace")]


def test_all_lessons_and_the_pictures_of_the_readme_are_inside(out: Path) -> None:
    lessons = {path.name for path in lessons_dir().glob("*.ipynb")}
    assert {path.name for path in (out / "notebooks").glob("*.ipynb")} == lessons
    pictures = re.findall(r"docs/images/\w+\.png", (out / "README.md").read_text(encoding="utf-8"))
    assert len(pictures) > len(lessons) // 2
    assert [name for name in pictures if not (out / name).is_file()] == []


def test_no_line_of_an_answer_is_in_what_students_fill_in(out: Path) -> None:
    released = "\n".join(path.read_text() for path in (out / "exercises").rglob("*.ipynb"))
    assert len(answers()) > 50
    assert not [line for line in answers() if line in released]


def test_what_lessons_have_written_beside_themselves_stays_here(tmp_path: Path) -> None:
    (tmp_path / "notebooks/my_bag").mkdir(parents=True)
    for name in ("week01_x.ipynb", "week07_parts.py", "mine.rviz", "my_bag/metadata.yaml"):
        (tmp_path / "notebooks" / name).write_text("")
    copied = _copy(tmp_path / "notebooks", tmp_path / "out")
    assert sorted(path.name for path in copied.iterdir()) == ["week01_x.ipynb", "week07_parts.py"]


def test_a_folder_that_holds_something_is_not_touched(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(CourseError, match="not an empty folder"):
        release(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["notes.txt"]
    with pytest.raises(CourseError, match="inside what is released"):
        release(checkout_root() / "exercises" / "out")


def test_an_exercise_that_was_stale_stops_the_release(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(hand_out, "write_exercises", lambda: [Path("week01_exercise.ipynb")])
    with pytest.raises(CourseError, match=r"week01_exercise\.ipynb.*Review and commit"):
        release(tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_a_wheel_of_the_release_prepares_a_students_folder(out: Path, tmp_path: Path) -> None:
    pytest.importorskip("hatchling")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation"]
    subprocess.run([*pip, "--target", str(tmp_path / "site"), str(out)], check=True, capture_output=True)
    code = (
        "from pathlib import Path; from course_lib.course import hand_out, installation, questions\n"
        "print(installation.PACKAGE); print(*hand_out.prepare(Path('mine')).added)\n"
        "questions.load_quiz('week01')"
    )
    environment = os.environ | {"PYTHONPATH": str(tmp_path / "site")}
    command = [sys.executable, "-c", code]
    said = subprocess.run(
        command, cwd=tmp_path, env=environment, check=True, capture_output=True, text=True
    ).stdout.splitlines()
    assert said[0] == str(tmp_path / "site" / "course_lib")
    assert {"week00_welcome.ipynb", "week01_first_marker.ipynb", "week01_exercise.ipynb"} <= set(
        said[1].split()
    )
    assert not list((tmp_path / "site").rglob("*solution*"))


def test_who_got_more_time_is_not_released() -> None:
    text = (
        '[weeks.week01]\ntitle = "A"\n[weeks.week01.extensions]\nada = 2027-01-01T00:00:00\n[weeks.week02]\n'
    )
    assert EXTENSIONS.sub("", text) == '[weeks.week01]\ntitle = "A"\n[weeks.week02]\n'
    assert EXTENSIONS.sub("", text.split("[weeks.week02]")[0]) == '[weeks.week01]\ntitle = "A"\n'


def test_extensions_that_would_be_released_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "course.toml"
    week = '[weeks.week01]\ntitle = "A"\nextensions = {ada = 2027-01-01T00:00:00}\n'
    path.write_text(f'title = "A"\ntime_zone = "UTC"\n{week}')
    with pytest.raises(CourseError, match=r"as a table, \[weeks\.week01\.extensions\]"):
        _without_extensions(path)


@pytest.mark.parametrize(
    "path", [".binder/postBuild", ".devcontainer/Dockerfile", ".devcontainer/devcontainer.json"]
)
def test_what_makes_an_image_types_a_command_that_writes_the_students_folder(
    path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = re.search(r"course lab my_course --no-server", (checkout_root() / path).read_text())
    assert found
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", found.group().split())
    with pytest.raises(SystemExit) as left:
        cli.main()
    assert left.value.code == 0
    assert (tmp_path / "my_course" / "week00_welcome.ipynb").is_file()


def test_the_image_is_not_roots_and_its_settings_can_be_read() -> None:
    image = (checkout_root() / ".devcontainer" / "Dockerfile").read_text()
    settings = json.loads((checkout_root() / ".devcontainer" / "devcontainer.json").read_text())
    assert re.findall(r"^USER (\w+)", image, re.MULTILINE) == [settings["remoteUser"]]
