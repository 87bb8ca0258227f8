"""The executables of ROS packages that the kit provides itself, for launch files."""

import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.ros import pace
from course_lib.ros.graph import current_graph

SETTLED = 1.0  # [s] after which the first messages of all nodes have come
_NUMBERS = ("--x", "--y", "--z", "--yaw", "--pitch", "--roll")
_TOOLS = (("tf2_ros", "tf2_echo"), ("tf2_ros", "tf2_monitor"), ("tf2_tools", "view_frames"))
_VIEWS = ("bag", "console", "graph", "plot", "reconfigure", "robot_monitor", "service_caller", "topic")


def _rviz2() -> None:
    """Show the layout behind `-d`: in the cell, or where there is none, say how it can be looked at."""
    words = _own_words()
    layout = Path(words[words.index("-d") + 1]) if "-d" in words[:-1] else None
    if current_graph().notebook:
        from IPython.display import display

        from course_lib.displays.viewer import Viewer

        viewer = Viewer.from_rviz(layout) if layout else Viewer()
        shown = display(viewer, display_id=True)  # type: ignore[no-untyped-call]  # untyped there
        if shown is not None and pace.wanted() == "fast":  # nobody watches: what stays is not the beginning
            time.sleep(SETTLED)  # of robot time
            shown.update(viewer)
    else:
        _tell_how_to_look(layout)
    _spin()


def _tell_how_to_look(layout: Path | None) -> None:
    rviz = ""
    if layout is not None:
        from course_lib.displays.layout import read_layout

        read_layout(layout)
        rviz = f" --rviz {layout}"
    sys.stdout.write(
        "[rviz2]: There is no window here. Record the run with --bag DIR; then look at it with: "
        f"course view --bag DIR{rviz}\n"
    )


def _robot_state_publisher() -> None:
    from course_lib.robots.robot_state_publisher import RobotStatePublisher

    files = [Path(word) for word in _own_words()]  # the former way to give the robot
    _spin(RobotStatePublisher(files[0].read_text(encoding="utf-8") if files else ""))


def _joint_state_publisher(*, sliders: bool = False) -> None:
    from course_lib.robots.joint_state_publisher import JointStatePublisher, joint_sliders

    files = [Path(word) for word in _own_words()]
    node = JointStatePublisher(files[0].read_text(encoding="utf-8") if files else "")
    if sliders and current_graph().notebook:
        from IPython.display import display

        display(joint_sliders(node))  # type: ignore[no-untyped-call]  # untyped there
    elif sliders:
        node.get_logger().info("There is no window for sliders here; the joints stay where they begin.")
    _spin(node)


def _aggregator_node() -> None:
    from diagnostic_aggregator.aggregator_node import Aggregator

    _spin(Aggregator())


def _unknown_robot() -> None:
    """Run a robot whose nodes do not wait for each other, as if each were a process."""
    from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor

    from course_lib.robots.unknown_robot import unknown_robot

    executor = MultiThreadedExecutor()
    for node in unknown_robot():
        executor.add_node(node)
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


def _static_transform_publisher() -> None:
    from course_lib.tools.ros2 import ros2
    from course_lib.tools.sources import GraphSource

    words = _own_words()
    if len(words) == len(_NUMBERS) + 2 and "--frame-id" not in words:  # x y z yaw pitch roll frame child
        flags = [word for pair in zip(_NUMBERS, words, strict=False) for word in pair]
        words = [*flags, "--frame-id", words[-2], "--child-frame-id", words[-1]]
    words = [
        f"{flag}={value}" for flag, value in zip(words[::2], words[1::2], strict=True)
    ]  # -0.5 is no flag
    ros2(
        ["run", "tf2_ros", "static_transform_publisher", *words],
        GraphSource(current_graph()),
        sys.stdout.write,
    )
    _spin()


def _ros2(*words: str) -> None:
    from course_lib.tools.ros2 import ros2
    from course_lib.tools.sources import DISCOVERY, GraphSource

    ros2([*words, *_own_words()], GraphSource(current_graph(), discovery=DISCOVERY), sys.stdout.write)


def _rqt(view: str) -> None:
    """Say where it is: rqt's windows are in notebooks."""
    sys.stdout.write(f"[rqt_{view}]: There is no window here. In a notebook's cell: %rqt {view}\n")
    _spin()


def _own_words() -> list[str]:
    """Give the program's own words, before what is for ROS."""
    words = sys.argv[1:]
    return words[: words.index("--ros-args")] if "--ros-args" in words else words


def _spin(node: object = None) -> None:
    import rclpy
    from rclpy.executors import ExternalShutdownException

    executor = rclpy.get_global_executor()
    if node is not None:
        executor.add_node(node)  # type: ignore[arg-type]  # a node of the kit's own
    with suppress(KeyboardInterrupt, ExternalShutdownException):  # as ROS's own executables end
        executor.spin()


def _with_rclpy(work: Callable[[], None]) -> int:
    """Do the work of an executable; what is wrong with its arguments is said in one line."""
    import rclpy

    rclpy.init()
    try:
        work()
    except (CourseError, OSError) as error:
        if current_graph().ended:  # it was still waiting
            return 0
        sys.stderr.write(f"[ERROR] [{sys.argv[0]}]: {error}\n")
        return 1
    return 0


_WORK: dict[tuple[str, str], Callable[[], None]] = {
    ("ros2cli", "ros2"): _ros2,
    ("rviz2", "rviz2"): _rviz2,
    ("diagnostic_aggregator", "aggregator_node"): _aggregator_node,
    ("robot_state_publisher", "robot_state_publisher"): _robot_state_publisher,
    ("joint_state_publisher", "joint_state_publisher"): _joint_state_publisher,
    ("joint_state_publisher_gui", "joint_state_publisher_gui"): partial(_joint_state_publisher, sliders=True),
    ("tf2_ros", "static_transform_publisher"): _static_transform_publisher,
    **{words: partial(_ros2, "run", *words) for words in _TOOLS},
    ("unknown_robot", "robot"): _unknown_robot,
    **{(f"rqt_{view}", f"rqt_{view}"): partial(_rqt, view) for view in _VIEWS},
}
EXECUTABLES = {name: partial(_with_rclpy, work) for name, work in _WORK.items()}
