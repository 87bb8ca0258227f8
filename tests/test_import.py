import ast
import re
import subprocess
import sys
from importlib.metadata import packages_distributions, requires
from pathlib import Path

import pytest

from course_lib.ros.programs import import_path
from tests.patience import PATIENCE

COURSE_LIB = Path(__file__).parents[1] / "course_lib"
UNLISTED = {
    "pinocchio": ["pin"],  # this and coal are in a prefix that importlib does not list
    "coal": ["coal"],
    "cv2": ["opencv-python-headless"],  # of an extra that tests do without
}
HEAVY = (
    "rosbags",
    "pinocchio",
    "matplotlib",
    "IPython",
    "ipywidgets",
    "anywidget",
    "nbformat",
    "jupyterlab",
    "PIL",
)


def test_importing_the_kit_loads_no_heavy_modules() -> None:
    code = "import sys, course_lib; print(*sorted(sys.modules))"
    loaded = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        timeout=PATIENCE,
    ).stdout.split()
    assert not [name for name in HEAVY if name in loaded]


def test_start_of_a_program_does_not_import_the_metadata_of_packages(tmp_path: Path) -> None:
    (tmp_path / "node.py").write_text("import sys, rclpy.node, std_msgs.msg; print(*sys.modules)")
    loaded = subprocess.run(
        [sys.executable, "-m", "course_lib", "run", "node.py"],
        cwd=tmp_path, capture_output=True, text=True, check=True, timeout=PATIENCE,
    ).stdout.split()  # fmt: skip
    assert "course_lib.ros.programs.packages" in loaded
    assert not {"importlib.metadata", "email.message"} & set(loaded)


def test_checking_in_a_kernel_imports_neither_the_jail_nor_process_pools() -> None:
    code = (
        "import sys, course_lib; from course_lib.ros.programs import import_path; "
        "import_path.install(); import course_lib.grading.check; print(*sys.modules)"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=PATIENCE
    ).stdout.split()
    assert "course_lib.grading.judge" in loaded
    assert not [name for name in loaded if "grading.jail" in name or name == "multiprocessing"]


DASHBOARD = """
import sys
from tests.benchmarks.bench_dashboard import NODES, lesson
import rclpy
from course_lib import Viewer, spin_for
nodes = lesson()
rclpy.init()
viewer = Viewer(fixed_frame="world")
for display, topic in (("TF", None), ("Image", "/perception/image"), ("MarkerArray", "/perception/markers")):
    viewer.add(display, topic)
spin_for(0.5, *(nodes[name]() for name in NODES))
viewer._repr_mimebundle_()
print(*sorted(sys.modules))
"""
NOT_DRAWN_WITH = (
    "matplotlib", "trimesh", "collada", "scipy", "pinocchio", "coal", "meshcat", "example_robot_data",
    "xacro", "jedi", "nbformat", "jinja2", "jupyterlab", "rich", "typer", "dateparser", "zenoh",
    "lz4", "tornado", "psutil",
)  # fmt: skip


@pytest.mark.slow
def test_kernel_with_the_dashboard_of_week_seven_imports_only_the_required_modules() -> None:
    ran = subprocess.run(
        [sys.executable, "-c", DASHBOARD],
        capture_output=True,
        text=True,
        check=True,
        cwd=COURSE_LIB.parent,
        timeout=PATIENCE,
    )
    assert "course_lib.viewer.widget" in ran.stdout.split()
    assert not [name for name in NOT_DRAWN_WITH if name in ran.stdout.split()]


@pytest.mark.slow
def test_every_imported_distribution_is_declared() -> None:
    declared = {_name(line) for line in requires("course-lib") or []}
    provided = {
        "course_lib",
        "compression",
        *import_path.provided_packages(),
        *sys.stdlib_module_names,
    }  # 3.14 has it
    distributions = packages_distributions()
    missing = {
        f"{path.relative_to(COURSE_LIB)} imports {module}"
        for path in COURSE_LIB.rglob("*.py")
        for module in _imported(path) - provided
        if not declared
        & {_name(name) for name in [*distributions.get(module, []), *UNLISTED.get(module, [])]}
    }
    assert missing == set()


def _imported(path: Path) -> set[str]:
    """Return the top-level modules that a file imports anywhere, also lazily."""
    modules = set[str]()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            modules |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            modules.add(node.module.split(".")[0])
    return modules


def _name(requirement: str) -> str:
    """Return the normalised name of a requirement, "example-robot-data"."""
    return re.sub(r"[-_.]+", "-", re.match(r"[\w.-]+", requirement)[0]).lower()  # type: ignore[index]  # it always matches
