"""Nodes, the units that ROS programs consist of."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from functools import partial
from typing import Any, Literal, TypedDict, TypeVar

from rcl_interfaces.msg import (
    ListParametersResult,
    Log,
    ParameterDescriptor,
    ParameterEvent,
    ParameterValue,
    SetParametersResult,
)
from rcl_interfaces.msg import Parameter as ParameterMsg

from course_lib.ros.graph.graph import current_graph
from course_lib.ros.messages import RosMessage, type_name
from course_lib.ros.mistakes import Mistake, mark, marked
from course_lib.ros.notices import replacements
from course_lib.ros.time.time_lock import time_lock
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.client import Client
from rclpy.clock import Clock, ROSClock
from rclpy.context import Context, Contexts, get_default_context, require_context
from rclpy.duration import S_TO_NS, Duration
from rclpy.event_handler import Deadline, EventCallbacks, PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.exceptions import (
    InvalidParameterValueException,
    NameValidationException,
    NotInitializedException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.executors import Executor
from rclpy.impl import names, private_names
from rclpy.impl.arguments import merge_arguments, parse
from rclpy.impl.endpoint import Endpoint, MessageInfo, TopicEnd, claim_topic, require_type
from rclpy.impl.graph_queries import (
    NamesAndTypes,
    TopicEndpointInfo,
    describe,
    endpoints_of,
    endpoints_on,
    service_endpoints,
    services,
    sorted_types,
    to_qos,
)
from rclpy.impl.implementation_singleton import NodeNameNonExistentError as NodeNameNonExistentError
from rclpy.impl.implementation_singleton import RCLError
from rclpy.impl.node_handle import GuardCondition, NodeHandle, NodesById, enter_graph, require_bool
from rclpy.impl.parameter_store import On, ParameterStore, Post, Pre, find_rejection
from rclpy.impl.rcutils_logger import SAME_NAME, RcutilsLogger, Rosout
from rclpy.logging import get_logger
from rclpy.parameter import Parameter
from rclpy.parameter_service import LoggingService, ParameterService, TypeDescriptionService
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_parameter_events, qos_profile_services_default
from rclpy.qos_overriding_options import QoSOverridingOptions, apply_overrides
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.time_source import TimeSource
from rclpy.timer import Rate, Timer

_LOOK = 0.1  # [s] between checks whether a node exists, as in rclpy
_ENCLAVE = "/"  # the security enclave of every node, as security is not enabled
MsgT = TypeVar("MsgT", bound=RosMessage)
OnMessage = Callable[[MsgT], object] | Callable[[MsgT, MessageInfo], object] | Callable[[bytes], object]

HIDDEN_NODE_PREFIX = "_"
_ROSOUT = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL, lifespan=Duration(seconds=10))


class NodeOptions(TypedDict, total=False):
    """The keyword arguments of Node."""

    context: Context | None
    cli_args: list[str] | None
    namespace: str | None
    use_global_arguments: bool
    enable_rosout: bool
    start_parameter_services: bool
    parameter_overrides: list[Parameter] | None
    allow_undeclared_parameters: bool
    automatically_declare_parameters_from_overrides: bool
    enable_logger_service: bool


class Node:
    """A node, with its publishers, subscriptions, timers and parameters.

    Args:
        node_name: Letters, digits and underscores; must not begin with a digit.
        context: The node's context; default: the one that `rclpy.init()` has initialized.
        namespace: Prefix of the node's name and of its relative topic names.
        cli_args: Command-line arguments for this node only. They take precedence over the arguments
            of `rclpy.init()`.
        use_global_arguments: Whether the arguments of `rclpy.init()` apply as well.
        parameter_overrides: Values that replace the defaults of the node's parameters.
        automatically_declare_parameters_from_overrides: Whether all overrides are declared.
        start_parameter_services: Whether other nodes can read and change the parameters.
        allow_undeclared_parameters: Whether parameters can be used without a declaration.
        enable_rosout: Whether log messages are published on /rosout.
        enable_logger_service: Whether other nodes can read and change the levels of the loggers.

    Raises:
        NotInitializedException: `rclpy.init()` was not called.
        InvalidNodeNameException: The name is invalid.
        InvalidNamespaceException: The namespace is invalid.
    """

    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None = None,
        cli_args: list[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        start_parameter_services: bool = True,
        parameter_overrides: list[Parameter] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
        enable_logger_service: bool = False,
    ) -> None:
        private_names.reject_hidden_properties(type(self))
        context = get_default_context() if context is None else context
        for flag in (use_global_arguments, enable_rosout):
            require_bool(flag)
        require_context(context, "ok")
        if not context.is_valid:
            error = NotInitializedException("cannot create node")
            raise marked(error, Mistake.SHUT_DOWN) if current_graph().state(Contexts).initialized else error
        local = parse([] if cli_args is None else cli_args)
        local.log_warnings(get_logger("rcl").warning)
        arguments = merge_arguments(local, context.arguments) if use_global_arguments else local
        self.__node = enter_graph(context, node_name, namespace or "", arguments)
        # A node whose constructor raises leaves the graph.
        with ExitStack() as failed:
            failed.callback(self.__leave_graph)
            self.__clock = ROSClock()
            self.__created_entities = []
            # Entities that rcl creates in ROS, and rclpy therefore does not list.
            self.__hidden_entities: list[Any] = []
            self.__default_callback_group = MutuallyExclusiveCallbackGroup()
            self.__rate_group = ReentrantCallbackGroup()
            self.__logger = get_logger(self.handle.logger_name)
            self.__settle_same_names()
            context.on_shutdown(self.__leave_graph)
            self.__rosout = self.create_publisher(Log, "/rosout", _ROSOUT) if enable_rosout else None
            if self.__rosout is not None:
                self._course_hide(self.__rosout)
                current_graph().state(Rosout).publish.setdefault(self.handle.logger_name, self.__publish_log)
            events = self.create_publisher(ParameterEvent, "/parameter_events", qos_profile_parameter_events)
            overrides = arguments.parameters(self.handle.full_name)
            for parameter in () if parameter_overrides is None else parameter_overrides:
                overrides[parameter.name] = parameter
            self.__parameter_store = ParameterStore(self.__name_in_events, self.__clock, events, overrides)
            self.__allow_undeclared_parameters = allow_undeclared_parameters
            if automatically_declare_parameters_from_overrides:
                values = [(name, one.value, ParameterDescriptor()) for name, one in overrides.items()]
                self.declare_parameters("", values, ignore_override=True)
            self.__time_source = TimeSource(node=self)
            self.__time_source.attach_clock(self.__clock)
            if start_parameter_services:
                ParameterService(self)
            if enable_logger_service:
                LoggingService(self)
            self.__type_description_service = TypeDescriptionService(self)
            failed.pop_all()

    # Relative tolerance of a floating-point value at the steps of its range.
    PARAM_REL_TOL = 1e-6
    __node: NodeHandle = private_names.set_by_init("_Node__node")
    __created_entities: list[Any] = private_names.set_by_init("_publishers")
    __parameter_store: ParameterStore = private_names.set_by_init("_parameters")
    __allow_undeclared_parameters: bool = private_names.set_by_init("_allow_undeclared_parameters")
    # Descriptors of rclpy's private names (`watch_names` below). Methods read these, so that the
    # error without `super().__init__()` is the same as on a robot.
    _clock: Clock
    _logger: RcutilsLogger
    _default_callback_group: CallbackGroup
    _rate_group: CallbackGroup

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Report attributes of a student's class whose names are private in rclpy."""
        super().__init_subclass__(**kwargs)
        private_names.check_class("Node", cls, private_names.USES | private_names.METHODS)

    @property
    def context(self) -> Context:
        """The node's context."""
        return self.handle.context

    @property
    def executor(self) -> Executor | None:
        """The executor that the node was added to last."""
        executor = self.handle.executor
        return executor if isinstance(executor, Executor) else None

    @executor.setter
    def executor(self, new_executor: Executor | None) -> None:
        former = self.executor
        if new_executor is not None and new_executor is not former:
            new_executor.add_node(self)
        elif former is not None and new_executor is None:
            former.remove_node(self)
            self.handle.executor = None

    def get_name(self) -> str:
        """Return the name of the node."""
        return self.handle.require().name

    def get_namespace(self) -> str:
        """Return the namespace of the node."""
        return self.handle.require().namespace

    def get_fully_qualified_name(self) -> str:
        """Return the fully qualified name: the namespace and the name."""
        return self.handle.require().full_name

    def __name_in_events(self) -> str:
        # rclpy calls the methods, which a student's class may override.
        if self.get_namespace() == "/":
            return self.get_namespace() + self.get_name()
        return self.get_namespace() + "/" + self.get_name()

    def get_clock(self) -> Clock:
        """Return the clock of the node."""
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        """Return the logger of the node."""
        return self._logger

    def destroy_node(self) -> None:
        """Destroy the node and all its entities. Calling it twice is allowed."""
        # Endpoints on the other side have to update their numbers of partners.
        self.handle.graph.show_node(self.handle.id)
        for entities in (self.__created_entities, self.__hidden_entities):
            while entities:
                entities.pop().destroy()
        self.__leave_graph()
        self.handle.is_destroyed = True

    def __settle_same_names(self) -> None:
        """Register the node.

        In a notebook it replaces a node of the same name; elsewhere ROS's warning is logged.
        """
        nodes, name = current_graph().state(NodesById).nodes, self.handle.full_name
        namesakes = [other for other in nodes.values() if other.handle.full_name == name]
        nodes[self.handle.id] = self
        if namesakes and not self.handle.graph.notebook:
            get_logger("rcl.logging_rosout").warning(SAME_NAME.format(self.handle.logger_name))
        elif namesakes:
            replacements.add(name)
            for other in namesakes:
                other.destroy_node()

    def __leave_graph(self) -> None:
        current_graph().state(NodesById).nodes.pop(self.handle.id, None)
        rosout = current_graph().state(Rosout).publish
        if rosout.get(self.handle.logger_name) == self.__publish_log:
            del rosout[self.handle.logger_name]
        self.handle.leave()

    def __publish_log(self, message: Log) -> None:
        if self.__rosout is not None and self.context.is_valid:
            self.__rosout.publish(message)

    @property
    def handle(self) -> NodeHandle:
        """The node's handle in the graph."""
        return self.__node

    @handle.setter
    def handle(self, value: object) -> None:
        raise AttributeError("handle cannot be modified after node creation")

    def get_node_names(self) -> list[str]:
        """List the names of all nodes."""
        return [name for name, _ in self.get_node_names_and_namespaces()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """List (name, namespace) for all nodes."""
        return [
            (node.name, node.namespace)
            for node in self.__node.require("Failed to get node names").graph.nodes()
        ]

    def get_topic_names_and_types(self, no_demangle: bool = False) -> NamesAndTypes:
        """List all topics with their types."""
        require_bool(no_demangle, "rclpy_get_topic_names_and_types(): incompatible function arguments.")
        infos = self.__node.require("failed to get topic names and types").graph.endpoints()
        return sorted_types((info.topic, info.type_name) for info in infos if info.service is None)

    def get_service_names_and_types(self) -> NamesAndTypes:
        """List all services with their types.

        As in ROS, services with clients only are included.
        """
        return services(self.__node.require("failed to get service names and types").graph.endpoints())

    def count_publishers(self, topic_name: str) -> int:
        """Return the number of publishers on a topic."""
        self.__node.require("Error in rcl_count_publishers")
        time_lock.poll()
        return len(endpoints_on(self.handle, topic_name, "pub"))

    def count_subscribers(self, topic_name: str) -> int:
        """Return the number of subscriptions on a topic."""
        self.__node.require("Error in rcl_count_subscribers")
        time_lock.poll()
        return len(endpoints_on(self.handle, topic_name, "sub"))

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """List the publishers on a topic with their QoS."""
        require_bool(no_mangle, "rclpy_get_publishers_info_by_topic(): incompatible function arguments.")
        node = self.__node.require("Failed to get information by topic for publishers")
        return [describe(info, node.graph.nodes()) for info in endpoints_on(node, topic_name, "pub")]

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """List the subscriptions on a topic with their QoS."""
        require_bool(no_mangle, "rclpy_get_subscriptions_info_by_topic(): incompatible function arguments.")
        node = self.__node.require("Failed to get information by topic for subscriptions")
        return [describe(info, node.graph.nodes()) for info in endpoints_on(node, topic_name, "sub")]

    def get_fully_qualified_node_names(self) -> list[str]:
        """List the fully qualified names of all nodes."""
        return [node.full_name for node in self.__node.require("Failed to get node names").graph.nodes()]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """List (name, namespace, enclave) for all nodes."""
        return [(*pair, _ENCLAVE) for pair in self.get_node_names_and_namespaces()]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Wait at most `timeout` [s] for a node. Return whether it exists."""
        if not fully_qualified_node_name.startswith("/"):
            fully_qualified_node_name = f"/{fully_qualified_node_name}"
        # As in rclpy, which sleeps once more after it has seen the node, and does not look at all
        # without a positive timeout.
        start, exists = time.time(), False
        while time.time() - start < timeout and not exists:
            exists = fully_qualified_node_name in self.get_fully_qualified_node_names()
            time.sleep(_LOOK)
        return exists

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """List the topics that a node publishes on.

        Raise NodeNameNonExistentError if there is no such node.
        """
        node = self.__node.require("failed to get publisher names and types")
        infos = endpoints_of(node, node_name, node_namespace, "publisher")
        return sorted_types((i.topic, i.type_name) for i in infos if i.service is None and i.kind == "pub")

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """List the topics that a node subscribes to."""
        node = self.__node.require("failed to get subscriber names and types")
        infos = endpoints_of(node, node_name, node_namespace, "subscriber")
        return sorted_types((i.topic, i.type_name) for i in infos if i.service is None and i.kind == "sub")

    def get_service_names_and_types_by_node(
        self,
        node_name: str,
        node_namespace: str,
    ) -> NamesAndTypes:
        """List the services of a node."""
        node = self.__node.require("failed to get service names and types")
        return services(i for i in endpoints_of(node, node_name, node_namespace, "service") if i.is_service)

    def get_client_names_and_types_by_node(
        self,
        node_name: str,
        node_namespace: str,
    ) -> NamesAndTypes:
        """List the services that a node has clients for."""
        node = self.__node.require("failed to get client names and types")
        return services(i for i in endpoints_of(node, node_name, node_namespace, "client") if i.is_client)

    def count_services(self, service_name: str) -> int:
        """Return the number of servers of a service."""
        ends = service_endpoints(self.__node.require(), service_name, "Error in rcl_count_services")
        return sum(end.is_service for end in ends)

    def count_clients(self, service_name: str) -> int:
        """Return the number of clients of a service."""
        ends = service_endpoints(self.__node.require(), service_name, "Error in rcl_count_clients")
        return sum(end.is_client for end in ends)

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return the full name of a topic for this node. Raise RCLError if the name is invalid."""
        return self.__resolve_or_fail(topic, "topic", only_expand)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return the full name of a service for this node.

        Raise RCLError if the name is invalid.
        """
        return self.__resolve_or_fail(service, "service", only_expand)

    def __resolve_or_fail(self, name: str, kind: names.Kind, only_expand: bool) -> str:
        if name is None:
            raise RCLError("failed to resolve name: input_topic_name argument is null")
        try:
            return self._course_resolve(name, kind, only_expand)
        except (ValueError, NameValidationException) as error:
            raise RCLError(f"failed to resolve name: {names.reason_without_name(error)}") from None

    def _course_resolve(self, name: str, kind: names.Kind, only_expand: bool = False) -> str:
        """Return the full name for a new entity.

        An invalid name raises NameValidationException or ValueError.
        """
        node = self.__node.require()
        if name is None:
            raise RCLError("failed to validate name: topic_name argument is null")
        if not isinstance(name, str):
            raise TypeError("rclpy_resolve_name(): incompatible function arguments.")
        full = names.expand_name(name, node.name, node.namespace, kind)
        return full if only_expand else node.arguments.remap(full, node.name, node.namespace, kind)

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The group of all callbacks that are created without a group."""
        return self._default_callback_group

    publishers = property(lambda self: self.__created_of(Publisher), doc="The node's publishers.")
    subscriptions = property(lambda self: self.__created_of(Subscription), doc="The node's subscriptions.")
    clients = property(lambda self: self.__created_of(Client), doc="The node's clients.")
    services = property(lambda self: self.__created_of(Service), doc="The node's services.")
    timers = property(lambda self: self.__created_of(Timer), doc="The node's timers.")
    guards = property(lambda self: self.__created_of(GuardCondition), doc="The node's guard conditions.")

    def create_publisher(
        self,
        msg_type: type[MsgT],
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: PublisherEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        publisher_class: type[Publisher[Any]] = Publisher,
    ) -> Publisher[MsgT]:
        """Create a publisher.

        Args:
            msg_type: The class of its messages.
            topic: `x` is relative to the node's namespace, `~/x` to the node's name; `/x` is
                absolute.
            qos_profile: The QoS profile, or only the depth of the queue.
            callback_group: The group of `event_callbacks`.
            event_callbacks: Callbacks for events, such as matched subscriptions.
            qos_overriding_options: The policies that parameters can override.
            publisher_class: The class of the publisher.
        """
        group, events = callback_group or self.default_callback_group, event_callbacks
        PublisherEventCallbacks.require(events)
        node, full_topic = self.handle, self._course_resolve(topic, "topic")
        node.require("Failed to create publisher")
        require_type(msg_type, "message")
        profile = self.__overridden_profile("publisher", full_topic, qos_profile, qos_overriding_options)
        claim_topic(node, "publisher", full_topic, type_name(msg_type))
        publisher_id = node.graph.add_publisher(
            node.id, full_topic, type_name(msg_type), to_qos(profile, "pub")
        )
        publisher = publisher_class(Endpoint(node, publisher_id, full_topic), msg_type, topic, profile)
        self.__keep_endpoint(publisher, events or PublisherEventCallbacks(), group)
        return publisher

    def create_subscription(
        self,
        msg_type: type[MsgT],
        topic: str,
        callback: "OnMessage[MsgT]",
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
    ) -> Subscription[MsgT]:
        """Create a subscription.

        Args:
            msg_type: The class of its messages.
            topic: The topic: `x` is relative to the node's namespace, `~/x` to the node's name,
                `/x` is absolute.
            callback: Called with each message, or with each message and its MessageInfo; may be a
                coroutine.
            qos_profile: The QoS profile, or only the depth of the queue.
            callback_group: The group, which controls which callbacks may run at the same time.
            event_callbacks: Callbacks for events, such as matched publishers.
            qos_overriding_options: The policies that parameters can override.
            raw: Whether the callback receives serialized bytes instead of messages.
        """
        group, events = callback_group or self.default_callback_group, event_callbacks
        SubscriptionEventCallbacks.require(events)
        full_topic = self._course_resolve(topic, "topic")
        self.handle.require("Failed to create subscription")
        require_type(msg_type, "message")
        profile = self.__overridden_profile("subscription", full_topic, qos_profile, qos_overriding_options)
        claim_topic(self.handle, "subscription", full_topic, type_name(msg_type))
        subscription = Subscription(self.handle, msg_type, topic, full_topic, callback, group, profile, raw)
        self.__keep_endpoint(subscription, events or SubscriptionEventCallbacks(), group)
        self.handle.count_callbacks(1)
        return subscription

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client:
        """Create a client of the service `srv_name`.

        `callback_group` is the group of its responses.
        """
        self.handle.require("failed to create client")
        full_name = self.__full_service_name(srv_type, srv_name)
        group = self.default_callback_group if callback_group is None else callback_group
        client = Client(self.handle, group, srv_type, srv_name, full_name, qos_profile)
        self.__created_entities.append(client)
        return client

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Service:
        """Create a service.

        `callback(request, response)`, a function or coroutine, returns the filled response.
        """
        self.handle.require("failed to create service")
        full_name = self.__full_service_name(srv_type, srv_name)
        group = self.default_callback_group if callback_group is None else callback_group
        service = Service(callback, self.handle, group, srv_type, srv_name, full_name, qos_profile)
        self.__created_entities.append(service)
        return service

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], object] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """Create a timer that calls `callback` every `timer_period_sec` [s], first after one period."""
        try:
            period_ns = int(float(timer_period_sec) * S_TO_NS)
        except (TypeError, ValueError) as error:
            mark(error, Mistake.PERIOD)
            raise
        group = self.default_callback_group if callback_group is None else callback_group
        clock = self.__clock if clock is None else clock
        timer = Timer(self.handle, callback, group, period_ns, clock, autostart=autostart)
        self.__created_entities.append(timer)
        self.handle.count_callbacks(int(callback is not None))
        return timer

    def create_guard_condition(
        self, callback: Callable[[], object], callback_group: CallbackGroup | None = None
    ) -> GuardCondition:
        """Create a guard condition, whose callback runs after each `trigger()`."""
        group = self.default_callback_group if callback_group is None else callback_group
        guard = GuardCondition(callback, group, context=self.handle.context)
        guard._course_join(self.handle)
        self.__created_entities.append(guard)
        return guard

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """Create a rate for loops at a frequency [Hz]. Another thread has to spin the node."""
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        return Rate(
            self.create_timer(1.0 / frequency, None, self._rate_group, clock), context=self.handle.context
        )

    def add_waitable(self, waitable: Any) -> None:
        """Add an entity created elsewhere. It is destroyed together with the node."""
        self.__created_entities.append(waitable)

    def remove_waitable(self, waitable: Any) -> None:
        """Remove an entity that was added with `add_waitable`."""
        self.__created_entities.remove(waitable)

    def _course_hide(self, entity: Any) -> None:
        """Exclude an entity from the lists of the node's entities.

        It is still destroyed with the node.
        """
        self.__created_entities.remove(entity)
        self.__hidden_entities.append(entity)

    def destroy_publisher(self, publisher: Any) -> bool:
        """Destroy a publisher.

        Like the methods below, it returns False if the node has no such entity of this kind.
        """
        return self.__destroy(publisher, Publisher)

    def destroy_subscription(self, subscription: Any) -> bool:
        """Destroy a subscription."""
        return self.__destroy(subscription, Subscription)

    def destroy_client(self, client: Any) -> bool:
        """Destroy a client."""
        return self.__destroy(client, Client)

    def destroy_service(self, service: Any) -> bool:
        """Destroy a service."""
        return self.__destroy(service, Service)

    def destroy_timer(self, timer: Any) -> bool:
        """Destroy a timer."""
        return self.__destroy(timer, Timer)

    def destroy_guard_condition(self, guard: Any) -> bool:
        """Destroy a guard condition."""
        return self.__destroy(guard, GuardCondition)

    def _course_destroy(self, entity: Any) -> bool:
        """Destroy an entity of any kind, hidden or not."""
        if entity in self.__hidden_entities:
            self.__hidden_entities.remove(entity)
            self.__destroy_for_good(entity)
            return True
        return self.__destroy(entity, object)

    def __destroy(self, entity: Any, kind: type[Any]) -> bool:
        if entity not in self.__created_entities or not isinstance(entity, kind):
            return False
        self.__created_entities.remove(entity)
        if kind is Subscription or (kind is Timer and entity.callback is not None):
            self.handle.count_callbacks(-1)
        self.__destroy_for_good(entity)
        return True

    def __destroy_for_good(self, entity: Any) -> None:
        """Destroy an entity that the node lists no more, so that an executor ignores it."""
        entity.destroy()
        if isinstance(entity, TopicEnd):
            self.handle.destroyed_ends.discard(entity.handle.id)

    def destroy_rate(self, rate: Rate) -> bool:
        """Destroy a rate and wake the thread that sleeps in it."""
        was_created = self.destroy_timer(rate._timer)
        rate.destroy()
        return was_created

    def __keep_endpoint(
        self,
        end: TopicEnd[Any],
        events: EventCallbacks,
        group: CallbackGroup,
    ) -> None:
        self.__created_entities.append(end)
        bound_events = events.bind(self.handle, end.topic, group)
        end.event_handlers = bound_events.handlers
        limit_ns = to_qos(end.qos_profile, "pub").deadline_ns
        if limit_ns is not None and "deadline" in bound_events.tell:
            end._course_deadline = Deadline(self.handle, limit_ns, partial(bound_events.count, "deadline"))
        end.handle.watch(bound_events)

    def __overridden_profile(
        self,
        kind: Literal["publisher", "subscription"],
        topic: str,
        qos_profile: QoSProfile | int,
        options: QoSOverridingOptions | None,
    ) -> QoSProfile:
        if not isinstance(qos_profile, QoSProfile):
            if not isinstance(qos_profile, int):
                raise TypeError(f"Expected QoSProfile or int, but received {type(qos_profile)!r}")
            if qos_profile < 0:
                raise ValueError("history depth must be greater than or equal to zero")
            qos_profile = QoSProfile(depth=qos_profile)
        return apply_overrides(self, kind, topic, qos_profile, options)

    def __created_of(self, kind: type) -> Iterator[Any]:
        return (created for created in self.__created_entities if isinstance(created, kind))

    def __full_service_name(self, srv_type: Any, srv_name: str) -> str:
        """Validate a service's type and return its full name."""
        require_type(srv_type, "service")
        if not isinstance(srv_name, str):
            raise TypeError("__init__(): incompatible constructor arguments.")
        return self._course_resolve(srv_name, "service")

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or the alternative if it is not declared or has no value."""
        parameter = self.__parameter_store.values.get(name)
        if parameter is not None and parameter.type_ is not Parameter.Type.NOT_SET:
            return parameter
        unset = Parameter(name, Parameter.Type.NOT_SET)
        return unset if alternative_value is None else alternative_value

    def set_parameters(self, parameter_list: list[Parameter]) -> list[SetParametersResult]:
        """Set parameters one after the other and return a result for each.

        Raise at an undeclared parameter.
        """
        return [self.set_parameters_atomically([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set all parameters or none of them. Raise at an undeclared parameter."""
        may_be_undeclared = self.__allow_undeclared_parameters
        return self.__parameter_store.set(parameter_list, may_be_undeclared=may_be_undeclared)

    def add_pre_set_parameters_callback(self, callback: Pre) -> None:
        """Add a callback that runs before a change and returns the parameters to set."""
        # Unlike the others, rclpy does not check this callback here.
        self.__parameter_store.pre_set_callbacks.insert(0, callback)

    def add_on_set_parameters_callback(self, callback: On) -> None:
        """Add a validation callback; `callback(parameters)` returns a SetParametersResult."""
        _require_callable(callback)
        self.__parameter_store.on_set_callbacks.insert(0, callback)

    def add_post_set_parameters_callback(self, callback: Post) -> None:
        """Add a callback that runs after a change: `callback(parameters)`."""
        _require_callable(callback)
        self.__parameter_store.post_set_callbacks.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: Pre) -> None:
        """Remove the callback. Raise ValueError if it was not added."""
        self.__parameter_store.pre_set_callbacks.remove(callback)

    def remove_on_set_parameters_callback(self, callback: On) -> None:
        """Remove the callback. Raise ValueError if it was not added."""
        self.__parameter_store.on_set_callbacks.remove(callback)

    def remove_post_set_parameters_callback(self, callback: Post) -> None:
        """Remove the callback. Raise ValueError if it was not added."""
        self.__parameter_store.post_set_callbacks.remove(callback)

    def declare_parameter(
        self,
        name: str,
        value: Any = None,
        descriptor: ParameterDescriptor | None = None,
        ignore_override: bool = False,
    ) -> Parameter:
        """Declare a parameter and return it with its current value.

        Args:
            name: The parameter's name.
            value: The default value, or a `Parameter.Type` if there is no default.
            descriptor: The description and limits; `dynamic_typing` allows values of any type.
            ignore_override: Whether overrides from outside the program are ignored.
        """
        more: tuple[Any, ...] = ()
        if value is not None or descriptor is not None:
            more = (value, ParameterDescriptor() if descriptor is None else descriptor)
        return self.declare_parameters("", [(name, *more)], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Sequence[tuple[Any, ...]], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declare parameters in a namespace: (name), (name, value) or (name, value, descriptor)."""
        declared = self.__parameter_store.declare(namespace, parameters, ignore_override=ignore_override)
        self.handle.arguments.requested.parameters.update(parameter.name for parameter in declared)
        return declared

    def undeclare_parameter(self, name: str) -> None:
        """Remove a parameter. Raise an error if it is not declared or is read-only."""
        self.__parameter_store.undeclare(name)

    def set_descriptor(
        self,
        name: str,
        descriptor: ParameterDescriptor,
        alternative_value: ParameterValue | None = None,
    ) -> ParameterValue:
        """Replace a parameter's descriptor and return the resulting value.

        If the current value does not conform to the descriptor, `alternative_value` is set. Raises
        an error if neither conforms, or if the parameter is read-only or not declared.
        """
        if name not in self.__parameter_store.values:
            return self.get_parameter(name).get_parameter_value()
        if self.__parameter_store.descriptors[name].read_only:
            raise ParameterImmutableException(name)
        values = [self.get_parameter(name)]
        if alternative_value is not None:
            values.append(Parameter.from_parameter_msg(ParameterMsg(name=name, value=alternative_value)))
        store, reason = self.__parameter_store, ""
        for parameter in values:
            reason = find_rejection(parameter, descriptor, is_declared=True, new_descriptor=True)
            if not reason:
                # As in rclpy, no callback is called and no event is published.
                store.values[name], store.descriptors[name] = parameter, descriptor
                return parameter.get_parameter_value()
        raise InvalidParameterValueException(name, values[-1].value, reason)

    def has_parameter(self, name: str) -> bool:
        """Return whether a parameter is declared."""
        return name in self.__parameter_store.values

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter. Raise an error if it is not declared or has no value yet."""
        parameter = self.__parameter_store.values.get(name)
        if parameter is None:
            if self.__allow_undeclared_parameters:
                return Parameter(name, Parameter.Type.NOT_SET)
            raise ParameterNotDeclaredException(name)
        is_unset = parameter.type_ is Parameter.Type.NOT_SET
        if is_unset and not self.__parameter_store.descriptors[name].dynamic_typing:
            raise ParameterUninitializedException(name)
        return parameter

    def get_parameters(self, names: Sequence[str]) -> list[Parameter]:
        """Return several parameters, with the errors of `get_parameter`."""
        if not all(isinstance(name, str) for name in names):
            raise TypeError("All names must be instances of type str")
        return [self.get_parameter(name) for name in names]

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Return the parameters whose names begin with `prefix.`, by the rest of their names."""
        start = prefix + "." if prefix else prefix
        length, values = len(start), self.__parameter_store.values
        return {name[length:]: value for name, value in values.items() if name.startswith(start)}

    def get_parameter_type(self, name: str) -> int:
        """Return the number of a parameter's type.

        As in rclpy it is an int, but `Parameter.Type.NOT_SET` if the parameter is not declared and
        need not be.
        """
        if name in self.__parameter_store.values or not self.__allow_undeclared_parameters:
            self.describe_parameter(name)
            return int(self.__parameter_store.values[name].type_.value)
        return Parameter.Type.NOT_SET  # type: ignore[return-value]  # as in rclpy

    def get_parameter_types(self, names: Sequence[str]) -> list[int]:
        """Return the type numbers of several parameters."""
        if not all(isinstance(name, str) for name in names):
            raise TypeError("All names must be instances of type str")
        return [self.get_parameter_type(name) for name in names]

    def describe_parameter(self, name: str) -> ParameterDescriptor:
        """Return the descriptor of a parameter. Raise ParameterNotDeclaredException if undeclared."""
        if name not in self.__parameter_store.descriptors and not self.__allow_undeclared_parameters:
            raise ParameterNotDeclaredException(name)
        return self.__parameter_store.descriptors.get(name) or ParameterDescriptor()

    def describe_parameters(self, names: Sequence[str]) -> list[ParameterDescriptor]:
        """Return the descriptors of several parameters."""
        return [self.describe_parameter(name) for name in names]

    def list_parameters(self, prefixes: list[str], depth: int) -> ListParametersResult:
        """List names below prefixes, at most `depth` tokens deep (0: any), and their prefixes."""
        if not isinstance(prefixes, list):
            raise TypeError("The prefixes argument must be a list")
        if not all(isinstance(prefix, str) for prefix in prefixes):
            raise TypeError("All prefixes must be instances of type str")
        if not isinstance(depth, int):
            raise TypeError("The depth must be instance of type int")
        if depth < 0:
            raise ValueError("The depth must be greater than or equal to zero")

        def shown(name: str) -> bool:
            rests = [name[len(p) + 1 :] for p in prefixes if name.startswith(f"{p}.")] if prefixes else [name]
            return name in prefixes or any(not depth or rest.count(".") < depth for rest in rests)

        names = [name for name in self.__parameter_store.values if shown(name)]
        above = dict.fromkeys(name.rpartition(".")[0] for name in names if "." in name)
        return ListParametersResult(names=names, prefixes=list(above))


def _require_callable(callback: object) -> None:
    if not callable(callback):
        # rclpy passes the placeholder unfilled as well.
        raise TypeError("Callback must be callable, got {}", type(callback))


private_names.watch_names("Node", Node, private_names.USES, private_names.KEPT_BY_NODE)
