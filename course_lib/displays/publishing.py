"""The node through which a viewer's tools publish."""

from collections.abc import Mapping
from typing import Any

from course_lib.displays.session import Session
from course_lib.displays.tools import PublishPoint
from course_lib.displays.topic_display import qos_of
from course_lib.errors import CourseError
from course_lib.ros.graph import Graph
from course_lib.ros.messages import serialize
from course_lib.ros.qos import Qos

NODE = "rviz2"


class ToolNode:
    """Is in the graph from the first time that a tool publishes."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._node: int | None = None
        self._publishers: dict[tuple[str, str, Qos], int] = {}  # endpoints

    def publish(self, session: Session, label: str, done: Mapping[str, Any]) -> str:
        """Publish what a tool does, in the fixed frame and stamped now; returns what it was in words.

        Raises:
            CourseError: If there is no such tool.
        """
        tools = {tool.label: tool for tool in session.tools if isinstance(tool, PublishPoint)}
        if label not in tools:
            raise CourseError(f"There is no tool {label!r} that publishes, but {', '.join(tools)}.")
        tool = tools[label]
        message = tool.message(session.fixed_frame, self._graph.now_ns, done)
        topic = "/" + tool["Topic"].removeprefix("/")
        self._graph.publish(self._publisher(topic, tool.type_name, qos_of(tool)), serialize(message))
        return tool.said(topic, message)

    def close(self) -> None:
        """Leave the graph."""
        if self._node is not None:
            self._graph.remove_node(self._node)
        self._node = None
        self._publishers.clear()

    def _publisher(self, topic: str, type_name: str, qos: Qos) -> int:
        if self._node is None:
            self._node = self._graph.add_node(NODE, "/")
        wanted = (topic, type_name, qos)
        if wanted not in self._publishers:
            self._publishers[wanted] = self._graph.add_publisher(self._node, *wanted)
        return self._publishers[wanted]
