"""Imports of names that do not exist or are in another module."""

# (program, last line of the error, hint below it)
IMPORTS = [
    (
        "from std_msgs.msg import string",
        "ImportError: cannot import name 'string' from 'std_msgs.msg'",
        "did you mean String? `from std_msgs.msg import String`",
    ),
    (
        "from example_interfaces.msg import WString",
        "ImportError: cannot import name 'WString' from 'example_interfaces.msg'",
        "the kit has no wide strings; String supports all characters, too.",
    ),
    (
        "from geometry_msgs import Twist",
        "ImportError: cannot import name 'Twist' from 'geometry_msgs'",
        "write `from geometry_msgs.msg import Twist`.",
    ),
    (
        "from my_msgs.msg import Speed",
        "ModuleNotFoundError: No module named 'my_msgs'",
        "put the folder my_msgs with its msg next to the program.",
    ),
    *(
        (
            f"import rclpy\n{line}",
            f"ModuleNotFoundError: No module named '{package}'",
            f"put the folder {package} with its {kind} beside the program, or into the workspace's src.",
        )
        for line, package, kind in (
            ("from neato2_interfaces.msg import Bump", "neato2_interfaces", "msg"),
            ("from my_robot_srvs.srv import Go", "my_robot_srvs", "srv"),
            ("from my_actions.action import (\n    Dock,\n)", "my_actions", "action"),
            ("import my_interfaces.msg", "my_interfaces", "msg"),
            ("import my_interfaces.srv as srv", "my_interfaces", "srv"),
        )
    ),
    (
        "import ros2",
        "ModuleNotFoundError: No module named 'ros2'",
        "there is no module ros2 in ROS 2: its library for Python is `import rclpy`.",
    ),
    *(
        (line, f"{kind}: {said}", hint)
        for line, kind, said, hint in (
            (
                "from visualization_msg.msg import Marker",
                "ModuleNotFoundError",
                "No module named 'visualization_msg'",
                "did you mean visualization_msgs?",
            ),
            (
                "import rospy",
                "ModuleNotFoundError",
                "No module named 'rospy'",
                "there is no module rospy in ROS 2: its library for Python is `import rclpy`.",
            ),
            (
                "import tf",
                "ModuleNotFoundError",
                "No module named 'tf'",
                "there is no module tf in ROS 2: write `import tf2_ros`, and for angles "
                "`import tf_transformations`.",
            ),
            (
                "from rclpy.nod import Node",
                "ModuleNotFoundError",
                "No module named 'rclpy.nod'",
                "did you mean `import rclpy.node`?",
            ),
            (
                "from lunch import LaunchDescription",
                "ModuleNotFoundError",
                "No module named 'lunch'",
                "did you mean launch?",
            ),
            (
                "from visualization_msgs.msg import Markr",
                "ImportError",
                "cannot import name 'Markr' from 'visualization_msgs.msg'",
                "did you mean Marker? `from visualization_msgs.msg import Marker`",
            ),
            (
                "from course_lib import run_liv",
                "ImportError",
                "cannot import name 'run_liv' from 'course_lib'",
                "did you mean run_live? `from course_lib import run_live`",
            ),
            (
                "from rclpy import Node",
                "ImportError",
                "cannot import name 'Node' from 'rclpy'",
                "it is elsewhere: `from rclpy.node import Node`.",
            ),
        )
    ),
    (
        "from tf.transformations import quaternion_from_euler",
        "ModuleNotFoundError: No module named 'tf'",
        "there is no module tf in ROS 2: write `import tf2_ros`, and for angles `import tf_transformations`.",
    ),
]
