"""Services and actions over the link, both ways: as queries and replies of Zenoh."""

import itertools
from collections.abc import Callable
from functools import partial

from course_lib.ros.topics import SERVICE_HEADER, SERVICE_TOPICS, EndpointInfo
from course_lib.ros.zenoh.link import Answer, Asker, Declared, RobotLink
from course_lib.ros.zenoh.tokens import Entity

ELSEWHERE = -1  # in the header of a request: it comes over the link
MAX_OPEN = 1000  # requests from there without a response
REPLY = SERVICE_TOPICS[1]

Deliver = Callable[[str, str, bytes], None]  # topic, type, header and CDR bytes


class Services:
    """The service ends of the kit that are on the network.

    Args:
        link: Where they are declared.
        deliver: Brings data to the subscriptions of a topic in the graph.
    """

    def __init__(self, link: RobotLink, deliver: Deliver) -> None:
        self._link, self._deliver = link, deliver
        self._askers: dict[int, Asker] = {}  # by the endpoint of the requests
        self._servers: dict[int, Declared] = {}
        self._open: dict[int, Answer] = {}
        self._numbers = itertools.count()

    def add_client(self, node: Entity, info: EndpointInfo) -> None:
        """Announce a client, by the endpoint that publishes its requests."""
        name, type_name = info.service or ("", "")
        self._askers[info.id] = self._link.client(self._link.endpoint(node, "SC", name, type_name, info.qos))

    def add_server(self, node: Entity, info: EndpointInfo) -> None:
        """Offer a service, by the endpoint that hears its requests."""
        name, type_name = info.service or ("", "")
        entity = self._link.endpoint(node, "SS", name, type_name, info.qos)
        self._servers[info.id] = self._link.service(entity, partial(self._asked, info))

    def remove(self, endpoint: int) -> None:
        """Remove a client or a server."""
        for declared in (self._askers.pop(endpoint, None), self._servers.pop(endpoint, None)):
            if declared is not None:
                declared.withdraw()

    def ask(self, info: EndpointInfo, data: bytes) -> bool:
        """Send a request of a client; returns False if the client is not on the network."""
        asker = self._askers.get(info.id)
        if asker is None:
            return False
        name, type_name = info.service or ("", "")
        header, cdr = data[: SERVICE_HEADER.size], data[SERVICE_HEADER.size :]

        def replied(answer: bytes | None) -> None:
            if answer is not None:
                topic = f"{REPLY[0]}{name}{REPLY[1]}"
                self._deliver(topic, f"{type_name}_Response", header + answer)

        asker.ask(cdr, replied)
        return True

    def answer(self, data: bytes) -> None:
        """Send a response, if its request came over the link."""
        client, number = SERVICE_HEADER.unpack_from(data)
        answer = self._open.pop(number, None) if client == ELSEWHERE else None
        if answer is not None:
            answer(data[SERVICE_HEADER.size :])

    def _asked(self, info: EndpointInfo, cdr: bytes, answer: Answer) -> None:
        number = next(self._numbers)
        self._open[number] = answer
        if len(self._open) > MAX_OPEN:
            del self._open[next(iter(self._open))]  # Zenoh tells its client that there is no reply
        self._deliver(info.topic, info.type_name, SERVICE_HEADER.pack(ELSEWHERE, number) + cdr)
