"""The sdist and the wheel, as an index would get them."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from tests.checkout import ROOT, tracked
from tests.public_api import version

pytestmark = pytest.mark.slow
LARGEST_WHEEL = 2 * 2**20  # [B]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with an sdist, and the wheel that was built from it."""
    out = tmp_path_factory.mktemp("dist")
    build(out)
    return out


def build(out: Path, *which: str) -> None:
    # A copy: hatchling takes what stands in the folder, and tests beside this one write there.
    copy = out.parent / f"{out.name}_source"
    for path in tracked():
        (copy / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / path, copy / path)
    command = [sys.executable, "-m", "build", "--no-isolation", *which, "--outdir", str(out), str(copy)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def wheel(folder: Path) -> Path:
    (path,) = folder.glob("*.whl")
    return path


def test_sdist_and_wheel_are_what_an_index_accepts(built: Path) -> None:
    command = [sys.executable, "-m", "twine", "check", "--strict", *map(str, built.iterdir())]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    assert len(list(built.iterdir())) == 2


def test_the_wheel_of_the_sdist_and_of_the_checkout_are_equal(built: Path, tmp_path: Path) -> None:
    build(tmp_path / "again", "--wheel")
    assert wheel(built).read_bytes() == wheel(tmp_path / "again").read_bytes()


def test_the_version_stands_in_one_place_and_the_citation_agrees(built: Path) -> None:
    cited = YAML(typ="safe").load(ROOT / "docs/CITATION.cff")
    assert wheel(built).name.startswith(f"course_lib-{version()}-")
    assert (cited["version"], cited["license"]) == (version(), "BSD-3-Clause")


def test_the_wheel_is_small_and_holds_no_answers(built: Path) -> None:
    assert wheel(built).stat().st_size <= LARGEST_WHEEL
    with zipfile.ZipFile(wheel(built)) as archive:
        tops = {name.split("/")[0] for name in archive.namelist()}
        assert {top.split("-")[0] for top in tops} == {"course_lib"}
        assert not [
            name for name in archive.namelist() if "HIDDEN = {" in archive.read(name).decode(errors="replace")
        ]


def test_the_installed_wheel_shows_the_demo(built: Path, tmp_path: Path) -> None:
    site = tmp_path / "site"
    install = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "-q",
        "--no-deps",
        "--target",
        str(site),
        str(wheel(built)),
    ]
    subprocess.run(install, check=True, capture_output=True)
    run = [sys.executable, "-m", "course_lib", "demo"]
    done = subprocess.run(
        run, cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(site)}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert str(site) not in done.stderr
