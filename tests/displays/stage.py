"""A stage for viewers: messages published in a graph, and the objects that are shown."""

from typing import Any

from course_lib.displays.viewer import Viewer
from course_lib.ros.graph.graph import Graph
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize, type_name

LATCHED = Qos(durability="transient_local")


def publish(graph: Graph, topic: str, message: Any, qos: Qos | None = None) -> None:
    node = graph.add_node("talker", "/")
    graph.publish(graph.add_publisher(node, topic, type_name(message), qos or Qos()), serialize(message))


def wait(graph: Graph, seconds: float) -> None:
    """Advance robot time."""
    graph.call_at(graph.now_ns + round(seconds * 1e9), lambda: None, node=0, entity=0)
    while graph.advance():
        pass


def visible_nodes(viewer: Viewer) -> set[str]:
    viewer.refresh()
    return {path.split("/")[1] for path in viewer.scene.objects() if viewer.scene.is_visible(path)}
