import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import pytest

from course_lib.viewer import html
from tests.patience import PATIENCE

FOLDER = Path(html.__file__).parent / "js"
SCRIPTS = sorted(path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*.js"))
DECLARED = re.compile(r"^(?:export )?(?:async )?(?:const|let|function|class) (\w+|\[[^]]*\])", re.M)


@pytest.mark.parametrize("script", SCRIPTS)
def test_script_is_valid_javascript(script: str, tmp_path: Path) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("no Node.js on this machine")
    module = tmp_path / "script.mjs"
    module.write_text((FOLDER / script).read_text("utf-8"), "utf-8")
    process = subprocess.run(
        [node, "--check", str(module)], capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert process.returncode == 0, process.stderr


def test_scripts_of_the_bundle_declare_unique_names() -> None:
    texts = {name: (FOLDER / f"{name}.js").read_text("utf-8") for name in html._MODULES}
    # Several constants may be declared together, as an array.
    declared = Counter(
        name
        for text in texts.values()
        for names in DECLARED.findall(text)
        for name in re.findall(r"\w+", names)
    )
    assert [name for name, count in declared.items() if count > 1] == []
