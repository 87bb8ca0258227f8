"""Time sources: a node's clocks follow the topic /clock while `use_sim_time` is true."""

import weakref

from rcl_interfaces.msg import SetParametersResult
from rosgraph_msgs.msg import Clock as ClockMessage

from course_lib.ros.notices import print_notice
from rclpy.clock import Clock, ROSClock
from rclpy.impl.node_handle import AnyNode, NodeHandle
from rclpy.logging import get_logger
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription
from rclpy.time import ClockType, Time

CLOCK_TOPIC = "/clock"
USE_SIM_TIME_NAME = "use_sim_time"
# Robot time without a publisher of /clock after which a hint is printed.
PATIENCE_NS = 2_000_000_000
_QOS = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


class TimeSource:
    """Overrides the time of its clocks by /clock while `use_sim_time` of its node is true.

    Until the first message the clocks show 0. The subscription is in the node's default callback
    group, so the clocks do not advance while a callback of that group runs.
    """

    def __init__(self, *, node: AnyNode | None = None) -> None:
        self._clock_sub: Subscription[ClockMessage] | None = None
        self._node_weak_ref: weakref.ref[AnyNode] | None = None
        # A dict serves as an ordered set.
        self._associated_clocks: dict[ROSClock, None] = {}
        self._last_time_set = Time(clock_type=ClockType.ROS_TIME)
        self._ros_time_is_active = False
        if node is not None:
            self.attach_node(node)

    @property
    def ros_time_is_active(self) -> bool:
        """True while the clocks follow /clock."""
        return self._ros_time_is_active

    @ros_time_is_active.setter
    def ros_time_is_active(self, enabled: bool) -> None:
        if self._ros_time_is_active == enabled:
            return
        self._ros_time_is_active = enabled
        for clock in self._associated_clocks:
            clock._set_ros_time_is_active(enabled)
        node = self._get_node()
        if enabled and node is not None and self._clock_sub is None:
            self._clock_sub = node.create_subscription(ClockMessage, CLOCK_TOPIC, self.clock_callback, _QOS)
            handle = node.handle
            handle.graph.call_at(handle.graph.now_ns + PATIENCE_NS, self.__hint, node=handle.id, entity=0)
        elif not enabled and node is not None and self._clock_sub is not None:
            node.destroy_subscription(self._clock_sub)
            self._clock_sub = None

    def attach_node(self, node: AnyNode) -> None:
        """Follow a node's `use_sim_time`. The parameter is declared if the node has not done so."""
        if not isinstance(getattr(node, "handle", None), NodeHandle):
            raise TypeError("Node must be of type rclpy.node.Node")
        if self._node_weak_ref is not None:
            self.detach_node()
        self._node_weak_ref = weakref.ref(node)
        if not node.has_parameter(USE_SIM_TIME_NAME):
            node.declare_parameter(USE_SIM_TIME_NAME, False)
        parameter, logger = node.get_parameter(USE_SIM_TIME_NAME), get_logger(node.handle.logger_name)
        if parameter.type_ is Parameter.Type.BOOL:
            self.ros_time_is_active = parameter.value
        elif parameter.type_ is Parameter.Type.NOT_SET:
            logger.debug(f"'{USE_SIM_TIME_NAME}' parameter not set, using wall time by default")
        else:
            logger.error(
                f"Invalid type for parameter '{USE_SIM_TIME_NAME}' {parameter.type_!r} should be bool"
            )
        node.add_on_set_parameters_callback(self._on_parameter_event)

    def detach_node(self) -> None:
        """Stop following the node. The clocks keep their current time."""
        if self._clock_sub is not None:
            node = self._get_node()
            if node is None:
                raise RuntimeError("Unable to destroy previously created clock subscription")
            node.destroy_subscription(self._clock_sub)
        self._clock_sub = self._node_weak_ref = None

    def attach_clock(self, clock: Clock) -> None:
        """Let this time source set the time of a clock."""
        if not isinstance(clock, ROSClock):
            raise ValueError("Only clocks with type ROS_TIME can be attached.")
        clock.set_ros_time_override(self._last_time_set)
        clock._set_ros_time_is_active(self.ros_time_is_active)
        self._associated_clocks[clock] = None

    def clock_callback(self, msg: ClockMessage) -> None:
        """Set the time of all clocks."""
        self._last_time_set = Time.from_msg(msg.clock)
        for clock in self._associated_clocks:
            clock.set_ros_time_override(self._last_time_set)

    def _on_parameter_event(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Follow a change of `use_sim_time`. Reject a value that is not a bool."""
        for parameter in parameter_list:
            if parameter.name != USE_SIM_TIME_NAME:
                continue
            if parameter.type_ is Parameter.Type.BOOL:
                self.ros_time_is_active = parameter.value
                break
            reason = f"{USE_SIM_TIME_NAME} parameter set to something besides a bool"
            node = self._get_node()
            if node is not None:
                get_logger(node.handle.logger_name).error(reason)
            return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def __hint(self) -> None:
        """Print a hint that the clock does not advance because /clock has no publisher."""
        node, clock = self._get_node(), self._clock_sub
        if node is None or node.handle.has_left or clock is None or clock._course_partner_count():
            return
        if not self._last_time_set.nanoseconds:
            name, topic = node.handle.full_name, clock.topic_name
            print_notice(
                f"hint: {name} has use_sim_time, and nobody publishes {topic}: its time stands at "
                "0 and its timers wait. Start a simulation or `ros2 bag play --clock`, or set "
                "use_sim_time to false."
            )

    def _get_node(self) -> AnyNode | None:
        return None if self._node_weak_ref is None else self._node_weak_ref()
