"""nav2's lifecycle_manager, which configures and activates a list of lifecycle nodes."""

from typing import Any

from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetState
from nav2_msgs.srv import ManageLifecycleNodes
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.exceptions import ParameterUninitializedException
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import current_graph

# The transitions, with the resulting state and the log message of each.
_TRANSITIONS = {
    Transition.TRANSITION_CONFIGURE: (State.PRIMARY_STATE_INACTIVE, "Configuring"),
    Transition.TRANSITION_CLEANUP: (State.PRIMARY_STATE_UNCONFIGURED, "Cleaning up"),
    Transition.TRANSITION_ACTIVATE: (State.PRIMARY_STATE_ACTIVE, "Activating"),
    Transition.TRANSITION_DEACTIVATE: (State.PRIMARY_STATE_INACTIVE, "Deactivating"),
    Transition.TRANSITION_UNCONFIGURED_SHUTDOWN: (State.PRIMARY_STATE_FINALIZED, "Shutting down"),
}
_UP = (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE)
_DOWN = (Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_CLEANUP)
# The transitions of each command, with the log messages before and after them.
_COMMANDS = {
    ManageLifecycleNodes.Request.STARTUP: (_UP, "Starting managed nodes bringup...", "are active"),
    ManageLifecycleNodes.Request.CONFIGURE: (_UP[:1], "Configuring managed nodes...", "are now configured"),
    ManageLifecycleNodes.Request.CLEANUP: (_DOWN[1:], "Cleaning up managed nodes...", "have been cleaned up"),
    ManageLifecycleNodes.Request.PAUSE: (_DOWN[:1], "Pausing managed nodes...", "have been paused"),
    ManageLifecycleNodes.Request.RESUME: (_UP[1:], "Resuming managed nodes...", "are active"),
    ManageLifecycleNodes.Request.RESET: (_DOWN, "Resetting managed nodes...", "have been reset"),
    ManageLifecycleNodes.Request.SHUTDOWN: (
        (*_DOWN, Transition.TRANSITION_UNCONFIGURED_SHUTDOWN),
        "Shutting down managed nodes...",
        "have been shut down",
    ),
}
# Interval between checks whether the nodes are available, and between log messages about missing
# ones [s].
_LOOK, _REPORT = 0.05, 2.0


class LifecycleManager(Node):
    """Configures and activates the nodes of the parameter `node_names`, in this order.

    A node that the launch has left out, such as a compiled server, is skipped with a warning. There
    are no bonds, so the end of a node is not detected.

    Raises:
        CourseError: The parameter `node_names` is missing.
    """

    def __init__(self) -> None:
        super().__init__("lifecycle_manager")
        self.get_logger().info("Creating")
        self.declare_parameter("node_names", Parameter.Type.STRING_ARRAY)
        self.declare_parameter("autostart", False)
        self.declare_parameter("bond_timeout", 4.0)
        self.declare_parameter("bond_respawn_max_duration", 10.0)
        self.declare_parameter("attempt_respawn_reconnection", True)
        try:
            self._managed = list(self.get_parameter("node_names").value)
        except ParameterUninitializedException:
            raise CourseError(
                "lifecycle_manager: the parameter node_names is missing, the names of the lifecycle nodes: "
                "parameters=[{'node_names': ['map_server'], 'autostart': True}]"
            ) from None
        self._is_active = False
        # Reentrant, because its callbacks wait for responses of the managed nodes.
        group = ReentrantCallbackGroup()
        name = self.get_name()
        manage, is_active = f"{name}/manage_nodes", f"{name}/is_active"
        self.create_service(ManageLifecycleNodes, manage, self._on_manage, callback_group=group)
        self.create_service(Trigger, is_active, self._on_is_active, callback_group=group)
        self.get_logger().info("Creating and initializing lifecycle service clients")
        self._links: dict[str, tuple[Any, Any]] = {
            name: (
                self.create_client(ChangeState, f"{name}/change_state", callback_group=group),
                self.create_client(GetState, f"{name}/get_state", callback_group=group),
            )
            for name in self._managed
        }
        self._look_count = 0
        self._timer = self.create_timer(_LOOK, self._wait_for_nodes, callback_group=group)

    async def _wait_for_nodes(self) -> None:
        """Start the nodes as soon as all of them exist."""
        for name in [name for name in self._managed if name in current_graph().left_out_nodes]:
            self.get_logger().warning(f"'{name}' cannot run here: the other nodes are managed without it.")
            self._managed.remove(name)
        self._look_count += 1
        for name in self._managed:
            get_state = self._links[name][1]
            if not get_state.service_is_ready():
                if self._look_count % round(_REPORT / _LOOK) == 0:
                    self.get_logger().info(f"Waiting for service {name}/get_state...")
                return
        self._timer.cancel()
        if self.get_parameter("autostart").value:
            await self._execute(ManageLifecycleNodes.Request.STARTUP)

    async def _execute(self, command: int) -> bool:
        transitions, before, after = _COMMANDS[command]
        self.get_logger().info(before)
        for transition in transitions:
            # Nodes are stopped in the reverse order.
            for name in self._managed if transition in _UP else reversed(self._managed):
                if not await self._change(name, transition):
                    self.get_logger().error("Failed to bring up all requested nodes. Aborting bringup.")
                    self._is_active = False
                    return False
        self.get_logger().info(f"Managed nodes {after}")
        self._is_active = after == "are active"
        return True

    async def _change(self, name: str, transition: int) -> bool:
        goal, text = _TRANSITIONS[transition]
        self.get_logger().info(f"{text} {name}")
        change_state, get_state = self._links[name]
        request = ChangeState.Request(transition=Transition(id=transition))
        answer = await change_state.call_async(request)
        state = await get_state.call_async(GetState.Request())
        if not answer.success or state.current_state.id != goal:
            self.get_logger().error(f"Failed to change state for node: {name}")
            return False
        return True

    async def _on_manage(
        self, request: ManageLifecycleNodes.Request, response: ManageLifecycleNodes.Response
    ) -> ManageLifecycleNodes.Response:
        if request.command in _COMMANDS:
            response.success = await self._execute(request.command)
        return response

    def _on_is_active(
        self,
        request: Trigger.Request,
        response: Trigger.Response,
    ) -> Trigger.Response:
        response.success = self._is_active
        return response
