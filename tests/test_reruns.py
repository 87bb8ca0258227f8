import os
import subprocess
import sys
from pathlib import Path

from tests.checkout import ROOT
from tests.patience import PATIENCE

# Each fixture returns how often it was set up before; the test fails once and changes its page.
FILE = """
import pytest
from collections import Counter

made, ended = Counter(), []

def make(name, failing=False):
    made[name] += 1
    yield [name, made[name]]
    ended.append(name)
    if failing:
        raise RuntimeError("the page does not answer")

@pytest.fixture(scope="session")
def results():
    yield from make("results")

@pytest.fixture(scope="package")
def lab():
    yield from make("lab")

@pytest.fixture(scope="module")
def page(lab):
    yield from make("page", failing=made["page"] == 0)

@pytest.fixture(scope="module")
def other():
    yield from make("other")

def test_before(other):
    pass

def test_panel(results, lab, page):
    page.append("panel")
    assert made["page"] == 2, "the first attempt"
    assert (results, lab, page) == (["results", 1], ["lab", 2], ["page", 2, "panel"])
    assert ended == ["page", "lab"]

def test_after(lab, page, other):
    assert (lab, page, other) == (["lab", 2], ["page", 2, "panel"], ["other", 1])
"""


def test_repeated_test_gets_new_fixtures_of_its_file_and_package(tmp_path: Path) -> None:
    (tmp_path / "pytest.ini").write_text("[pytest]\n")
    (tmp_path / "test_page.py").write_text(FILE)
    plugins = ("-p", "pytest_rerunfailures", "-p", "tests.reruns")
    command = [sys.executable, "-m", "pytest", *plugins, "--reruns", "1", "-rR", str(tmp_path)]
    process = subprocess.run(
        command,
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert process.returncode == 0, process.stdout
    assert "3 passed, 1 rerun" in process.stdout
