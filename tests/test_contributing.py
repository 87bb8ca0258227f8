"""The recipes of CONTRIBUTING.md, carried out in a copy of the project."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.patience import PATIENCE

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
RECIPES = re.findall(r"^### (Add .+)\n((?:(?!###).*\n)+)", PAGE, re.MULTILINE)
BLOCK = re.compile(r"^```(\w+)(?: (file)=(\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
# Words of the rooms' pages that stand for any name.
ANY_NAME = {"SomeClass", "transform_x_to_world", "week01_exercise_ID"}
LEFT_OUT = shutil.ignore_patterns(".*", "*.pyc.*", "build", "dist")  # compiled files are copied, too


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the project in which all recipes are carried out, one after the other.

    The display of the first recipe is in the project; the copy is as it was before.
    """
    copy = tmp_path_factory.mktemp("checkout") / "course"
    shutil.copytree(ROOT, copy, ignore=LEFT_OUT)
    for language, _, name, content in BLOCK.findall(RECIPES[0][1]):
        path = copy / name
        if language == "python":
            assert path.read_text("utf-8") == content, f"the page shows another {name}"
            path.unlink()
        elif language == "diff":
            path.write_text(edit(path.read_text("utf-8"), undone(content)), "utf-8")
    return copy


def edit(text: str, change: str) -> str:
    """Apply one hunk of a diff without line numbers; its old lines occur once."""
    lines = change.splitlines(keepends=True)
    old = "".join(line[1:] for line in lines if not line.startswith("+"))
    new = "".join(line[1:] for line in lines if not line.startswith("-"))
    assert text.count(old) == 1, f"these lines are there {text.count(old)} times:\n{old}"
    return text.replace(old, new)


def undone(change: str) -> str:
    """Return the hunk that reverts another one."""
    signs = {"+": "-", "-": "+", " ": " "}
    return "".join(signs[line[0]] + line[1:] for line in change.splitlines(keepends=True))


def run(line: str, folder: Path) -> None:
    """Run a command of a recipe with this Python."""
    program, *words = shlex.split(line)
    command = [sys.executable, *(["-m", program] if program != "python" else []), *words]
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    process = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=5 * PATIENCE,
    )
    assert process.returncode == 0, f"{line}\n{process.stdout}\n{process.stderr}"


@pytest.mark.slow
@pytest.mark.parametrize(("title", "text"), RECIPES, ids=[title for title, _ in RECIPES])
def test_recipe_works_as_documented(title: str, text: str, copy: Path) -> None:
    for language, _, name, content in BLOCK.findall(text):
        path = copy / name
        if language == "console":
            for line in content.splitlines():
                run(line, copy)
        elif language == "diff":
            path.write_text(edit(path.read_text("utf-8"), content), "utf-8")
        else:
            assert not path.exists(), f"{title}: {name} is there already"
            path.write_text(content, "utf-8")


def test_every_recipe_diff_applies_to_its_file_or_is_already_applied() -> None:
    for title, text in RECIPES:
        for language, _, name, content in BLOCK.findall(text):
            if language != "diff":
                continue
            # The repository holds the display of the first recipe already.
            code = (ROOT / name).read_text("utf-8")
            applied = "".join(line[1:] for line in content.splitlines(keepends=True) if line[0] != "-")
            assert applied in code or edit(code, content), f"{title}: {name}"


def test_every_recipe_exists_and_ends_with_a_test() -> None:
    titles = [title.removeprefix("Add a ") for title, _ in RECIPES]
    assert titles == ["display", "`ros2` verb", "check", "hint"]
    assert all("pytest" in BLOCK.findall(text)[-1][3] for _, text in RECIPES)


def test_every_link_and_file_of_the_page_exists() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", PAGE)
    in_rooms = re.findall(
        r"`((?:ros|recording|viewer|controls|displays|robots|sensors|tools|course|export|authoring|book|"
        r"grading|gateway|real|demo)/[\w/.-]+)`",
        PAGE,
    )
    missing = [link for link in links if not (ROOT / link).exists()]
    assert missing + [name for name in in_rooms if not (ROOT / "course_lib" / name).exists()] == []


def test_every_name_mentioned_in_a_room_readme_exists_in_the_code() -> None:
    kit = ROOT / "course_lib"
    code = [path for path in kit.rglob("*") if path.suffix in {".py", ".pyi", ".js", ".toml"}]
    code.append(ROOT / "tests" / "hostile" / "judging.py")
    known = set(re.findall(r"\w+", " ".join(path.read_text("utf-8") for path in code))) | ANY_NAME
    known |= {path.stem for path in (*kit.rglob("*"), *ROOT.glob("*.md"))}
    missing = [
        f"{page.parent.name}: {name}"
        for page in kit.rglob("README.md")
        for name in re.findall(r"`([A-Za-z]\w*(?:\.\w+)?)(?:\(.*?\))?`", page.read_text("utf-8"))
        if not set(name.split(".")) - {"md"} <= known
    ]
    assert missing == []
