import shutil
import subprocess
from pathlib import Path

import pytest

from course_lib import controls
from course_lib.grading import marking
from course_lib.viewer import assets
from tests.viewer import declarations

FOLDERS = (
    Path(assets.__file__).parent / "js",
    Path(marking.__file__).parent / "page",
    Path(controls.__file__).parent,
)
COMPILER = shutil.which("tsc")


@pytest.mark.skipif(COMPILER is None, reason="TypeScript's compiler tsc is not on the PATH")
@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.parent.name)
def test_the_types_of_the_javascript_agree_and_nothing_in_it_is_unused(folder: Path) -> None:
    assert COMPILER is not None
    done = subprocess.run(
        [COMPILER, "-p", folder / "jsconfig.json"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout


def test_the_declarations_of_the_messages_are_those_of_the_dataclasses() -> None:
    assert declarations.PATH.read_text("utf-8") == declarations.declarations()
