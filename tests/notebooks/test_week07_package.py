"""Week 7's notebooks as packages publish the same messages as the notebook's nodes."""

import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest

from course_lib.course.exercise import read_notebook, source
from course_lib.course.material import lessons_dir, solutions_dir
from course_lib.export.export import check_package, export
from tests.export.conftest import write_notebook
from tests.ros.launch.run import recorded

SECONDS = 3.0  # [s] of robot time
SOLUTION = (
    solutions_dir() / "week07_solution.ipynb",
    ("TfPublisher", "PathPlanner", "PerceptionNode", "TrajectoryNode"),
)
LESSON = (
    lessons_dir() / "week07_dashboard.ipynb",
    ("TfPublisher", "Overlay", "PerceptionNode", "PathPublisher"),
)
BOTH = pytest.mark.parametrize(("notebook", "nodes"), [SOLUTION, LESSON], ids=["solution", "lesson"])


def exported_cells(notebook: Path) -> list[str]:
    cells = [source(cell) for cell in read_notebook(notebook)["cells"] if cell["cell_type"] == "code"]
    return [cell for cell in cells if cell.startswith("# export\n")]


@BOTH
def test_launched_package_publishes_the_same_messages_as_the_notebook_nodes(
    notebook: Path, nodes: Sequence[str], tmp_path: Path
) -> None:
    node_calls = ", ".join(f"{node}()" for node in nodes)
    run = f"from course_lib import spin_for\nrclpy.init()\nspin_for({SECONDS}, {node_calls})"
    for module in notebook.parent.glob("week07*.py"):
        shutil.copy(module, tmp_path)
    file = write_notebook(tmp_path / "nodes.ipynb", ["%load_ext course_lib", *exported_cells(notebook), run])
    export(file, "my_dashboard", tmp_path / "src", nodes=nodes)
    package = tmp_path / "src" / "my_dashboard"
    in_notebook, code = recorded(file, seconds=None)
    launched, launch_code = recorded(package / "launch" / "my_dashboard.launch.py", seconds=SECONDS)
    assert (code, launch_code) == (0, 0)
    topics = {topic.name for topic in launched.topics()}
    assert {"/tf", "/perception/markers", "/planned_path", "/robot_trajectory"} <= topics
    assert launched.digest() == in_notebook.digest()
    assert check_package(package).missing == ()
