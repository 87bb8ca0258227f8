"""How tools ask services and actions: with a node of their own."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.driving import running_nodes
from course_lib.ros.messages.definitions import type_names
from course_lib.tools.sources import NODE_NAME, Source

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.task import Future


@contextmanager
def own_node(source: Source, name: str = NODE_NAME) -> "Iterator[Node]":
    """Give a node for a while, which runs with those that run live.

    Raises:
        CourseError: There are no nodes to ask.
    """
    if not source.live:
        raise CourseError("A recording gives no answers. Ask nodes that run: course ros2 --run program.py …")
    source.wait(lambda: True, 0.0)  # says if rclpy is not started
    from rclpy.node import Node

    node = Node(name, start_parameter_services=False, enable_rosout=False)
    running_nodes().append(node)
    try:
        yield node
    finally:
        running_nodes().remove(node)
        node.destroy_node()


def answer(source: Source, future: "Future[Any]", who: str, patience: float | None) -> Any:
    """Wait for what a future brings, [s]; raises a CourseError if it does not come."""
    if not source.wait(future.done, patience):
        raise CourseError(f"{who} does not answer: is it running? Start it, like run_live(node).")
    return future.result()


def kind_of(find: Any, type_name: str, folder: str) -> Any:
    """Find a message's, a service's or an action's class; as in ROS its name may go without the folder."""
    package, *rest = type_name.split("/")
    whole = "/".join([package, folder, *rest] if len(rest) == 1 else [package, *rest])
    try:
        return find(whole)
    except CourseError as error:
        if folder == "msg":  # the error has ROS's words already
            raise
        word, end = {"srv": ("service", "_Request"), "action": ("action", "_Goal")}[folder]
        there = [
            name.removesuffix(end) for name in type_names() if f"/{folder}/" in name and name.endswith(end)
        ]
        if whole in there:
            raise
        message = f"The passed {word} type is invalid: {whole}{did_you_mean(whole, there)}"
        raise CourseError(message) from error


def check_type(name: str, type_name: str, there: Mapping[str, Sequence[str]]) -> None:
    """Raise a CourseError if what goes by a name is of another type: waiting for it would have no end."""
    if name in there and type_name not in there[name]:
        raise CourseError(f"{name} has the type {', '.join(there[name])}, not {type_name}.")
