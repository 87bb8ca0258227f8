"""The way between a launch and a lifecycle node: its transitions, and requests for more."""

from collections.abc import Callable

from lifecycle_msgs.msg import Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState

from course_lib.ros.graph import NodesOfProgram, current_graph
from course_lib.ros.messages import deserialize, serialize
from course_lib.ros.qos import Qos
from course_lib.ros.topics import SERVICE_HEADER, SERVICE_TOPICS

_EVENT, _SERVICE = "lifecycle_msgs/msg/TransitionEvent", "lifecycle_msgs/srv/ChangeState"


class LaunchNode:
    """The node of a launch in the graph, one for each launch."""

    def __init__(self) -> None:
        self.id = current_graph().add_node("launch_ros", "/")
        current_graph().part(NodesOfProgram).ids.add(self.id)


class LifecycleLink:
    """A link to the node of a full name; `hear` gets its transitions, `failed` the number of one refused."""

    def __init__(
        self, name: str, hear: Callable[[TransitionEvent], object], failed: Callable[[int], object]
    ) -> None:
        self._graph, self._qos, self._failed = current_graph(), Qos(), failed
        self._asked: list[int] = []  # by the count of requests
        node = self._graph.part(LaunchNode).id

        def note(cdr: bytes, source_ns: int, received_ns: int) -> None:
            hear(deserialize(cdr, TransitionEvent))

        self._graph.add_subscription(node, 0, f"{name}/transition_event", _EVENT, self._qos, note)
        topics = [f"{prefix}{name}/change_state{suffix}" for prefix, suffix in SERVICE_TOPICS]
        self._requests = topics[0]
        self._id = self._graph.add_publisher(node, topics[0], f"{_SERVICE}_Request", self._qos)
        self._graph.add_subscription(node, 0, topics[1], f"{_SERVICE}_Response", self._qos, self._answered)

    def ask(self, transition: int) -> bool:
        """Ask for a transition; False while the node's service is not there."""
        if not any(e.topic == self._requests and e.kind == "sub" for e in self._graph.endpoints()):
            return False
        request = ChangeState.Request(transition=Transition(id=transition))
        self._asked.append(transition)
        self._graph.publish(self._id, SERVICE_HEADER.pack(self._id, len(self._asked)) + serialize(request))
        return True

    def _answered(self, data: bytes, source_ns: int, received_ns: int) -> None:
        client, number = SERVICE_HEADER.unpack_from(data)
        if client != self._id:
            return
        answer = deserialize(data[SERVICE_HEADER.size :], ChangeState.Response)
        if not answer.success:
            self._failed(self._asked[number - 1])
