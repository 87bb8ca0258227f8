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
    robot: RobotAddress,
    rviz: Path | None,
    *,
    port: int = 0,
    token: str | None = None,
    browser: bool = True,
    use_sim_time: bool = False,
) -> None:
    """Show a robot through a layout, or its frames without one, until Ctrl+C.

    `port` and `token` make the address: 0 lets the system choose a free port, None makes a secret part up.
    With `use_sim_time` the view's time is that on the robot's /clock.

    Raises:
        CourseError: If the robot cannot be reached, the layout not be read, or the port is taken.
    """
    graph = link_to(robot)
    virtual_time.install()
    try:
        with use_graph(graph):
            if rviz is None:
                viewer = Viewer(use_sim_time=use_sim_time)
                viewer.add("TF", show_names=True)
            else:
                viewer = Viewer.from_rviz(rviz, use_sim_time=use_sim_time)
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
