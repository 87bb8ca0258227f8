"""Executables of ROS packages that the kit itself provides, for `ros2 run` and launch files."""

import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.ros import pace
from course_lib.ros.graph import current_graph
from course_lib.ros.xacro_program import run_xacro

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node

    from course_lib.displays.viewer import Viewer
    from course_lib.robots.teleop import TwistTeleop
    from course_lib.robots.turtlesim.programs import TurtleTeleop
    from course_lib.ros.package_programs import Executables

SETTLED = 1.0  # [s] of robot time after which the first messages of all nodes have arrived
_CONTAINERS = ("", "_mt", "_isolated")
_VIEWS = ("bag", "console", "graph", "plot", "reconfigure", "robot_monitor", "service_caller", "topic")


def _rviz2() -> None:
    """Show the layout behind `-d` in the cell; outside of notebooks, print how to look at a recording."""
    words = own_words()
    layout = Path(words[words.index("-d") + 1]) if "-d" in words[:-1] else None
    if current_graph().notebook:
        from course_lib.displays.viewer import Viewer

        sim = _uses_sim_time("rviz2")
        _show(Viewer.from_rviz(layout, use_sim_time=sim) if layout else Viewer(use_sim_time=sim))
    else:
        _print_how_to_look(layout)
    spin()


def _uses_sim_time(name: str) -> bool:
    """Return a node's parameter `use_sim_time` of the command line, for one that is not rclpy's."""
    from rclpy.context import get_default_context
    from rclpy.impl import names

    arguments = get_default_context().arguments
    namespace, name = (arguments.renamed(name, what, old) for what, old in (("__ns", "/"), ("__node", name)))
    given = arguments.parameters(names.join(namespace, name)).get("use_sim_time")
    return given is not None and given.value is True


def _show(viewer: "Viewer") -> None:
    """Show a viewer in the cell."""
    from IPython.display import display

    shown = display(viewer, display_id=True)  # type: ignore[no-untyped-call]  # untyped there
    if shown is not None and pace.wanted() == "fast":  # nobody watches the first picture
        time.sleep(SETTLED)  # of robot time
        shown.update(viewer)


def _print_how_to_look(layout: Path | None) -> None:
    rviz = ""
    if layout is not None:
        from course_lib.displays.layout import read_layout

        read_layout(layout)
        rviz = f" --rviz {layout}"
    sys.stdout.write(
        "[rviz2]: There is no window here. Record the run with --bag DIR; then look at it with: "
        f"course view --bag DIR{rviz}\n"
    )


def _turtlesim() -> None:
    """Run the simulator, with its picture in a notebook's cell."""
    from course_lib.robots.turtlesim.simulator import TurtlesimNode

    node = TurtlesimNode()
    if current_graph().notebook:
        from course_lib.displays.turtle_view import TurtleView

        _show(TurtleView(node).viewer)
    else:
        say = "There is no window here; a notebook's cell has one: %ros2 run turtlesim turtlesim_node"
        node.get_logger().info(say)
    spin(node)


def _turtle_program(name: str) -> None:
    from course_lib.robots.turtlesim import programs

    spin(getattr(programs, name)())


def _turtle_teleop() -> None:
    from course_lib.robots.turtlesim.programs import KEYS, TurtleTeleop

    _spin_with_keys(TurtleTeleop(), KEYS)


def _twist_teleop() -> None:
    from course_lib.robots.teleop import KEYS, TwistTeleop

    _spin_with_keys(TwistTeleop(), KEYS)


def _spin_with_keys(node: "TurtleTeleop | TwistTeleop", keys: Sequence[str]) -> None:
    """Run a node that is steered by keys, with its keys as buttons in a notebook's cell."""
    if current_graph().notebook and pace.wanted() != "fast":
        from IPython.display import display

        from course_lib.robots.teleop import key_buttons

        display(key_buttons(node.press, keys))  # type: ignore[no-untyped-call]  # untyped there
    else:
        node.get_logger().info("There is no keyboard here; a cell in JupyterLab has buttons.")
    spin(node)


def _demo_node(name: str) -> None:
    from course_lib.tools import demo_nodes

    spin(getattr(demo_nodes, name)())


def _add_two_ints() -> None:
    from course_lib.tools.demo_nodes import add_two_ints

    add_two_ints()


def _robot_state_publisher() -> None:
    from course_lib.robots.robot_state_publisher import RobotStatePublisher

    spin(RobotStatePublisher(_urdf_argument()))


def _joint_state_publisher(*, sliders: bool = False) -> None:
    from course_lib.robots.joint_state_publisher import JointStatePublisher, joint_sliders

    node = JointStatePublisher(_urdf_argument())
    if sliders and current_graph().notebook:
        from IPython.display import display

        display(joint_sliders(node))  # type: ignore[no-untyped-call]  # untyped there
    elif sliders:
        node.get_logger().info("There is no window for sliders here; the joints stay where they begin.")
    spin(node)


def _urdf_argument() -> str:
    """Return the text of the URDF file that is the first argument (deprecated in ROS), or ""."""
    files = own_words()
    return Path(files[0]).read_text(encoding="utf-8") if files else ""


def _xacro() -> int:
    """Print what xacro makes of a file."""
    done = run_xacro(own_words())
    sys.stderr.write(done.errors)
    sys.stdout.write(done.output)
    return done.code


def _component_container() -> None:
    """Run the node of a container; the launch starts its components as processes of their own."""
    from rclpy.node import Node

    spin(Node("ComponentManager"))


def _aggregator_node() -> None:
    from diagnostic_aggregator.aggregator_node import Aggregator

    spin(Aggregator())


def _unknown_robot() -> None:
    """Run the robot's nodes on several threads, so that none waits for another."""
    from rclpy.executors import MultiThreadedExecutor

    from course_lib.robots.unknown_robot import unknown_robot

    spin(*unknown_robot(), executor=MultiThreadedExecutor())


def _rqt(view: str) -> None:
    sys.stdout.write(f"[rqt_{view}]: There is no window here. In a notebook's cell: %rqt {view}\n")
    spin()


def own_words() -> list[str]:
    """Return the running program's arguments up to `--ros-args`."""
    words = sys.argv[1:]
    return words[: words.index("--ros-args")] if "--ros-args" in words else words


def spin(*nodes: "Node", executor: "Executor | None" = None) -> None:
    """Spin nodes, or none, until the run ends or is interrupted; without an executor by the global one."""
    import rclpy
    from rclpy.executors import ExternalShutdownException

    executor = executor or rclpy.get_global_executor()
    for node in nodes:
        executor.add_node(node)
    with suppress(KeyboardInterrupt, ExternalShutdownException):  # as ROS's own executables end
        executor.spin()


def with_rclpy(work: Callable[[], None]) -> int:
    """Run an executable between rclpy's start and its end; print an error as one line.

    Returns:
        The exit code.
    """
    import rclpy

    rclpy.init()
    try:
        work()
    except (CourseError, OSError) as error:
        if current_graph().ended:  # the run ended while it waited
            return 0
        sys.stderr.write(f"[ERROR] [{sys.argv[0]}]: {error}\n")
        return 1
    return 0


_NODES: dict[tuple[str, str], Callable[[], None]] = {
    ("rviz2", "rviz2"): _rviz2,
    ("diagnostic_aggregator", "aggregator_node"): _aggregator_node,
    ("robot_state_publisher", "robot_state_publisher"): _robot_state_publisher,
    ("joint_state_publisher", "joint_state_publisher"): _joint_state_publisher,
    ("joint_state_publisher_gui", "joint_state_publisher_gui"): partial(_joint_state_publisher, sliders=True),
    ("turtlesim", "turtlesim_node"): _turtlesim,
    ("turtlesim", "turtle_teleop_key"): _turtle_teleop,
    ("teleop_twist_keyboard", "teleop_twist_keyboard"): _twist_teleop,
    ("demo_nodes_py", "talker"): partial(_demo_node, "Talker"),
    ("demo_nodes_py", "listener"): partial(_demo_node, "Listener"),
    ("demo_nodes_py", "add_two_ints_server"): partial(_demo_node, "AddTwoIntsServer"),
    ("demo_nodes_py", "add_two_ints_client"): _add_two_ints,
    ("turtlesim", "mimic"): partial(_turtle_program, "TurtleMimic"),
    ("turtlesim", "draw_square"): partial(_turtle_program, "DrawSquare"),
    ("unknown_robot", "robot"): _unknown_robot,
    **{("rclcpp_components", f"component_container{kind}"): _component_container for kind in _CONTAINERS},
    **{(f"rqt_{view}", f"rqt_{view}"): partial(_rqt, view) for view in _VIEWS},
}
NODE_EXECUTABLES: "Executables" = {
    **{name: partial(with_rclpy, work) for name, work in _NODES.items()},
    ("xacro", "xacro"): _xacro,
}
