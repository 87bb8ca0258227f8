"""Nodes, which ROS programs are made of."""

from dataclasses import dataclass, field
from typing import TypedDict

from rcl_interfaces.msg import Log, ParameterDescriptor, ParameterEvent

from course_lib.ros.graph import current_graph
from course_lib.ros.notices import replacements
from rclpy.clock import Clock
from rclpy.context import Context, get_default_context
from rclpy.duration import Duration
from rclpy.exceptions import NodeNameNonExistentError as NodeNameNonExistentError
from rclpy.exceptions import NotInitializedException
from rclpy.executors import Executor
from rclpy.impl import names, node_parameters
from rclpy.impl.arguments import Arguments, joined, parse
from rclpy.impl.node_handle import NodeHandle
from rclpy.impl.rcutils_logger import RcutilsLogger, Rosout
from rclpy.logging import get_logger
from rclpy.logging_service import LoggingService
from rclpy.parameter import Parameter
from rclpy.parameter_service import ParameterService
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_parameter_events
from rclpy.time_source import TimeSource
from rclpy.type_description_service import TypeDescriptionService

_ROSOUT = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL, lifespan=Duration(seconds=10))

_SAME_NAME = (
    "Publisher already registered for node name: '{0}'. If this is due to multiple nodes with the same name "
    "then all logs for the logger named '{0}' will go out over the existing publisher. As soon as any node "
    "with that name is destructed it will unregister the publisher, preventing any further logs for that "
    "name from being published on the rosout topic."
)


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


class Node(node_parameters.Node):
    """A node, with its publishers, subscriptions, timers and parameters.

    Args:
        node_name: Letters, digits and underscores; it does not begin with a digit.
        context: Where it lives; default: what `rclpy.init()` has begun.
        namespace: Put before its name and before its topics that do not begin with a slash.
        cli_args: A command line for this node alone; it counts more than that of `rclpy.init()`.
        use_global_arguments: Whether that of `rclpy.init()` counts, too.
        parameter_overrides: Values that count more than the defaults of its parameters.
        automatically_declare_parameters_from_overrides: Whether those are declared at once.
        start_parameter_services: Whether other nodes may see and change its parameters.
        allow_undeclared_parameters: Whether parameters may be used that were not declared.
        enable_rosout: Whether its log is published on /rosout.
        enable_logger_service: Whether other nodes may see and change the levels of its loggers.

    Raises:
        NotInitializedException: If `rclpy.init()` was not called.
        InvalidNodeNameException: If the name breaks the rules.
        InvalidNamespaceException: If the namespace does.
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
        context = context or get_default_context()
        if not context.is_valid:
            raise NotInitializedException("cannot create node")
        local = parse(cli_args or [])
        arguments = joined(local, context.arguments) if use_global_arguments else local
        super().__init__(_enter_graph(context, node_name, namespace or "", arguments))
        self._logger = get_logger(self.handle.logger_name)
        self._settle_same_names()
        context.on_shutdown(self._leave_graph)
        self._rosout = self.create_publisher(Log, "/rosout", _ROSOUT) if enable_rosout else None
        if self._rosout is not None:
            current_graph().part(Rosout).publish.setdefault(self.handle.logger_name, self._publish_log)
        events = self.create_publisher(ParameterEvent, "/parameter_events", qos_profile_parameter_events)
        overrides = arguments.parameters(self.handle.full_name)
        overrides |= {parameter.name: parameter for parameter in parameter_overrides or []}
        self._keep_parameters(overrides, allow_undeclared_parameters, events)
        if automatically_declare_parameters_from_overrides:
            given = [(name, parameter.value, ParameterDescriptor()) for name, parameter in overrides.items()]
            self.declare_parameters("", given, ignore_override=True)
        self._declare_own_parameters()
        if start_parameter_services:
            ParameterService(self)
        if enable_logger_service:
            LoggingService(self)

    def _declare_own_parameters(self) -> None:
        """Declare what every node of ROS has, unless an override did; `use_sim_time` sets its clock."""
        self._time_source = TimeSource(node=self)
        self._time_source.attach_clock(self._clock)
        TypeDescriptionService(self)

    @property
    def context(self) -> Context:
        """The context that it lives in."""
        return self.handle.context

    @property
    def executor(self) -> Executor | None:
        """The executor that it was added to last."""
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
        """Return its name."""
        return self.handle.name

    def get_namespace(self) -> str:
        """Return its namespace."""
        return self.handle.namespace

    def get_fully_qualified_name(self) -> str:
        """Return its namespace and its name as one."""
        return self.handle.full_name

    def get_clock(self) -> Clock:
        """Return its clock."""
        return self._clock

    def get_logger(self) -> RcutilsLogger:
        """Return its logger."""
        return self._logger

    def destroy_node(self) -> None:
        """Destroy the node with everything in it; doing so again changes nothing."""
        self.handle.graph.wake(self.handle.id)  # so that its partners count down
        while self._created:
            self._created.pop().destroy()
        self._leave_graph()

    def _settle_same_names(self) -> None:
        """Register the node; in a notebook it replaces one of the same name, elsewhere ROS warns of that."""
        nodes, name = current_graph().part(OwnNodes).by_id, self.get_fully_qualified_name()
        namesakes = [other for other in nodes.values() if other.get_fully_qualified_name() == name]
        nodes[self.handle.id] = self
        if namesakes and not self.handle.graph.notebook:
            get_logger("rcl.logging_rosout").warning(_SAME_NAME.format(self.handle.logger_name))
        elif namesakes:
            replacements.add(name)
            for other in namesakes:
                other.destroy_node()

    def _leave_graph(self) -> None:
        current_graph().part(OwnNodes).by_id.pop(self.handle.id, None)
        rosout = current_graph().part(Rosout).publish
        if rosout.get(self.handle.logger_name) == self._publish_log:
            del rosout[self.handle.logger_name]
        self.handle.leave()

    def _publish_log(self, message: Log) -> None:
        if self._rosout is not None and self.context.is_valid:
            self._rosout.publish(message)


@dataclass
class OwnNodes:
    """The nodes that one program has made in a run and not destroyed."""

    by_id: dict[int, Node] = field(default_factory=dict)  # in the graph


def _enter_graph(context: Context, name: str, namespace: str, arguments: Arguments) -> NodeHandle:
    """Check the names and enter the graph; a namespace may be written without its leading slash."""
    names.validate_node_name(name)
    name = arguments.renamed(name, "__node", name)
    namespace = arguments.renamed(name, "__ns", namespace)
    absolute = namespace if namespace.startswith("/") else f"/{namespace}"
    names.validate_namespace(absolute)
    return NodeHandle(context, name, absolute, arguments)
