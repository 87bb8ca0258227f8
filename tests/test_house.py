import ast
import json
import re
import subprocess
import sys
import warnings
from pathlib import Path

import pytest

from tests.checkout import ROOT, tracked
from tests.patience import PATIENCE

TOP_LEVEL = {
    "notebooks", "course_lib", "exercises", "solutions", "tests", "pyproject.toml", "README.md", "LICENSE",
    "CHANGELOG.md", "docs", "CONTRIBUTING.md",
}  # fmt: skip
PUBLIC = {"course_lib"} | {
    f"course_lib.{room}" for room in ("displays", "export", "grading", "robots", "sensors")
}
ROOMS = sorted(path.parent for path in (ROOT / "course_lib").glob("*/__init__.py"))
WRITTEN_BY_EXPORT = {"setup.py"}
LONG_FILE = 900  # lines


def test_top_level_folder_contains_only_the_documented_entries() -> None:
    assert {p.parts[0] for p in tracked() if not p.parts[0].startswith(".")} <= TOP_LEVEL


def test_file_over_900_lines_raises_a_warning() -> None:
    for path in tracked():
        if path.suffix == ".py" and (count := len((ROOT / path).read_text("utf-8").splitlines())) > LONG_FILE:
            warnings.warn(f"{path} has {count} lines: does it hold two subjects?", stacklevel=1)


def test_each_class_name_is_unique_within_its_room() -> None:
    places: dict[tuple[str, str], list[str]] = {}
    for path in sorted((ROOT / "course_lib").rglob("*.py")):
        if "standin" in path.parts:
            # ROS itself repeats class names between its packages.
            continue
        room = path.relative_to(ROOT / "course_lib").parts[0]
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ClassDef):
                places.setdefault((room, node.name), []).append(path.name)
    assert {name: files for name, files in places.items() if len(files) > 1} == {}


@pytest.mark.parametrize("room", ROOMS, ids=lambda room: room.name)
def test_every_room_has_a_readme_with_existing_files(room: Path) -> None:
    page = (room / "README.md").read_text("utf-8")
    named = set(re.findall(r"`([\w/]+\.(?:py|js|ts))`", page)) - WRITTEN_BY_EXPORT
    rooms = ROOT / "course_lib"
    assert [name for name in named if not (ROOT / name).exists() and not any(rooms.rglob(name))] == []


# Benchmarks are run manually; `renew.py` limits the waits of the probes of the real rclpy.
RUN_BY_HAND = {"benchmarks", "probes", "renew.py", "processes.py"}
# In a run, waits are in robot time: they end with the run or in a DeadlockError.
IN_ROBOT_TIME = {
    "test_clock.py", "test_executors.py", "test_locks.py", "test_processes.py", "test_sim_time.py",
    "test_virtual_time.py",
}  # fmt: skip
# Methods of the kit or of tests with these names, which have limits of their own.
BOUNDED = {"handlers", "kits"}
RUNS = {"run", "call", "check_call", "check_output"}


def unbounded_waits(path: Path) -> list[str]:
    """List the calls of a file of tests that can wait for ever."""
    text, found = path.read_text("utf-8"), []
    has_threads = path.name not in IN_ROBOT_TIME and re.search("^(import|from) (threading|queue)", text, re.M)
    for call in ast.walk(ast.parse(text)):
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Attribute)):
            continue
        owner, name = ast.unparse(call.func.value), call.func.attr
        if any(keyword.arg == "timeout" for keyword in call.keywords):
            continue
        is_process = owner == "subprocess" and (name == "Popen" or name in RUNS)
        is_thread = has_threads and not call.args and name in {"join", "wait", "get"} and owner not in BOUNDED
        if is_process or is_thread or name == "urlopen":
            found.append(f"{path.name}:{call.lineno}: {ast.unparse(call)}")
    return found


def test_every_wait_of_a_test_has_a_time_limit() -> None:
    files = [path for path in tracked() if path.parts[0] == "tests" and path.suffix == ".py"]
    looked_at = [ROOT / path for path in files if not RUN_BY_HAND & set(path.parts)]
    found = [wait for path in looked_at for wait in unbounded_waits(path)]
    assert found == [], "tests/processes.py starts programs with a limit, tests/patience.py joins threads"


FOR_USERS = [*ROOT.glob("*s/*.ipynb"), *ROOT.glob("*s/checks/*.py"), ROOT / "README.md"]


@pytest.mark.parametrize("path", sorted(FOR_USERS), ids=lambda path: path.relative_to(ROOT).as_posix())
def test_documents_and_notebooks_import_only_public_modules(path: Path) -> None:
    code = path.read_text("utf-8")
    if path.suffix == ".ipynb":
        cells = json.loads(code)["cells"]
        code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    imported = re.findall(r"^\s*(?:from|import) (course_lib[\w.]*)", code, re.MULTILINE)
    assert set(imported) <= PUBLIC


@pytest.mark.parametrize("module", sorted(PUBLIC))
def test_public_modules_can_be_imported_alone_and_load_all_their_names(module: str) -> None:
    code = f"import {module} as public; print(*[getattr(public, name).__class__ for name in public.__all__])"
    process = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert process.returncode == 0, process.stderr
    assert process.stdout.strip()
