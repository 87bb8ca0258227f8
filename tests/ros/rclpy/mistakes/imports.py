"""Imports of what is elsewhere, or nowhere."""

# (program, the last line of what it says, the hint below it)
IMPORTS = [
    (
        "from std_msgs.msg import string",
        "ImportError: cannot import name 'string' from 'std_msgs.msg'",
        "%ros2 interface package std_msgs lists its types.",
    ),
    (
        "from example_interfaces.msg import WString",
        "ImportError: cannot import name 'WString' from 'example_interfaces.msg'",
        "the kit has no wide strings; String holds all characters, too.",
    ),
    (
        "from geometry_msgs import Twist",
        "ImportError: cannot import name 'Twist' from 'geometry_msgs'",
        "write from geometry_msgs.msg import Twist, or .srv, or .action.",
    ),
    (
        "from my_msgs.msg import Speed",
        "ModuleNotFoundError: No module named 'my_msgs'",
        "put the folder my_msgs with its msg beside the program.",
    ),
    (
        "import ros2",
        "ModuleNotFoundError: No module named 'ros2'",
        "",
    ),
]
