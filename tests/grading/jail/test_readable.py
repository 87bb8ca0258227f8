"""Files that a submission may read, in common layouts of folders."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

import course_lib
from course_lib.errors import CourseError
from course_lib.grading.jail.filters import Isolation
from course_lib.grading.jail.launch import (
    ReadablePaths,
    TemplateProcess,
    find_readable_paths,
    select_readable,
    shared_template,
    symlinks_along,
)
from tests.grading.conftest import RIGHT, write_course
from tests.patience import PATIENCE

COURSE = ("exercises/course.toml", "solutions/checks/week01.py", "in/bob/week01.ipynb", "out/gradebook.csv")
LAYOUTS = {  # locations of the checkout, of Python's modules and of its packages
    "environment in the checkout": ("app", "app/lib/python3", "app/lib/python3/site-packages"),
    "environment beside": ("app", "env/lib/python3", "env/lib/python3/site-packages"),
    "packages beside the modules": ("app", "usr/lib/python3.11", "usr/lib/python3/dist-packages"),
    "checkout in the prefix": ("usr/src/app", "usr/lib/python3", "usr/lib/python3/site-packages"),
    "checkout among the modules": ("usr/lib/python3/app", "usr/lib/python3", "usr/lib/python3/site-packages"),
    "checkout among the packages": ("usr/site-packages/app", "usr/lib/python3", "usr/site-packages"),
    "checkout in a package": ("usr/site-packages/numpy/app", "usr/lib/python3", "usr/site-packages"),
    "environment in the submissions": ("app", "app/in/lib/python3", "app/in/lib/python3/site-packages"),
}


def written(path: Path) -> str:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("x")
    return str(path)


def is_open(path: str, files: ReadablePaths) -> bool:
    real = os.path.realpath(path)
    return any(real == one or real.startswith(one + "/") for one in files.paths)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_course_is_unreadable_and_python_readable_in_every_installation_layout(
    layout: str, tmp_path: Path
) -> None:
    checkout, modules, packages = (tmp_path / folder for folder in LAYOUTS[layout])
    closed = [written(checkout / name) for name in COURSE]
    closed += [written(packages / name) for name in ("private/__init__.py", "private.py")]
    open_ = [written(modules / name) for name in ("os.py", "json/decoder.py")]
    open_ += [written(packages / "numpy/core/x.so"), written(checkout / "course_lib/grading/worker.py")]
    refused = [str(checkout / name.split("/")[0]) for name in COURSE]
    needed = [str(modules), str(packages), str(packages / "numpy"), str(checkout / "course_lib")]
    files = select_readable(needed, [str(modules), str(packages)], refused)
    assert [path for path in closed if is_open(path, files)] == []
    assert [path for path in open_ if not is_open(path, files)] == []
    listed = [folder for folder in files.listed if any(path.startswith(folder + "/") for path in refused)]
    assert listed == []


def test_result_folder_created_later_is_not_readable(tmp_path: Path) -> None:
    written(tmp_path / "lib/os.py")
    files = select_readable([str(tmp_path / "lib")], [], [str(tmp_path / "lib/out")])
    assert not is_open(written(tmp_path / "lib/out/gradebook.csv"), files)
    assert files.conflict == str(tmp_path / "lib/out")


def test_target_of_a_link_in_a_readable_folder_is_not_readable(tmp_path: Path) -> None:
    secret = written(tmp_path / "solutions/week01.ipynb")
    written(tmp_path / "lib/out/x")
    (tmp_path / "lib/link").symlink_to(Path(secret).parent)
    files = select_readable([str(tmp_path / "lib")], [], [str(tmp_path / "lib/out")])
    assert not is_open(secret, files)
    assert not is_open(str(tmp_path / "lib/link/week01.ipynb"), files)


def test_symlinks_on_the_path_of_a_required_file_are_resolved(tmp_path: Path) -> None:
    written(tmp_path / "usr/lib/a/x.so")
    (tmp_path / "lib").symlink_to("usr/lib")
    (tmp_path / "usr/lib/b").symlink_to(tmp_path / "lib/a")
    links = dict(symlinks_along(str(tmp_path / "lib/b/x.so")))
    lib = str(tmp_path / "lib")
    assert links == {lib: "usr/lib", str(tmp_path / "usr/lib/b"): f"{lib}/a"}


def test_required_folder_that_is_the_course_itself_is_an_error(tmp_path: Path) -> None:
    written(tmp_path / "lib/os.py")
    with pytest.raises(CourseError, match=r"submissions must not read .*lib, but Python needs it"):
        select_readable([str(tmp_path / "lib")], [], [str(tmp_path / "lib")])


def test_only_declared_distributions_are_readable() -> None:
    listed = find_readable_paths().listed
    packages = [folder for folder in listed if folder.endswith("site-packages")]
    for name, wanted in {"numpy": True, "yaml": True, "mypy": False, "pytest": False}.items():
        found = [path for folder in packages if os.path.exists(path := os.path.join(folder, name))]
        assert found, name
        assert is_open(found[0], find_readable_paths()) is wanted, name


@pytest.mark.slow
def test_course_inside_a_required_folder_is_rejected_without_namespaces(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    conflict = ReadablePaths(**{**vars(find_readable_paths()), "conflict": "/usr/lib/submissions"})
    monkeypatch.setattr("course_lib.grading.jail.launch.find_readable_paths", lambda _: conflict)
    with pytest.raises(CourseError, match="/usr/lib/submissions is in a folder that Python needs"):
        TemplateProcess(("bubblewrap", "namespaces")).close()


@pytest.mark.slow
def test_template_process_does_not_change_file_modes() -> None:
    def modes() -> list[int]:
        readable = find_readable_paths()
        return [os.stat(path).st_mode for path in (*readable.listed, *readable.paths)]

    before = modes()
    with closing(TemplateProcess()):
        pass
    assert modes() == before


ATTACK = """
import os
for path in {paths!r}:
    for name in ("open", "stat", "listdir", "chdir"):
        for place in (path, os.path.dirname(path)):
            try: getattr(os, name)(*[place, os.O_RDONLY][: 2 if name == "open" else 1])
            except OSError: continue
            print("REACHED", name, place)
"""


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A checkout that is also an environment, as `python3 -m venv .` makes one, with packages of this one."""
    top = tmp_path / "src/app"
    source = Path(course_lib.__file__).parent
    shutil.copytree(source, top / "course_lib", ignore=shutil.ignore_patterns("__pycache__", "_course"))
    base = os.path.join(sys.base_prefix, "bin", "python3")
    subprocess.run([base, "-m", "venv", "--without-pip", str(top)], check=True, timeout=PATIENCE)
    (packages,) = top.glob("lib/python*/site-packages")
    (packages / "of_this_environment.pth").write_text(
        "\n".join(p for p in sys.path if p.endswith("-packages"))
    )
    write_course(top)
    return top


@pytest.mark.slow
def test_submission_cannot_read_a_course_installed_in_an_environment(
    checkout: Path, write_notebook: Callable[..., Path]
) -> None:
    names = (
        "exercises/course.toml",
        "solutions/checks/week01.py",
        "in/bob/week01_exercise.ipynb",
        "out/results/x",
    )
    paths = [str(checkout / name) for name in names]
    write_notebook(checkout / "in/bob/week01_exercise.ipynb", RIGHT, student="bob")
    attack = f"{ATTACK.format(paths=paths)}\n# next cell\n{RIGHT}"
    write_notebook(checkout / "in/eve/week01_exercise.ipynb", attack, student="eve")
    grade = "from pathlib import Path; from course_lib.grading.grade import grade\n"
    grade += "from course_lib.grading.store import Course\n"
    grade += "grade(Path('in'), Path('out'), jobs=1, course=Course(Path('exercises'), Path('solutions')))"
    command = [str(checkout / "bin/python"), "-c", grade]
    environment = {**os.environ, "PYTHONPATH": str(checkout)}
    process = subprocess.run(
        command, cwd=checkout, env=environment, capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert process.returncode == 0, process.stdout + process.stderr
    eve = json.loads((checkout / "out/results/eve/week01_exercise.json").read_text())
    assert [task["score"] for task in eve["judgement"]["tasks"]] == [60.0, 40.0, 10.0]
    hidden = Isolation(shared_template().isolation.layers).hides_names
    reached = [line for line in eve["judgement"]["output"].splitlines() if "REACHED" in line]
    allowed = () if hidden else ("stat", "chdir")  # not restricted by Landlock
    assert [line for line in reached if line.split()[1] not in allowed] == []
