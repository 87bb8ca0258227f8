"""Executables of ROS packages that the kit itself provides, for `ros2 run` and launch files."""

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.programs.xacro_program import run_xacro
from course_lib.ros.time import pace
from course_lib.third_party import read_text

if TYPE_CHECKING:
    from ipywidgets import GridBox
    from rclpy.executors import Executor
    from rclpy.node import Node

    from course_lib.displays.viewer import Viewer
    from course_lib.ros.programs.package_programs import Executables

# Robot time after which the first messages of all nodes have been received [s].
SETTLED = 1.0
_CONTAINERS = ("", "_mt", "_isolated")
_VIEWS = ("bag", "console", "graph", "plot", "reconfigure", "robot_monitor", "service_caller", "topic")


def _rviz2() -> None:
    """Show the layout after `-d` in the cell.

    Outside of notebooks, print how to view a recording.
    """
    arguments = program_arguments()
    layout = Path(arguments[arguments.index("-d") + 1]) if "-d" in arguments[:-1] else None
    if layout is not None and not layout.is_file():
        # RViz also starts without its layout, and the nodes of a launch go on.
        sys.stdout.write(f"[ERROR] [rviz2]: There is no layout {layout}. RViz starts with an empty one.\n")
        layout = None
    if current_graph().notebook:
        from rclpy.context import get_default_context
        from rclpy.impl import names

        from course_lib.displays.viewer import Viewer

        # The viewer is not created by rclpy, so its parameter is read from the command line here.
        ros_arguments = get_default_context().arguments
        renamed = (ros_arguments.remap_node("rviz2", *rule) for rule in (("__ns", "/"), ("__node", "rviz2")))
        parameter = ros_arguments.parameters(names.join(*renamed)).get("use_sim_time")
        sim = parameter is not None and parameter.value is True
        _display_viewer(Viewer.from_rviz(layout, use_sim_time=sim) if layout else Viewer(use_sim_time=sim))
    else:
        rviz = ""
        if layout is not None:
            from course_lib.displays.layout import read_layout

            read_layout(layout)
            rviz = f" --rviz {layout}"
        sys.stdout.write(
            "[rviz2]: There is no window here. Record the run with --bag DIR; then look at it with: "
            f"course view --bag DIR{rviz}\n"
        )
    spin()


def _display_viewer(viewer: "Viewer") -> None:
    """Show a viewer in the cell."""
    from IPython.display import display

    # IPython does not annotate this function.
    handle = display(viewer, display_id=True)
    # Without a page the first picture would show nothing, so it is updated later.
    if handle is not None and pace.mode() == "fast":
        # Sleeps in robot time.
        time.sleep(SETTLED)
        handle.update(viewer)


def _spin_class(module: str, name: str, *arguments: str | list[str]) -> None:
    """Import a node class, and spin an instance of it."""
    spin(getattr(import_module(module), name)(*arguments))


def _teleop(module: str, name: str) -> None:
    """Run a node that is controlled by keys, with buttons for the keys in a notebook cell."""
    node = getattr(import_module(module), name)()
    if current_graph().notebook and pace.mode() != "fast":
        from IPython.display import display

        display(key_buttons(node.press, node.KEYS))
    else:
        node.get_logger().info("There is no keyboard here; a cell in JupyterLab has buttons.")
    spin(node)


def key_buttons(press: Callable[[str], None], keys: Sequence[str]) -> "GridBox":
    """Return keys as buttons for a cell, three in a row. An empty name leaves a gap."""
    import ipywidgets

    buttons = []
    for key in keys:
        button = ipywidgets.Button(description=key.upper(), tooltip=f"The key {key.upper()}")
        button.layout.width, button.layout.visibility = "3.2em", "visible" if key else "hidden"
        button.on_click(lambda _, key=key: press(key))
        buttons.append(button)
    return ipywidgets.GridBox(buttons, layout={"grid_template_columns": "repeat(3, 3.6em)"})


def _turtlesim() -> None:
    """Run the simulator, with its picture in a notebook cell."""
    from course_lib.robots.turtlesim import TurtlesimNode

    node = TurtlesimNode()
    if current_graph().notebook:
        from course_lib.displays.turtle_view import TurtleView

        _display_viewer(TurtleView(node).viewer)
    else:
        say = "There is no window here; a notebook's cell has one: %ros2 run turtlesim turtlesim_node"
        node.get_logger().info(say)
    spin(node)


def _joint_state_publisher(*, sliders: bool = False) -> None:
    from course_lib.robots.state_publishers import JointStatePublisher, joint_sliders

    node = JointStatePublisher(_urdf_argument())
    if sliders and current_graph().notebook:
        from IPython.display import display

        display(joint_sliders(node))
    elif sliders:
        node.get_logger().info("Sliders need a notebook cell. The joints keep their initial positions.")
    spin(node)


def _urdf_argument() -> str:
    """Return the content of the URDF file given as the first argument (deprecated in ROS), or "".

    ROS ignores the argument if the parameter robot_description is set. In the launch file of ROS's
    tutorial both have the description itself.
    """
    argument = next(iter(program_arguments()), "")
    if not argument or "<" in argument:
        return argument
    return read_text(Path(argument))


def _xacro() -> int:
    """Print the result of xacro for a file."""
    result = run_xacro(program_arguments())
    sys.stderr.write(result.errors)
    sys.stdout.write(result.output)
    return result.code


def _unknown_robot() -> None:
    """Run the robot's nodes in several threads, so that none of them blocks another."""
    from rclpy.executors import MultiThreadedExecutor

    from course_lib.robots.unknown_robot import unknown_robot

    spin(*unknown_robot(), executor=MultiThreadedExecutor())


def _map_saver_cli() -> int:
    """Save the map of a topic to files, with the options of nav2's map_saver_cli.

    Returns:
        The exit code.
    """
    import rclpy

    from course_lib.robots.nav2 import FORMATS, MODES, MapSaver

    parser = argparse.ArgumentParser(prog="map_saver_cli", allow_abbrev=False)
    parser.add_argument("-t", dest="topic", default="map", metavar="MAP_TOPIC")
    parser.add_argument("-f", dest="name", default="", metavar="MAPNAME")
    parser.add_argument("--occ", dest="occupied_thresh", type=float, default=0.0)
    parser.add_argument("--free", dest="free_thresh", type=float, default=0.0)
    parser.add_argument("--fmt", dest="image_format", choices=FORMATS, default="")
    parser.add_argument("--mode", choices=MODES, default="trinary")
    options = vars(parser.parse_args(program_arguments()))
    rclpy.init()
    node, executor = MapSaver(), rclpy.get_global_executor()
    executor.add_node(node)
    task = executor.create_task(node.save(**options))
    executor.spin_until_future_complete(task)
    return 0 if task.done() and task.result() else 1


def _rqt(view: str) -> None:
    sys.stdout.write(f"[rqt_{view}]: Views need a notebook cell: %rqt {view}\n")
    spin()


def program_arguments() -> list[str]:
    """Return the running program's arguments before `--ros-args`."""
    arguments = sys.argv[1:]
    return arguments[: arguments.index("--ros-args")] if "--ros-args" in arguments else arguments


def spin(*nodes: "Node", executor: "Executor | None" = None) -> None:
    """Spin nodes until the run ends or is interrupted.

    Without an executor the global one is used. Without nodes it spins an empty executor.
    """
    import rclpy
    from rclpy.executors import ExternalShutdownException

    executor = executor or rclpy.get_global_executor()
    for node in nodes:
        executor.add_node(node)
    # The executables of ROS end in the same way.
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


def run_with_rclpy(work: Callable[[], None]) -> int:
    """Run an executable after `rclpy.init()`, and print an error as one line.

    Returns:
        The exit code.
    """
    import rclpy

    rclpy.init()
    # Another process of a launch may have replaced it when the error occurs.
    name = sys.argv[0]
    try:
        work()
    except (CourseError, OSError) as error:
        # The run has ended while the executable waited.
        if current_graph().ended:
            return 0
        sys.stderr.write(f"[ERROR] [{name}]: {error}\n")
        return 1
    return 0


_DEMO, _TURTLE = "course_lib.tools.demo_nodes", "course_lib.robots.turtlesim"
_FRAMES, _NAV2 = "course_lib.robots.turtlesim", "course_lib.robots.nav2"
# Each executable imports its modules when it runs, because few programs need all of them.
_NODES: dict[tuple[str, str], Callable[[], None]] = {
    ("rviz2", "rviz2"): _rviz2,
    ("diagnostic_aggregator", "aggregator_node"): partial(
        _spin_class, "diagnostic_aggregator.aggregator_node", "Aggregator"
    ),
    ("robot_state_publisher", "robot_state_publisher"): lambda: _spin_class(
        "course_lib.robots.state_publishers", "RobotStatePublisher", _urdf_argument()
    ),
    ("joint_state_publisher", "joint_state_publisher"): _joint_state_publisher,
    ("joint_state_publisher_gui", "joint_state_publisher_gui"): partial(_joint_state_publisher, sliders=True),
    ("turtlesim", "turtlesim_node"): _turtlesim,
    ("turtlesim", "turtle_teleop_key"): partial(_teleop, _TURTLE, "TurtleTeleop"),
    ("teleop_twist_keyboard", "teleop_twist_keyboard"): partial(_teleop, _DEMO, "TwistTeleop"),
    ("demo_nodes_py", "talker"): partial(_spin_class, _DEMO, "Talker"),
    ("demo_nodes_py", "listener"): partial(_spin_class, _DEMO, "Listener"),
    ("demo_nodes_py", "add_two_ints_server"): partial(_spin_class, _DEMO, "AddTwoIntsServer"),
    ("demo_nodes_py", "add_two_ints_client"): lambda: import_module(_DEMO).add_two_ints(),
    ("demo_nodes_cpp", "talker"): lambda: spin(import_module(_DEMO).Talker(is_cpp=True)),
    ("demo_nodes_cpp", "listener"): partial(_spin_class, _DEMO, "Listener"),
    ("demo_nodes_cpp", "add_two_ints_server"): partial(_spin_class, _DEMO, "AddTwoIntsServer"),
    ("demo_nodes_cpp", "add_two_ints_client"): lambda: import_module(_DEMO).add_two_ints(),
    ("demo_nodes_cpp", "parameter_blackboard"): partial(_spin_class, _DEMO, "ParameterBlackboard"),
    ("turtle_tf2_py", "turtle_tf2_broadcaster"): partial(_spin_class, _FRAMES, "TurtleBroadcaster"),
    ("turtle_tf2_py", "turtle_tf2_listener"): partial(_spin_class, _FRAMES, "TurtleFollower"),
    ("turtle_tf2_py", "fixed_frame_tf2_broadcaster"): partial(_spin_class, _FRAMES, "FixedFrameBroadcaster"),
    ("turtle_tf2_py", "dynamic_frame_tf2_broadcaster"): partial(
        _spin_class, _FRAMES, "DynamicFrameBroadcaster"
    ),
    ("turtle_tf2_py", "static_turtle_tf2_broadcaster"): lambda: _spin_class(
        _FRAMES, "StaticTurtleBroadcaster", program_arguments()
    ),
    ("turtlesim", "mimic"): partial(_spin_class, _TURTLE, "TurtleMimic"),
    ("turtlesim", "draw_square"): partial(_spin_class, _TURTLE, "DrawSquare"),
    ("nav2_map_server", "map_server"): partial(_spin_class, _NAV2, "MapServer"),
    ("nav2_map_server", "map_saver_server"): partial(_spin_class, _NAV2, "MapSaver"),
    ("nav2_lifecycle_manager", "lifecycle_manager"): partial(_spin_class, _NAV2, "LifecycleManager"),
    ("unknown_robot", "robot"): _unknown_robot,
    # The node of a container does nothing: the launch starts its components as separate processes.
    **{
        ("rclcpp_components", f"component_container{kind}"): partial(
            _spin_class, "rclpy.node", "Node", "ComponentManager"
        )
        for kind in _CONTAINERS
    },
    **{(f"rqt_{view}", f"rqt_{view}"): partial(_rqt, view) for view in _VIEWS},
}
NODE_EXECUTABLES: "Executables" = {
    **{name: partial(run_with_rclpy, work) for name, work in _NODES.items()},
    ("nav2_map_server", "map_saver_cli"): _map_saver_cli,
    ("xacro", "xacro"): _xacro,
}
