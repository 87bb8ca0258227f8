"""Hints for misspelled modules, interfaces and attributes of modules."""

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
    ("from rclpy.node import Nod", "did you mean Node? `from rclpy.node import Node`"),
    ("from rclpy.nod import Node", "did you mean `import rclpy.node`?"),
    ("import rclpi", "did you mean rclpy?"),
    ("import nunpy as np", "did you mean numpy?"),
    ("import maths", "did you mean math?"),
    ("from PIL import Imge", "did you mean Image? `from PIL import Image`"),
    ("import math; math.sqr(2.0)", "did you mean `sqrt`?"),
    ("import math; math.atan(1.0, 2.0)", "the function of two numbers is `math.atan2(1.0, 2.0)`: y, then x."),
]


@pytest.mark.parametrize(("code", "expected"), IMPORTS)
def test_misspelled_import_has_a_hint(code: str, expected: str) -> None:
    with pytest.raises((ImportError, AttributeError, TypeError)) as raised:
        exec(compile(code, "cell", "exec"), {"__name__": "__main__"})
    assert hint(raised.value) == expected


@pytest.mark.parametrize(
    "code", ["import scout", "from geometry_msgs.msg import Wheelbarrow", "from math import gear"]
)
def test_unknown_name_without_a_similar_one_has_no_hint(code: str) -> None:
    with pytest.raises(ImportError) as raised:
        exec(compile(code, "cell", "exec"), {"__name__": "__main__"})
    assert hint(raised.value) == ""
