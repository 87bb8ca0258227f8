"""The sdist and the wheel, as an index would get them."""

import csv
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import venv
import zipfile
from collections.abc import Iterable
from importlib.metadata import packages_distributions, requires
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.authoring.test_new_course import hand_in
from tests.checkout import ROOT, tracked
from tests.patience import PATIENCE
from tests.public_api import version

pytestmark = pytest.mark.slow
LARGEST_WHEEL = 2_400_000  # [B]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with an sdist, and the wheel that was built from it."""
    out = tmp_path_factory.mktemp("dist")
    build(out)
    return out


def build(out: Path, *which: str) -> None:
    # A copy, because hatchling packs all files in the folder, and parallel tests write there.
    copy = out.parent / f"{out.name}_source"
    for path in tracked():
        (copy / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / path, copy / path)
    command = [sys.executable, "-m", "build", "--no-isolation", *which, "--outdir", str(out), str(copy)]
    process = subprocess.run(command, capture_output=True, text=True, timeout=5 * PATIENCE)
    assert process.returncode == 0, process.stdout + process.stderr


def wheel(folder: Path) -> Path:
    (path,) = folder.glob("*.whl")
    return path


def test_sdist_and_wheel_pass_the_strict_twine_check(built: Path) -> None:
    command = [sys.executable, "-m", "twine", "check", "--strict", *map(str, built.iterdir())]
    process = subprocess.run(command, capture_output=True, text=True, timeout=5 * PATIENCE)
    assert process.returncode == 0, process.stdout
    assert len(list(built.iterdir())) == 2


def test_wheels_built_from_sdist_and_checkout_are_equal(built: Path, tmp_path: Path) -> None:
    build(tmp_path / "again", "--wheel")
    assert wheel(built).read_bytes() == wheel(tmp_path / "again").read_bytes()


BUILD = """
import sys
from pathlib import Path
before = set(sys.modules)
from course_lib.ros.messages.stubs import write_stubs
write_stubs(Path(sys.argv[1]))
print(*{name.partition(".")[0] for name in set(sys.modules) - before})
"""


def test_build_hook_imports_only_the_build_requirements(tmp_path: Path) -> None:
    command = [sys.executable, "-c", BUILD, str(tmp_path)]
    loaded = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, check=True, timeout=5 * PATIENCE
    ).stdout.split()
    assert list(tmp_path.rglob("__init__.pyi"))
    system = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["build-system"]
    distributions = packages_distributions()
    used = {canonicalize_name(name) for module in loaded for name in distributions.get(module, [])}
    assert used - installed_with(system["requires"]) == {"course-lib"}


def installed_with(names: Iterable[str]) -> set[str]:
    """Return the distributions that these requirements install."""
    found, waiting = set[str](), [Requirement(name) for name in names]
    while waiting:
        one = waiting.pop()
        name = canonicalize_name(one.name)
        if name not in found and (one.marker is None or one.marker.evaluate({"extra": ""})):
            found.add(name)
            waiting += map(Requirement, requires(name) or [])
    return found


def test_version_is_defined_once_and_matches_the_citation_file(built: Path) -> None:
    cited = yaml.safe_load((ROOT / "docs/CITATION.cff").read_text())
    assert wheel(built).name.startswith(f"course_lib-{version()}-")
    assert (cited["version"], cited["license"]) == (version(), "BSD-3-Clause")


def test_wheel_is_small_and_contains_no_answers(built: Path) -> None:
    assert wheel(built).stat().st_size <= LARGEST_WHEEL
    with zipfile.ZipFile(wheel(built)) as archive:
        tops = {name.split("/")[0] for name in archive.namelist()}
        assert {top.split("-")[0] for top in tops} == {"course_lib"}
        # Files outside the package: the extension that every JupyterLab of the environment loads,
        # and the settings of every Jupyter program.
        data = {name.partition(".data/data/")[2] for name in archive.namelist() if ".data/data/" in name}
        folder = "share/jupyter/labextensions/course-lib"
        extension = {f"{folder}/package.json", f"{folder}/static/remoteEntry.js"}
        assert data == {*extension, "etc/jupyter/jupyter_config.json"}
        assert not [
            name for name in archive.namelist() if "HIDDEN = {" in archive.read(name).decode(errors="replace")
        ]


@pytest.fixture(scope="module")
def home(built: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder outside the checkout, and in it an environment with the wheel."""
    home = tmp_path_factory.mktemp("home")
    venv.create(home / "venv", with_pip=False)
    # pip and the dependencies, which take a minute to download, come from this environment; not the
    # kit.
    packages = next((home / "venv" / "lib").glob("python*/site-packages"))
    (packages / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    install(home, "--ignore-installed", wheel(built))
    return home


def install(home: Path, *what: str | Path) -> None:
    run(home, "python", "-m", "pip", "install", "-q", "--no-deps", "--no-build-isolation", *what)


def run(home: Path, program: str, *words: str | Path) -> str:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    command = [str(home / "venv" / "bin" / program), *map(str, words)]
    process = subprocess.run(command, cwd=home, env=environment, capture_output=True, text=True, timeout=900)
    assert process.returncode == 0, process.stdout + process.stderr
    assert str(ROOT) not in process.stdout + process.stderr
    return process.stdout


def test_nbconvert_and_servers_of_an_environment_with_the_wheel_write_alternative_texts(
    home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    templates = Path(sysconfig.get_path("data"), "share/jupyter")  # of nbconvert
    monkeypatch.setenv("JUPYTER_PATH", str(templates))
    picture = {"data": {"image/png": "iVBORw=="}, "metadata": {"image/png": {"alt": "a red cube"}}}
    output = {"output_type": "display_data", **picture}
    cell = {"cell_type": "code", "id": "view", "source": "viewer", "execution_count": 1, "metadata": {}}
    notebook = {"cells": [cell | {"outputs": [output]}], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}
    (home / "view.ipynb").write_text(json.dumps(notebook))
    run(home, "python", "-m", "nbconvert", "--to", "html", "view.ipynb")
    assert '<img alt="a red cube" src="data:image/png' in (home / "view.html").read_text()
    # JupyterLab's menu exports with the settings of the server, such as one that a hub has started.
    server = "from jupyter_server.serverapp import ServerApp as App; app = App(); app.load_config_file()"
    exporter = run(home, "python", "-c", f"{server}; print(app.config.HTMLExporter)")
    assert "AlternativeTexts" in exporter


def test_installed_wheel_runs_the_demo_and_creates_a_student_folder(home: Path) -> None:
    assert run(home, "python", "-c", "import course_lib; print(course_lib.__file__)").startswith(str(home))
    run(home, "course", "demo")
    run(home, "course", "lab", "mine", "--no-server")
    assert (home / "mine" / "week01_exercise.ipynb").is_file()


def test_installed_wheel_grades_a_course_created_with_it(home: Path) -> None:
    run(home, "course", "new", "course", "Robotics 101")
    install(home, "-e", "robotics_101")
    hand_in(home / "robotics_101", home / "inbox" / "ada")
    run(home, "course", "grade", "inbox", "--out", "graded")
    (row,) = csv.DictReader((home / "graded" / "gradebook.csv").read_text().splitlines())
    assert (row["student"], row["score"], row["max_score"]) == ("ada", "100.0", "100.0")
