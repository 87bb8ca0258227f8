import shutil
import subprocess
from pathlib import Path

import pytest

from course_lib import controls
from course_lib.grading import marking
from course_lib.viewer import html
from tests.patience import PATIENCE
from tests.viewer import declarations

FOLDERS = (
    Path(html.__file__).parent / "js",
    Path(marking.__file__).parent / "page",
    Path(controls.__file__).parent,
)
COMPILER = shutil.which("tsc")


@pytest.mark.skipif(COMPILER is None, reason="TypeScript's compiler tsc is not on the PATH")
@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.parent.name)
def test_javascript_types_are_consistent_and_unused_code_is_absent(folder: Path) -> None:
    assert COMPILER is not None
    process = subprocess.run(
        [COMPILER, "-p", folder / "jsconfig.json"],
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    assert process.returncode == 0, process.stdout


def test_declared_message_types_match_the_dataclasses() -> None:
    assert declarations.PATH.read_text("utf-8") == declarations.declarations()
