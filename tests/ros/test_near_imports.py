"""Hints for misspelled modules, interfaces and attributes of modules."""

import sys
from pathlib import Path

import pytest

from course_lib.ros.hints import hint

# Code of a student, and the hint.
IMPORTS = [
    (
        "from geometry_msgs.msg import Tranform",
        "did you mean Transform? `from geometry_msgs.msg import Transform`",
    ),
    ("from geometry_msgs.msgs import Pose", "it is elsewhere: `from geometry_msgs.msg import Pose`."),
    ("from geometry_msgs.msgs import Posse", "did you mean `import geometry_msgs.msg`?"),
    ("from geometry_msgs import Pose", "write `from geometry_msgs.msg import Pose`."),
    ("from geometry_msgs import Posse", "did you mean Pose? `from geometry_msgs.msg import Pose`"),
    ("from geometry_msgs import msgs", "did you mean msg? `from geometry_msgs import msg`"),
    ("import geometry_msgs.mgs", "did you mean `import geometry_msgs.msg`?"),
    ("import geometry_msgs; geometry_msgs.mgs", "did you mean `msg`?"),
    ("import geometry_msgs.msg as g; g.Tranform()", "did you mean `Transform`?"),
    ("import std_msgs.msg.String", "write `from std_msgs.msg import String`."),
    ("import std_msgs.msg.Strin", "write `from std_msgs.msg import String`."),
    ("from geometry_msgs.msg import Marker", "it is elsewhere: `from visualization_msgs.msg import Marker`."),
    ("from geometry_msgs.msg import Path", "it is elsewhere: `from nav_msgs.msg import Path`."),
    (
        "from visualization_msgs.msg import Detection3DArry",
        "did you mean Detection3DArray? `from vision_msgs.msg import Detection3DArray`",
    ),
    ("from std_srvs.msg import Trigger", "it is elsewhere: `from std_srvs.srv import Trigger`."),
    ("import std_srvs.msg", "did you mean `import std_srvs.srv`?"),
    ("from std_srvs.srv import Triger", "did you mean Trigger? `from std_srvs.srv import Trigger`"),
    (
        "from example_interfaces.action import Fibonaci",
        "did you mean Fibonacci? `from example_interfaces.action import Fibonacci`",
    ),
    (
        "from geometry_msgs.msg import Wheelbarrow",
        "`%ros2 interface package geometry_msgs` lists what geometry_msgs has.",
    ),
    ("from rclpy.msg import Marker", "it is elsewhere: `from visualization_msgs.msg import Marker`."),
    ("from geometry_msgs.msg import Color", "did you mean ColorRGBA? `from std_msgs.msg import ColorRGBA`"),
    ("from rclpy.node import Nod", "did you mean Node? `from rclpy.node import Node`"),
    ("from rclpy.nod import Node", "did you mean `import rclpy.node`?"),
    ("import rclpi", "did you mean rclpy?"),
    ("import nunpy as np", "did you mean numpy?"),
    ("import maths", "did you mean math?"),
    ("from PIL import Imge", "did you mean Image? `from PIL import Image`"),
    ("import math; math.sqr(2.0)", "did you mean `sqrt`?"),
    ("import math; math.atan(1.0, 2.0)", "for two numbers, use `math.atan2(1.0, 2.0)`: y, then x."),
]


@pytest.mark.parametrize(("code", "expected"), IMPORTS)
def test_misspelled_import_has_a_hint(code: str, expected: str) -> None:
    with pytest.raises((ImportError, AttributeError, TypeError)) as raised:
        exec(compile(code, "cell", "exec"), {"__name__": "__main__"})
    assert hint(raised.value) == expected


@pytest.mark.parametrize("code", ["import scout", "from math import gear"])
def test_unknown_name_without_a_similar_one_has_no_hint(code: str) -> None:
    with pytest.raises(ImportError) as raised:
        exec(compile(code, "cell", "exec"), {"__name__": "__main__"})
    assert hint(raised.value) == ""


@pytest.mark.parametrize("file", ["this.py", "this/__init__.py"])
@pytest.mark.parametrize("code", ["from this import zen", "import this; this.zen", "import this.zen"])
def test_hint_states_the_file_that_hides_a_library_module(
    file: str, code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / file).parent.mkdir(exist_ok=True)
    (tmp_path / file).write_text("")
    monkeypatch.syspath_prepend(str(tmp_path))
    sys.modules.pop("this", None)
    with pytest.raises((ImportError, AttributeError)) as raised:
        exec(compile(code, "cell", "exec"), {"__name__": "__main__"})
    name = Path(file).parts[0]
    assert hint(raised.value) == f"your {name} hides the module this of Python or of a library: rename it."
    del sys.modules["this"]


def test_own_module_in_two_folders_does_not_hide_a_library(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for folder in ("new", "old"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "my_gripper.py").write_text("def opened(): pass")
        monkeypatch.syspath_prepend(str(tmp_path / folder))
    with pytest.raises(ImportError) as raised:
        exec("from my_gripper import open", {"__name__": "__main__"})
    assert hint(raised.value) == "did you mean opened? `from my_gripper import opened`"
    del sys.modules["my_gripper"]


def test_module_of_a_package_that_is_not_imported_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "arm_parts").mkdir()
    for name in ("__init__.py", "hand.py"):
        (tmp_path / "arm_parts" / name).write_text("")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(AttributeError) as raised:
        exec(compile("import arm_parts; arm_parts.hand", "cell", "exec"), {"__name__": "__main__"})
    assert hint(raised.value) == (
        "a module of a package is imported by its whole name: `import arm_parts.hand`."
    )


@pytest.mark.parametrize(
    ("module", "file", "expected"),
    [
        (
            "my_parts",
            "my_parts.py",
            "my_parts.py is in the folder my_course: move this file there, or copy it to here.",
        ),
        (
            "week07_parts",
            "",
            "week07_parts.py is next to its lesson: open the notebook there, or copy the file to here.",
        ),
    ],
)
def test_import_of_a_file_in_another_folder_has_a_hint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str, file: str, expected: str
) -> None:
    folder = tmp_path / "my_course/old"
    folder.mkdir(parents=True)
    if file:
        (folder.parent / file).write_text("")
    monkeypatch.chdir(folder)
    # Another test of this process may have imported the module.
    monkeypatch.delitem(sys.modules, module, raising=False)
    monkeypatch.setattr(sys, "path", [one for one in sys.path if not Path(one, f"{module}.py").exists()])
    with pytest.raises(ModuleNotFoundError) as raised:
        exec(f"import {module}", {})
    assert hint(raised.value) == expected
