"""A server of interactive markers, a viewer that shows them, and the feedback to the server."""

from typing import Any

import rclpy
from interactive_markers import InteractiveMarkerServer
from rclpy.node import Node
from std_msgs.msg import Header
from visualization_msgs.msg import (
    InteractiveMarker,
    Marker,
)
from visualization_msgs.msg import InteractiveMarkerControl as C
from visualization_msgs.msg import InteractiveMarkerFeedback as F

from course_lib.displays.interactive import InteractiveMarkersDisplay
from course_lib.displays.viewer import Viewer
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import spin_for
from tests.displays.interactive.pointing import command


def box(*modes: int, frame: str = "map", name: str = "box", **fields: Any) -> InteractiveMarker:
    """Create a marker with a control for each mode, and a grey box that is a button."""
    grey = Marker(type=Marker.CUBE)
    grey.color.a = 1.0
    names = {C.MOVE_AXIS: "move", C.ROTATE_AXIS: "turn", C.MOVE_PLANE: "plane", C.MENU: "menu"}
    controls = [C(name=names.get(mode, str(mode)), interaction_mode=mode) for mode in modes]
    controls.append(C(name="button", interaction_mode=C.BUTTON, markers=[grey]))
    header = Header(frame_id=frame)
    return InteractiveMarker(header=header, name=name, description="Box", controls=controls, **fields)


class Stage:
    """A server in a notebook, a viewer that shows its markers, and the received feedback."""

    def __init__(self, graph: Graph) -> None:
        rclpy.init(args=[])
        self.graph, self.node = graph, Node("control")
        self.server = InteractiveMarkerServer(self.node, "simple")
        self.heard: list[F] = []
        self.viewer = Viewer()
        self.viewer.remove(self.viewer["Grid"])

    def add(self, marker: InteractiveMarker) -> None:
        self.server.insert(marker, feedback_callback=self.heard.append)
        self.server.applyChanges()

    def show(self, marker: InteractiveMarker | None = None, **fields: Any) -> InteractiveMarkersDisplay:
        """Show the markers of the server, with one more."""
        if marker is not None:
            self.add(marker)
        display = self.viewer.add("InteractiveMarkers", "/simple", **fields)
        assert isinstance(display, InteractiveMarkersDisplay)
        spin_for(1.5, self.node)
        return display

    def use(self, name: str, *events: tuple[str, tuple[float, float, float]], **keys: Any) -> Any:
        """Drag a control and deliver the feedback to the server. Return the opened menu."""
        path = f"displays/InteractiveMarkers/handles/box/controls/{name}/0/mesh"
        menu: Any = ()
        for event, at in events:
            (display,) = self.viewer.displays
            menu = display.use(command(path, event, at, **keys))  # type: ignore[attr-defined]
            spin_for(0.1, self.node)
        return menu

    def place(self) -> list[float]:
        """Return the displayed position of the box."""
        self.viewer.refresh()
        path = "displays/InteractiveMarkers/handles/box/controls/button"
        at: list[float] = self.viewer.scene.world_transform(path)[:3, 3].round(6).tolist()
        return at

    def status(self, display: InteractiveMarkersDisplay, name: str) -> tuple[str, str]:
        rows = [row for row in self.viewer.statuses() if row.name == name and row.level != "hint"]
        return rows[0].level, rows[0].text
