"""A robot through RViz's displays in a browser's tab: `course view --robot`."""

import sys
from pathlib import Path

from course_lib.displays.viewer import Viewer
from course_lib.ros import virtual_time
from course_lib.ros.baton import baton
from course_lib.ros.graph import use_graph
from course_lib.ros.zenoh.connect import RobotAddress, link_to

STEP_NS = 10**8  # [ns]


def view_robot(
    robot: RobotAddress, rviz: Path | None, *, port: int = 0, token: str | None = None, browser: bool = True
) -> None:
    """Show a robot through a layout, or its frames without one, until Ctrl+C.

    `port` and `token` make the address: 0 lets the system choose a free port, None makes a secret part up.

    Raises:
        CourseError: If the robot cannot be reached, the layout not be read, or the port is taken.
    """
    graph = link_to(robot)
    virtual_time.install()
    try:
        with use_graph(graph):
            viewer = Viewer() if rviz is None else Viewer.from_rviz(rviz)
            if rviz is None:
                viewer.add("TF", show_names=True)
            viewer.open(browser=browser, port=port, token=token)
            sys.stdout.write("Ctrl+C ends it.\n")
            sys.stdout.flush()
            with baton.known():
                while True:
                    baton.sleep_until(graph.now_ns + STEP_NS, "Ctrl+C")
    except KeyboardInterrupt:
        sys.stdout.write("\nThe viewer has ended.\n")
    finally:
        graph.close()
