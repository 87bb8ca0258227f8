import shutil
import subprocess
from pathlib import Path

import pytest

from course_lib.viewer import assets

FOLDER = Path(assets.__file__).parent / "js"
COMPILER = shutil.which("tsc")


@pytest.mark.skipif(COMPILER is None, reason="TypeScript's compiler tsc is not on the PATH")
def test_the_types_of_the_javascript_agree_and_nothing_in_it_is_unused() -> None:
    assert COMPILER is not None
    done = subprocess.run(
        [COMPILER, "-p", FOLDER / "jsconfig.json"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout
