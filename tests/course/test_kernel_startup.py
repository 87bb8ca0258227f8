"""What a cell says that is run before the first one, in a kernel as `course lab` starts them."""

from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

from course_lib.course.lab import KERNEL_STARTUP
from tests.patience import PATIENCE

HINT = "hint: run the cells above first, beginning with the first one, %load_ext course_lib "
CELLS = [
    'check("week06.camera", 3)',
    "%ros2 topic list",
    "resume()",
    "import math\nfrom rclpy.node import Node",
    "import no_such_module",
    "from course_lib import run_live\nrun_live(3)",
    "%load_ext course_lib",
    "Viewr()",
    "from course_lib import check\ncheck()",
    "sorted(dir())",
]


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """What each cell shows, in one kernel."""
    new: Any = nbformat.v4  # has no types
    notebook = new.new_notebook(cells=[new.new_code_cell(cell) for cell in CELLS])
    folder = tmp_path_factory.mktemp("kernel")
    client = NotebookClient(
        notebook, timeout=PATIENCE, allow_errors=True, resources={"metadata": {"path": str(folder)}}
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONSTARTUP", str(KERNEL_STARTUP))
        # Launch files that an earlier test ran in this process have put the stand-in on it.
        patch.delenv("PYTHONPATH", raising=False)
        client.execute()
    return [
        "".join(
            "\n".join(one.get("traceback", ())) + one.get("text", "") + str(one.get("data", ""))
            for one in cell.outputs
        )
        for cell in notebook.cells
    ]


def test_check_before_the_first_cell_has_a_hint(shown: list[str]) -> None:
    assert "name 'check' is not defined" in shown[0]
    assert HINT in shown[0]
    assert "from course_lib import resume; resume()" in shown[0]


def test_magic_before_the_first_cell_has_a_hint(shown: list[str]) -> None:
    assert "Line magic function `%ros2` not found." in shown[1]
    assert HINT in shown[1]


def test_missing_import_of_resume_is_reported_with_the_import_line(shown: list[str]) -> None:
    assert "hint: write `from course_lib import resume` above it and run this cell again." in shown[2]


def test_error_of_the_kit_before_the_first_cell_is_one_line(shown: list[str]) -> None:
    assert shown[5].startswith("CourseError: 3 is not a node. ")
    assert len(shown[5].splitlines()) == 1


def test_import_of_ros_before_the_first_cell_has_a_hint_and_other_imports_have_none(shown: list[str]) -> None:
    assert "No module named 'rclpy'" in shown[3]
    assert HINT in shown[3]
    assert "No module named 'no_such_module'" in shown[4]
    assert HINT not in shown[4]


def test_kit_that_is_loaded_replaces_the_hint(shown: list[str]) -> None:
    assert HINT not in shown[7]


def test_check_without_arguments_has_an_example(shown: list[str]) -> None:
    assert 'hint: pass the name of the task and your object, as in check("week01.red_cube"' in shown[8]


def test_startup_leaves_no_names(shown: list[str]) -> None:
    assert "early" not in shown[9]


def test_plain_python_runs_the_file_without_effect() -> None:
    names = {"__name__": "__main__"}
    exec(Path(KERNEL_STARTUP).read_text(encoding="utf-8"), names)
    assert set(names) == {"__name__", "__doc__", "__builtins__"}
