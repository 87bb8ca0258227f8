import subprocess
import sys

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


def test_importing_the_kit_loads_nothing_heavy() -> None:
    code = "import sys, course_lib; print(*sorted(sys.modules))"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert not [name for name in HEAVY if name in loaded]
