import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.checkout import ROOT, tracked

TOP_LEVEL = {
    "notebooks", "course_lib", "exercises", "solutions", "tests", "pyproject.toml", "README.md", "LICENSE",
    "CHANGELOG.md", "docs", "CONTRIBUTING.md",
}  # fmt: skip
PUBLIC = {"course_lib"} | {
    f"course_lib.{room}" for room in ("displays", "export", "grading", "robots", "sensors")
}
ROOMS = sorted(path.parent for path in (ROOT / "course_lib").glob("*/__init__.py"))
WRITTEN_BY_EXPORT = {"setup.py"}
MAX_FILE, MAX_FUNCTION, MAX_README = 300, 40, 60  # lines
# Of course_lib's Python: lower them when it shrinks, raise them for what an issue names.
MOST_FILES, MOST_LINES, MOST_LONG_LINES = 538, 68_150, 3_000
LONG = 100  # characters


def test_the_top_level_holds_what_the_design_names() -> None:
    assert {p.parts[0] for p in tracked() if not p.parts[0].startswith(".")} <= TOP_LEVEL


def test_no_file_is_over_300_lines_and_no_function_over_40() -> None:
    too_long = []
    for path in tracked():
        if path.suffix != ".py":
            continue
        source = (ROOT / path).read_text()
        if len(source.splitlines()) > MAX_FILE:
            too_long.append(str(path))
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                lines = (node.end_lineno or 0) - node.lineno + 1  # from its def, signature included
                too_long += [f"{path}:{node.name}"] if lines > MAX_FUNCTION else []
    assert too_long == []


def test_course_lib_grows_neither_in_files_nor_in_lines_nor_in_long_ones() -> None:
    files = [path for path in tracked() if path.parts[0] == "course_lib" and path.suffix == ".py"]
    lines = [line for path in files for line in (ROOT / path).read_text("utf-8").splitlines()]
    assert len(files) <= MOST_FILES
    assert len(lines) <= MOST_LINES
    assert sum(len(line) > LONG for line in lines) <= MOST_LONG_LINES


def test_no_class_name_occurs_twice_outside_the_standin() -> None:
    places: dict[str, list[str]] = {}
    for path in sorted((ROOT / "course_lib").rglob("*.py")):
        if "standin" not in path.parts:
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if isinstance(node, ast.ClassDef):
                    places.setdefault(node.name, []).append(path.name)
    assert {name: files for name, files in places.items() if len(files) > 1} == {}


@pytest.mark.parametrize("room", ROOMS, ids=lambda room: room.name)
def test_every_room_has_a_page_whose_files_exist(room: Path) -> None:
    page = (room / "README.md").read_text("utf-8")
    assert len(page.splitlines()) <= MAX_README
    named = set(re.findall(r"`([\w/]+\.(?:py|js|ts))`", page)) - WRITTEN_BY_EXPORT
    rooms = ROOT / "course_lib"
    assert [name for name in named if not (ROOT / name).exists() and not any(rooms.rglob(name))] == []


FOR_USERS = [*ROOT.glob("*s/*.ipynb"), *ROOT.glob("*s/checks/*.py"), ROOT / "README.md"]


@pytest.mark.parametrize("path", sorted(FOR_USERS), ids=lambda path: path.relative_to(ROOT).as_posix())
def test_users_import_only_the_public_modules(path: Path) -> None:
    code = path.read_text("utf-8")
    if path.suffix == ".ipynb":
        cells = json.loads(code)["cells"]
        code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    imported = re.findall(r"^\s*(?:from|import) (course_lib[\w.]*)", code, re.MULTILINE)
    assert set(imported) <= PUBLIC


@pytest.mark.parametrize("module", sorted(PUBLIC))
def test_public_modules_can_be_imported_alone_and_load_all_their_names(module: str) -> None:
    code = f"import {module} as public; print(*[getattr(public, name).__class__ for name in public.__all__])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()
