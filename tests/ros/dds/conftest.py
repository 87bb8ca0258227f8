"""Kits that are linked by DDS, on loopback and in a separate domain."""

from collections.abc import Iterator

import pytest

from course_lib.ros.dds.link import DdsLink
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.robot.sending import Permissions
from tests.domains import Domains
from tests.ros.zenoh.conftest import Kits

# The last domain of the last worker, and the one after it, are below those of the gateway's tests.
DOMAINS = Domains(first=101, count=19)


class DdsKits(Kits):
    """Linked graphs, driven together until something is the case."""

    def __init__(self) -> None:
        super().__init__("dds/127.0.0.1")
        self.links: list[DdsLink] = []
        self.domain = DOMAINS.next()

    def join(self, *, domain: int = 0, send: str = "", call: str = "", host: str = "127.0.0.1") -> RobotGraph:
        """Link one more graph."""
        allowed = Permissions.from_names(send.split(), call.split())
        link = DdsLink(host, self.domain + domain)
        self.links.append(link)
        self.graphs.append(RobotGraph(link, allowed, self.lines.append))
        return self.graphs[-1]


@pytest.fixture
def kits() -> Iterator[DdsKits]:
    joined = DdsKits()
    yield joined
    for graph in tuple(joined.graphs):
        joined.leave(graph)
    for link in joined.links:
        # A link whose robot has not received its stop stays open, and a later test uses its domain.
        link.close()


def dds_link(graph: RobotGraph) -> DdsLink:
    """Return the link of a graph."""
    assert isinstance(graph.link, DdsLink)
    return graph.link
