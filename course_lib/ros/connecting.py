"""A notebook's link to a robot: `connect` and `disconnect`."""

from collections.abc import Sequence

from course_lib.errors import CourseError, counted
from course_lib.ros.graph import Graph, current_graph, set_graph
from course_lib.ros.live import drive_between_cells, stop_all
from course_lib.ros.notices import say
from course_lib.ros.zenoh.connect import RobotAddress, link_to


def connect(
    router: str, *, domain: int | None = None, send: Sequence[str] = (), call: Sequence[str] = ()
) -> None:
    """Link this notebook to a robot that runs rmw_zenoh; without `send` and `call` it only listens.

    Args:
        router: The robot's router, like `tcp/192.168.1.5:7447`.
        domain: ROS_DOMAIN_ID; None takes the environment's, else 0.
        send: Topics that may go out, like `["/cmd_vel"]`.
        call: Services and actions that may be called.

    Raises:
        CourseError: Nodes or viewers exist already, the notebook is linked, or the robot cannot be reached.
    """
    graph = current_graph()
    if not graph.notebook:
        raise CourseError(
            "connect() is for notebooks; exercises are checked without a robot. For a program type: "
            f"course run my_node.py --robot {router}"
        )
    if graph.about_link():
        raise CourseError("This notebook is linked to a robot already. Type: %ros2 disconnect")
    if graph.nodes():
        names = ", ".join(node.full_name for node in graph.nodes())
        raise CourseError(f"There are nodes already ({names}): restart the kernel, and connect first.")
    if graph.is_tapped:
        raise CourseError(
            "There is a viewer or a recording already, which would not see the robot: restart the kernel, "
            "and connect first."
        )
    linked = link_to(RobotAddress(router, domain, send, call), notebook=True)
    set_graph(linked)
    drive_between_cells(linked)
    out = ", ".join(sorted([*send, *call])) or "nothing: read-only"
    say(f"Linked to {linked.link.address}: {counted(len(linked.nodes()), 'node')}. What may go out: {out}.")


def disconnect() -> None:
    """End the notebook's link: what it drove stops, its nodes have ended.

    Raises:
        CourseError: There is no link.
    """
    graph = current_graph()
    if not graph.about_link():
        raise CourseError("This notebook is not linked to a robot.")
    stop_all()
    set_graph(Graph(notebook=True))
    graph.close()
    say("The link is ended. Nodes and viewers of before have ended too: run their cells again.")
