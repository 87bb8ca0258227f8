import ast
import errno
import json
import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.export.export import check_package, export
from course_lib.recording import Recording
from course_lib.ros.programs.build_files import executables_of
from tests.export.conftest import write_notebook
from tests.ros.launch.run import recorded

NODE = "from rclpy.node import Node"
TALKER = "class Talker(Node):\n    def __init__(self):\n        super().__init__('talker')\n"


def test_maintainer_without_a_login_name_is_the_number_of_the_user(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Users of some containers and hubs are not in the machine's list of users."""

    def fail() -> str:
        raise KeyError("getpwuid(): uid not found")

    monkeypatch.setattr("getpass.getuser", fail)
    file = tmp_path / "talker.py"
    file.write_text(f"{NODE}\n{TALKER}")
    export(file, "talk", tmp_path / "src")
    assert re.search(r"user\d+@todo.todo", (tmp_path / "src/talk/package.xml").read_text())


def test_package_has_the_documented_structure(package: Path) -> None:
    files = {str(path.relative_to(package)) for path in package.rglob("*") if path.is_file()}
    assert files >= {
        *("package.xml", "setup.py", "setup.cfg", "README.md", "resource/perception_dashboard"),
        *(f"perception_dashboard/{name}.py" for name in ("__init__", "perception_node", "tf_publisher")),
        *("launch/perception_dashboard.launch.py", "config/perception_dashboard.yaml"),
        *("rviz/perception_dashboard.rviz", "test/test_copyright.py", "test/test_sensor_publisher.py"),
    }
    assert check_package(package).missing == ()


def test_notebook_and_launched_package_publish_equal_messages(notebook: Path, package: Path) -> None:
    launch = package / "launch" / "perception_dashboard.launch.py"
    in_notebook, code = recorded(notebook, seconds=None)
    launched, launch_code = recorded(launch, seconds=5.0)
    assert (code, launch_code) == (0, 0)
    assert len(launched.samples) > 200
    assert launched.digest() == in_notebook.digest()


def test_parameters_of_the_config_file_are_used(package: Path) -> None:
    config = package / "config" / "perception_dashboard.yaml"
    before = config.read_text()
    config.write_text(before.replace("10.0", "2.0"))
    try:
        launched, _ = recorded(package / "launch" / "perception_dashboard.launch.py", seconds=2.0)
    finally:
        config.write_text(before)
    assert count(launched, "/perception/markers") == 4


def count(recording: Recording, topic: str) -> int:
    return sum(sample.topic == topic for sample in recording.samples)


def test_module_contains_exactly_the_statements_its_class_needs(package: Path) -> None:
    text = (package / "perception_dashboard" / "perception_node.py").read_text()
    assert "# colours of classes, RGBA\nCOLORS = " in text
    assert "COLORS['car'] = " in text
    for name in ("UNUSED", "TransformStamped", "spin_for", "TFPublisher"):
        assert name not in text
    assert ast.get_docstring(ast.parse(text)) == "Publishes boxes."


def test_every_executable_is_a_function_of_a_module(package: Path) -> None:
    executables = executables_of(package / "setup.py")
    assert set(executables) == {"perception_node", "tf_publisher", "sensor_publisher"}
    for module, function in executables.values():
        tree = ast.parse((package / f"{module.replace('.', '/')}.py").read_text())
        assert function in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


def test_existing_files_are_not_overwritten_without_force(tmp_path: Path) -> None:
    file = write_notebook(tmp_path / "n.ipynb", [NODE, TALKER])
    export(file, "my_package", tmp_path)
    own = tmp_path / "my_package" / "notes.txt"
    own.write_text("mine")
    (tmp_path / "my_package" / "setup.py").write_text("changed")
    with pytest.raises(CourseError, match="--force"):
        export(file, "my_package", tmp_path)
    assert (tmp_path / "my_package" / "setup.py").read_text() == "changed"
    export(file, "my_package", tmp_path, force=True)
    assert "my_package" in (tmp_path / "my_package" / "setup.py").read_text()
    assert own.read_text() == "mine"
    assert {path.name for path in tmp_path.iterdir()} == {"n.ipynb", "my_package"}


def test_class_in_a_cell_that_lost_its_mark_is_reported(tmp_path: Path) -> None:
    marked = "# export\n" + NODE.replace("Talker", "Other")
    file = write_notebook(tmp_path / "n.ipynb", [marked, TALKER])
    with pytest.raises(CourseError, match="Cell 2 defines Talker: write # export into its first line"):
        export(file, "my_package", tmp_path, nodes=["Talker"])


@pytest.mark.parametrize("name", ["My-Package", "2fast", "a", "x__y", "rclpy", "test", "ünder", "a_", ""])
def test_package_name_violating_rep_144_is_rejected(tmp_path: Path, name: str) -> None:
    file = write_notebook(tmp_path / "n.ipynb", [NODE, TALKER])
    with pytest.raises(CourseError):
        export(file, name, tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        (("# export\n" + NODE, "def helper(): ...", "# export\n" + TALKER + "        helper()"), "cell 2"),
        ((NODE, TALKER + "        helper()"), "which is not defined"),
        ((NODE, "from course_lib import spin_for", TALKER + "        spin_for(1)"), "course_lib"),
        ((NODE, TALKER.replace("self", "self, rate", 1)), "Talker\\(\\) needs rate"),
        ((NODE, "class Talker:\n    pass"), "derives from rclpy's Node"),
        ((NODE, "class Talker(Node)\n    pass"), "Cell 2, line 1"),
        ((NODE, TALKER, TALKER.replace("Talker", "talker")), "2 classes would become the module talker.py"),
    ],
)
def test_errors_are_reported_before_files_are_written(
    tmp_path: Path, cells: tuple[str, ...], message: str
) -> None:
    file = write_notebook(tmp_path / "n.ipynb", cells)
    with pytest.raises(CourseError, match=message):
        export(file, "my_package", tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("cells", "there"),
    [
        (("A = 1\nB = A + 1\nA = 5", TALKER + "        print(A, B)"), "A = 1\nB = A + 1\nA = 5"),
        (("def f():\n    return g()\n\n\ndef g():\n    return 1", TALKER + "        f()"), "def g():"),
        (("import numpy as np, math", TALKER + "        print(np.pi)"), "import numpy as np"),
        (("X = [n for n in range(3)]", TALKER + "        print(X)"), "X = [n for n in range(3)]"),
        (("n = 3", "X = {k: n for k in range(3)}", TALKER + "        print(X)"), "n = 3"),
        (("X = {k: n for n in range(3) for k in range(n)}", TALKER + "        print(X)"), "X = {k: n for n"),
        (("X = {(lambda: n)() for n in range(3)}", TALKER + "        print(X)"), "X = {(lambda: n)()"),
        (("A = [1]\nA += [2]\nA = A + [3]", TALKER + "        print(A)"), "A = [1]\nA += [2]\nA = A + [3]"),
        (("try:\n    import a\nexcept ImportError:\n    a = None", TALKER + "        print(a)"), "a = None"),
        (("class Base(Node):\n    pass", TALKER.replace("(Node)", "(Base)")), "class Base(Node):"),
        (("x = 1; y = 2", TALKER + "        print(y)"), "\ny = 2"),
        (("from math import *", TALKER + "        print(sin(1))"), "from math import *"),
        ((TALKER + "        print(0)", TALKER + "        print(1)"), "print(1)"),
        (("%matplotlib inline\nRATE = 2", TALKER + "        print(RATE)"), "RATE = 2"),
    ],
)
def test_names_are_resolved_by_python_scoping_rules(
    exported: Callable[..., str], cells: tuple[str, str], there: str
) -> None:
    text = exported(NODE, *cells)
    assert there in text
    assert "get_ipython" not in text


def test_code_of_a_module_next_to_the_notebook_is_copied(
    exported: Callable[..., str], tmp_path: Path
) -> None:
    (tmp_path / "parts.py").write_text("import math\n\nRATE = 2.0\n\n\ndef f():\n    return math.pi\n")
    text = exported(
        "# export\n" + NODE,
        "# export\nfrom parts import (\n    f,\n)\n",
        "# export\n" + TALKER + "        f()",
    )
    assert "def f():" in text
    assert "import math" in text
    assert not [word for word in ("from parts", "RATE") if word in text]


def test_strings_use_the_quotes_required_by_ros_linters(exported: Callable[..., str]) -> None:
    kept = ['"it\'s"', '"a\\tb"', '"""doc"""', "'single'"]
    text = exported(NODE, f'A = [\'a\', "b", r"c", "", {", ".join(kept)}]', TALKER + "        print(A)")
    assert f"A = ['a', 'b', r'c', '', {', '.join(kept)}]" in text


def test_existing_main_function_is_kept(tmp_path: Path) -> None:
    file = tmp_path / "talker.py"
    main = "def main():\n    rclpy.init()\n    rclpy.spin(Talker())\n"
    file.write_text(
        f"import rclpy\n{NODE}\n\n\n{TALKER}\n\n{main}\n\nif __name__ == '__main__':\n    main()\n"
    )
    export(file, "my_package", tmp_path)
    text = (tmp_path / "my_package" / "my_package" / "talker.py").read_text()
    assert text.count("def main(") == 1
    assert "rclpy.spin(Talker())" in text


def test_additional_files_replace_generated_ones(tmp_path: Path) -> None:
    file = write_notebook(tmp_path / "n.ipynb", [NODE, TALKER])
    (tmp_path / "mine.rviz").write_text("Panels: []\n")
    export(file, "my_package", tmp_path, extra=[tmp_path / "mine.rviz"])
    assert [path.name for path in (tmp_path / "my_package" / "rviz").iterdir()] == ["mine.rviz"]
    assert "'mine.rviz'" in (tmp_path / "my_package" / "launch" / "my_package.launch.py").read_text()


BASE = "class Base(Node):\n    def __init__(self, name):\n        super().__init__(name)\n"
HEIR = "class Heir(Base):\n    def __init__(self):\n        super().__init__('heir')\n"


@pytest.mark.parametrize(
    ("cells", "executables", "note"),
    [
        ((BASE, HEIR), {"heir"}, r"Base is .*base of Heir\. Its code is in heir\.py\."),
        ((TALKER, TALKER.replace("Talker(Node)", "Loud(Talker)")), {"loud"}, "Talker is .*base of Loud"),
        ((TALKER, BASE), {"talker"}, r"Base is .*needs name\. Its code is in base\.py\."),
        (
            (TALKER + "        Base('b')", BASE),
            {"talker"},
            r"Base is .*needs name\. Its code is in talker\.py",
        ),
        ((BASE, HEIR, "class Third(Base):\n    pass"), {"heir"}, "Third is .*needs name"),
        (
            (TALKER, "class Shape(Node):\n    @abstractmethod\n    def draw(self): ...", "from abc import *"),
            {"talker"},
            "Shape is .*leaves draw abstract",
        ),
    ],
)
def test_class_that_is_not_startable_is_exported_without_executable(
    tmp_path: Path, cells: tuple[str, ...], executables: set[str], note: str
) -> None:
    file = write_notebook(tmp_path / "n.ipynb", [NODE, *cells])
    written = export(file, "my_package", tmp_path)
    assert set(executables_of(tmp_path / "my_package" / "setup.py")) == executables
    assert any(re.match(note, line) for line in written.notes), written.notes
    assert check_package(tmp_path / "my_package").missing == ()
    tests = {path.name for path in (tmp_path / "my_package" / "test").glob("test_*.py")}
    assert {f"test_{name}.py" for name in executables} == tests - {
        "test_copyright.py", "test_flake8.py", "test_pep257.py"
    }  # fmt: skip


def test_export_of_the_notebook_from_which_the_running_one_was_copied_has_a_note(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = write_notebook(tmp_path / "n.ipynb", [NODE, TALKER])
    content = json.loads(file.read_text())
    for cell in content["cells"]:
        cell["id"] = f"cell-{len(cell['source'])}"
    file.write_text(json.dumps(content))
    copy = tmp_path / "n-Copy1.ipynb"
    copy.write_text(json.dumps(content))
    for running, notes in ((file, ()), (copy, ("n.ipynb", "This notebook is n-Copy1.ipynb"))):
        monkeypatch.setenv("JPY_SESSION_NAME", str(running))
        written = export(file, "my_package", tmp_path, force=True)
        printed = capsys.readouterr().out
        assert len(written.notes) == bool(notes)
        assert all(note in printed for note in notes)


def test_requested_base_class_becomes_an_executable(tmp_path: Path) -> None:
    file = write_notebook(
        tmp_path / "n.ipynb", [NODE, TALKER, TALKER.replace("Talker(Node)", "Loud(Talker)")]
    )
    written = export(file, "my_package", tmp_path, nodes=["Talker", "Loud"])
    assert set(executables_of(tmp_path / "my_package" / "setup.py")) == {"talker", "loud"}
    assert written.notes == ()


def test_full_disk_is_reported_with_the_package_and_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    notebook = write_notebook(tmp_path / "n.ipynb", [NODE, TALKER])

    def fill(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", fill)
    with pytest.raises(OSError, match="No space left") as refusal:
        export(notebook, "arm", tmp_path / "out")
    assert refusal.value.filename == str(tmp_path / "out" / "arm")
    assert not (tmp_path / "out").exists()
