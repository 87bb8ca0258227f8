"""Declares a robot that is reached over DDS to the students' routers, as if it ran rmw_zenoh.

The bridge is a Zenoh client of the robot's side and a DDS participant in the robot's domain. It
declares every entity of the robot on the Zenoh side. A topic is received from the robot only while
somebody subscribes to it over Zenoh, except topics of transient_local publishers, which
late-joining subscriptions get from the bridge's cache. Only commands forwarded by the gateway and
calls of the allowed services are sent to the robot.

Messages are forwarded in the threads of the links. Everything else is queued by these threads and
runs in `run`, which the gateway's own thread calls.
"""

import re
import time
from _queue import Empty
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from functools import partial

from course_lib.errors import CourseError
from course_lib.ros.dds.link import SILENT_SECONDS, DdsClient, DdsEntity, DdsPublisher
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages.definitions import type_hash
from course_lib.ros.robot.connect import open_dds_link
from course_lib.ros.robot.link import Declaration, Entity, Packet, SendReply
from course_lib.ros.zenoh.link import ZenohEntity, ZenohLink, ZenohPublisher

# DDS allows all characters in names, but Zenoh's special characters must not occur in its keys.
ROS_NAME = re.compile(r"(/[A-Za-z_]\w*)+", re.ASCII)
TYPE = re.compile(r"\w+/\w+/\w+", re.ASCII)
COMMAND_QOS = Qos()
# Period of checking which topics students subscribe to [s].
DEMAND_PERIOD = 0.05


@dataclass
class RobotTopic:
    """A topic of the robot: a subscription over DDS, and the publishers that forward its messages.

    Args:
        publishers: Publishers on the Zenoh side, by the GID of the robot's publisher.
        subscription: None while nobody needs the topic.
    """

    topic: str
    type_name: str
    qos: Qos
    publishers: dict[bytes, ZenohPublisher] = field(default_factory=dict)
    subscription: Declaration | None = None

    def is_needed(self) -> bool:
        """Return whether the robot should send the topic now."""
        return bool(self.publishers) and (
            self.qos.is_latched or any(p.is_matched() for p in tuple(self.publishers.values()))
        )

    def on_packet(self, packet: Packet) -> None:
        """Forward a message by its publisher. Called in the thread of the DDS link."""
        publisher = self.publishers.get(packet.gid)
        if publisher is not None:
            publisher.put(packet.cdr, packet.source_ns)


@dataclass(frozen=True)
class CommandTopic:
    """A topic on which the robot receives commands.

    Args:
        publisher: The publisher on the DDS side.
        type_hash: The hash announced by the robot, which may be empty.
    """

    publisher: DdsPublisher
    type_hash: str


class DdsBridge:
    """Connects a robot over DDS to the robot's Zenoh router of a gateway.

    Args:
        address: The robot, like `dds/192.168.1.5`.
        router: The Zenoh router to which the robot's entities are declared.
        domain: ROS_DOMAIN_ID on both sides.
        sends: Topics for commands, without their first slash.
        calls: Services that may be called, without their first slash.
        report: Prints a line for the instructor.

    Raises:
        CourseError: The address is malformed or unknown, or no network leads to it.
    """

    def __init__(
        self,
        address: str,
        router: str,
        domain: int,
        sends: Sequence[str],
        calls: Sequence[str],
        report: Callable[[str], None],
    ) -> None:
        self._dds = open_dds_link(address, domain)
        self._zenoh = ZenohLink(router, domain)
        # Both links share a queue, so that one thread runs the actions of both.
        self._zenoh.actions = self._dds.actions
        self._sends, self._calls = {f"/{name}" for name in sends}, {f"/{name}" for name in calls}
        self._report, self._reported = report, set[str]()
        self._nodes: dict[Hashable, ZenohEntity] = {}
        self._declared: dict[Hashable, Declaration] = {}
        self._topics: dict[tuple[str, str, Qos], RobotTopic] = {}
        self._commands: dict[tuple[str, str], CommandTopic] = {}
        # Servers, client and declaration of each allowed service.
        self._servers: dict[str, dict[Hashable, ZenohEntity]] = {}
        self._clients: dict[str, DdsClient] = {}
        self._offered: dict[str, Declaration] = {}
        # Monotonic times [s].
        self._polled, self._opened = 0.0, time.monotonic()
        self._is_robot_present = False
        self._own_node: DdsEntity = self._dds.node("gateway", "/")
        self._dds.announce(self._own_node)
        self._dds.watch(self._on_entity, report)

    def is_up(self) -> bool:
        """Return whether a participant of the robot is connected now."""
        return self._dds.is_up()

    def run(self, seconds: float) -> None:
        """Run the queued actions of the links for `seconds`, and subscribe to the needed topics."""
        end = time.monotonic() + seconds
        while (remaining_seconds := end - time.monotonic()) > 0:
            try:
                self._dds.actions.get(timeout=remaining_seconds)()
            except Empty:
                break
            self._update_subscriptions()
        self._update_subscriptions()
        if not self._is_robot_present:
            self._is_robot_present = self.is_up()
            if not self._is_robot_present and time.monotonic() - self._opened > SILENT_SECONDS:
                self._report_once("silent", self._dds.no_nodes_message())

    def is_command(self, topic: str, type_name: str, command_hash: str) -> bool:
        """Return whether the robot receives commands of this type on a topic.

        Called in Zenoh's threads.
        """
        command = self._commands.get((topic, type_name))
        if command is not None and command.type_hash in ("", command_hash):
            return True
        accepted_types = sorted(kind for name, kind in tuple(self._commands) if name == topic)
        if command is not None:
            reason = f"the robot has another definition of {type_name}"
        elif accepted_types:
            reason = f"the robot takes {' and '.join(accepted_types)} there"
        else:
            reason = "the robot has no subscription to it"
        self._report_once(f"{reason} {topic}", f"Commands on {topic} of {type_name} are not sent: {reason}.")
        return False

    def publish(self, topic: str, type_name: str, cdr: bytes) -> None:
        """Publish a command. May be called from any thread."""
        self._commands[topic, type_name].publisher.put(cdr)

    def close(self) -> None:
        """Disconnect from both networks after the robot has acknowledged its last command."""
        self._dds.close()
        self._zenoh.close()

    def _on_entity(self, entity: Entity, has_joined: bool) -> None:
        """Declare an entity of the robot on the Zenoh side, or withdraw it."""
        names = (f"{entity.namespace.rstrip('/')}/{entity.node}", entity.topic or "/_")
        if not all(map(ROS_NAME.fullmatch, names)) or (entity.topic and not TYPE.fullmatch(entity.type_name)):
            return
        if not has_joined:
            self._remove(entity)
        elif entity.kind == "node":
            node = self._zenoh.node(entity.node, entity.namespace)
            self._nodes[entity.node_key] = node
            self._declared[entity.key] = self._zenoh.announce(node)
        else:
            self._add(entity)

    def _add(self, entity: Entity) -> None:
        """Declare an endpoint of the robot."""
        node = self._nodes.get(entity.node_key)
        known_hash = entity.type_hash or _local_type_hash(entity.type_name)
        is_service = entity.kind in ("server", "client")
        # DDS transmits the hash of a request, which does not determine the hash of the service.
        if node is None or not known_hash or (is_service and not _local_type_hash(entity.type_name)):
            if entity.topic in self._calls | self._sends:
                self._report_once(
                    f"type {entity.topic}",
                    f"{entity.topic} is not passed on: its type {entity.type_name} is not known "
                    "here. Start course router in the folder of its package.",
                )
            return
        names = entity.topic, entity.type_name, entity.qos
        declared = self._zenoh.endpoint(node, entity.kind, *names, known_hash)
        if entity.kind == "publisher":
            publisher = self._zenoh.publisher(declared)
            self._topics.setdefault(names, RobotTopic(*names)).publishers[entity.gid] = publisher
            self._declared[entity.key] = publisher
        elif entity.kind == "server" and entity.topic in self._calls:
            servers = self._servers.setdefault(entity.topic, {})
            servers[entity.key] = declared
            if len(servers) == 1:
                self._offer(entity.topic)
        else:
            self._declared[entity.key] = self._zenoh.announce(declared)
        if entity.kind == "subscription" and entity.topic in self._sends:
            # The publisher of a command is declared in advance, because the first command would be
            # lost.
            key = entity.topic, entity.type_name
            command = self._commands.get(key)
            if command is None:
                endpoint = self._dds.endpoint(self._own_node, "publisher", *key, COMMAND_QOS, known_hash)
                command = CommandTopic(self._dds.publisher(endpoint), "")
            self._commands[key] = CommandTopic(command.publisher, entity.type_hash)

    def _offer(self, service: str) -> None:
        """Offer an allowed service on the Zenoh side once, for its first server.

        All servers receive each call.
        """
        declared = next(iter(self._servers[service].values()))
        if service not in self._clients:
            endpoint = self._dds.endpoint(self._own_node, "client", service, declared.type_name, declared.qos)
            self._clients[service] = self._dds.client(endpoint)
        self._offered[service] = self._zenoh.service(declared, partial(self._on_request, service))

    def _on_request(self, service: str, cdr: bytes, send_reply: SendReply) -> None:
        def on_reply(reply: bytes | None) -> None:
            if reply is not None:
                send_reply(reply)

        client = self._clients.get(service)
        # A query without a reply ends when it is deleted.
        if client is not None:
            client.call(cdr, on_reply)

    def _remove(self, entity: Entity) -> None:
        """Withdraw an entity that has left the robot."""
        if entity.kind == "node":
            self._nodes.pop(entity.node_key, None)
        declaration = self._declared.pop(entity.key, None)
        if declaration is not None:
            declaration.withdraw()
        if entity.kind == "publisher":
            topic = self._topics.get((entity.topic, entity.type_name, entity.qos))
            if topic is not None:
                topic.publishers.pop(entity.gid, None)
        servers = self._servers.get(entity.topic, {}) if entity.kind == "server" else {}
        if entity.key in servers:
            was_offered = next(iter(servers)) == entity.key
            del servers[entity.key]
            if was_offered:
                self._offered.pop(entity.topic).withdraw()
            if not servers:
                self._clients.pop(entity.topic).withdraw()
            elif was_offered:
                self._offer(entity.topic)

    def _update_subscriptions(self) -> None:
        """Subscribe to exactly those topics of the robot that are needed."""
        if time.monotonic() - self._polled < DEMAND_PERIOD:
            return
        self._polled = time.monotonic()
        for key, topic in tuple(self._topics.items()):
            is_needed = topic.is_needed()
            if is_needed and topic.subscription is None:
                topic.subscription = self._dds.subscriber(*key, 0, topic.on_packet)
            elif not is_needed and topic.subscription is not None:
                topic.subscription.withdraw()
                topic.subscription = None
            if not topic.publishers:
                del self._topics[key]

    def _report_once(self, key: str, line: str) -> None:
        if key not in self._reported:
            self._reported.add(key)
            self._report(line)


def _local_type_hash(type_name: str) -> str:
    """Return the hash of a type as defined on this computer; "" for an unknown type."""
    try:
        return type_hash(type_name)
    except CourseError:
        return ""
