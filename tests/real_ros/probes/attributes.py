# mypy: ignore-errors
"""The parameters of rclpy's functions, the bases of its classes, and the attributes that can be assigned."""

import importlib
import inspect
from typing import Any

import rclpy
import rclpy.exceptions
from probing import Fibonacci, lines, main
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import JumpThreshold
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, LifecycleState
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler
from rclpy.qos import QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.time_source import TimeSource
from std_msgs.msg import String
from std_srvs.srv import SetBool

# The functions and classes of each module.
FUNCTIONS = {
    "rclpy": """
        Context Future Parameter get_default_context get_global_executor
        get_rmw_implementation_identifier init install_signal_handlers ok shutdown spin spin_once
        spin_until_future_complete try_shutdown uninstall_signal_handlers
    """,
    "rclpy.action": "ActionClient ActionServer get_action_names_and_types",
    "rclpy.action.client": """
        ActionClient ActionClient.destroy ActionClient.send_goal ActionClient.send_goal_async
        ActionClient.server_is_ready ActionClient.wait_for_server ClientGoalHandle
        ClientGoalHandle.cancel_goal ClientGoalHandle.cancel_goal_async ClientGoalHandle.get_result
        ClientGoalHandle.get_result_async
    """,
    "rclpy.action.server": """
        ActionServer ActionServer.destroy ActionServer.notify_execute
        ActionServer.register_cancel_callback ActionServer.register_execute_callback
        ActionServer.register_goal_callback ActionServer.register_handle_accepted_callback
        ServerGoalHandle ServerGoalHandle.abort ServerGoalHandle.canceled ServerGoalHandle.destroy
        ServerGoalHandle.publish_feedback ServerGoalHandle.succeed default_cancel_callback
        default_goal_callback default_handle_accepted_callback
    """,
    "rclpy.callback_groups": """
        CallbackGroup CallbackGroup.add_entity CallbackGroup.beginning_execution
        CallbackGroup.can_execute CallbackGroup.ending_execution CallbackGroup.has_entity
        MutuallyExclusiveCallbackGroup MutuallyExclusiveCallbackGroup.add_entity
        MutuallyExclusiveCallbackGroup.beginning_execution
        MutuallyExclusiveCallbackGroup.can_execute MutuallyExclusiveCallbackGroup.ending_execution
        MutuallyExclusiveCallbackGroup.has_entity ReentrantCallbackGroup
        ReentrantCallbackGroup.add_entity ReentrantCallbackGroup.beginning_execution
        ReentrantCallbackGroup.can_execute ReentrantCallbackGroup.ending_execution
        ReentrantCallbackGroup.has_entity
    """,
    "rclpy.client": """
        Client.call Client.call_async Client.configure_introspection Client.destroy
        Client.get_pending_request Client.remove_pending_request Client.service_is_ready
        Client.wait_for_service
    """,
    "rclpy.clock": """
        Clock Clock.create_jump_callback Clock.now Clock.sleep_for Clock.sleep_until JumpHandle
        JumpHandle.unregister JumpThreshold ROSClock ROSClock.create_jump_callback ROSClock.now
        ROSClock.set_ros_time_override ROSClock.sleep_for ROSClock.sleep_until TimeJump
    """,
    "rclpy.context": """
        Context Context.get_domain_id Context.init Context.ok Context.on_shutdown Context.shutdown
        Context.try_shutdown
    """,
    "rclpy.duration": "Duration Duration.from_msg Duration.to_msg",
    "rclpy.exceptions": """
        InvalidNamespaceException InvalidNodeNameException InvalidParameterException
        InvalidParameterTypeException InvalidParameterValueException InvalidServiceNameException
        InvalidTopicNameException NameValidationException NotInitializedException
        ParameterAlreadyDeclaredException ParameterException ParameterImmutableException
        ParameterNotDeclaredException ParameterUninitializedException ROSInterruptException
    """,
    "rclpy.executors": """
        ConditionReachedException Executor Executor.add_node Executor.can_execute
        Executor.create_task Executor.get_nodes Executor.remove_node Executor.shutdown Executor.spin
        Executor.spin_once Executor.spin_once_until_future_complete
        Executor.spin_until_future_complete Executor.wake ExternalShutdownException
        MultiThreadedExecutor MultiThreadedExecutor.add_node MultiThreadedExecutor.can_execute
        MultiThreadedExecutor.create_task MultiThreadedExecutor.get_nodes
        MultiThreadedExecutor.remove_node MultiThreadedExecutor.shutdown MultiThreadedExecutor.spin
        MultiThreadedExecutor.spin_once MultiThreadedExecutor.spin_once_until_future_complete
        MultiThreadedExecutor.spin_until_future_complete MultiThreadedExecutor.wake
        ShutdownException SingleThreadedExecutor SingleThreadedExecutor.add_node
        SingleThreadedExecutor.can_execute SingleThreadedExecutor.create_task
        SingleThreadedExecutor.get_nodes SingleThreadedExecutor.remove_node
        SingleThreadedExecutor.shutdown SingleThreadedExecutor.spin SingleThreadedExecutor.spin_once
        SingleThreadedExecutor.spin_once_until_future_complete
        SingleThreadedExecutor.spin_until_future_complete SingleThreadedExecutor.wake
        TimeoutException TimeoutObject await_or_execute
    """,
    "rclpy.expand_topic_name": "expand_topic_name",
    "rclpy.guard_condition": "GuardCondition GuardCondition.destroy GuardCondition.trigger",
    "rclpy.lifecycle": """
        LifecycleNode LifecycleNodeMixin LifecyclePublisher LifecycleState ManagedEntity Node
        NodeMixin Publisher SimpleManagedEntity State
    """,
    "rclpy.lifecycle.managed_entity": """
        ManagedEntity ManagedEntity.on_activate ManagedEntity.on_cleanup ManagedEntity.on_configure
        ManagedEntity.on_deactivate ManagedEntity.on_error ManagedEntity.on_shutdown
        SimpleManagedEntity SimpleManagedEntity.on_activate SimpleManagedEntity.on_cleanup
        SimpleManagedEntity.on_configure SimpleManagedEntity.on_deactivate
        SimpleManagedEntity.on_error SimpleManagedEntity.on_shutdown
        SimpleManagedEntity.when_enabled
    """,
    "rclpy.lifecycle.node": """
        LifecycleNode LifecycleNode.add_managed_entity LifecycleNode.add_on_set_parameters_callback
        LifecycleNode.add_post_set_parameters_callback LifecycleNode.add_pre_set_parameters_callback
        LifecycleNode.add_waitable LifecycleNode.count_clients LifecycleNode.count_publishers
        LifecycleNode.count_services LifecycleNode.count_subscribers LifecycleNode.create_client
        LifecycleNode.create_guard_condition LifecycleNode.create_lifecycle_publisher
        LifecycleNode.create_publisher LifecycleNode.create_rate LifecycleNode.create_service
        LifecycleNode.create_subscription LifecycleNode.create_timer LifecycleNode.declare_parameter
        LifecycleNode.declare_parameters LifecycleNode.describe_parameter
        LifecycleNode.describe_parameters LifecycleNode.destroy_client
        LifecycleNode.destroy_guard_condition LifecycleNode.destroy_lifecycle_publisher
        LifecycleNode.destroy_node LifecycleNode.destroy_publisher LifecycleNode.destroy_rate
        LifecycleNode.destroy_service LifecycleNode.destroy_subscription LifecycleNode.destroy_timer
        LifecycleNode.get_client_names_and_types_by_node LifecycleNode.get_clock
        LifecycleNode.get_fully_qualified_name LifecycleNode.get_fully_qualified_node_names
        LifecycleNode.get_logger LifecycleNode.get_name LifecycleNode.get_namespace
        LifecycleNode.get_node_names LifecycleNode.get_node_names_and_namespaces
        LifecycleNode.get_node_names_and_namespaces_with_enclaves LifecycleNode.get_parameter
        LifecycleNode.get_parameter_or LifecycleNode.get_parameter_type
        LifecycleNode.get_parameter_types LifecycleNode.get_parameters
        LifecycleNode.get_parameters_by_prefix LifecycleNode.get_publisher_names_and_types_by_node
        LifecycleNode.get_publishers_info_by_topic LifecycleNode.get_service_names_and_types
        LifecycleNode.get_service_names_and_types_by_node
        LifecycleNode.get_subscriber_names_and_types_by_node
        LifecycleNode.get_subscriptions_info_by_topic LifecycleNode.get_topic_names_and_types
        LifecycleNode.has_parameter LifecycleNode.list_parameters LifecycleNode.on_activate
        LifecycleNode.on_cleanup LifecycleNode.on_configure LifecycleNode.on_deactivate
        LifecycleNode.on_error LifecycleNode.on_shutdown
        LifecycleNode.remove_on_set_parameters_callback
        LifecycleNode.remove_post_set_parameters_callback
        LifecycleNode.remove_pre_set_parameters_callback LifecycleNode.remove_waitable
        LifecycleNode.resolve_service_name LifecycleNode.resolve_topic_name
        LifecycleNode.set_descriptor LifecycleNode.set_parameters
        LifecycleNode.set_parameters_atomically LifecycleNode.trigger_activate
        LifecycleNode.trigger_cleanup LifecycleNode.trigger_configure
        LifecycleNode.trigger_deactivate LifecycleNode.trigger_shutdown
        LifecycleNode.undeclare_parameter LifecycleNode.wait_for_node LifecycleNodeMixin
        LifecycleNodeMixin.add_managed_entity LifecycleNodeMixin.create_lifecycle_publisher
        LifecycleNodeMixin.destroy_lifecycle_publisher LifecycleNodeMixin.on_activate
        LifecycleNodeMixin.on_cleanup LifecycleNodeMixin.on_configure
        LifecycleNodeMixin.on_deactivate LifecycleNodeMixin.on_error LifecycleNodeMixin.on_shutdown
        LifecycleNodeMixin.trigger_activate LifecycleNodeMixin.trigger_cleanup
        LifecycleNodeMixin.trigger_configure LifecycleNodeMixin.trigger_deactivate
        LifecycleNodeMixin.trigger_shutdown LifecycleState LifecycleState.count LifecycleState.index
    """,
    "rclpy.lifecycle.publisher": """
        LifecyclePublisher LifecyclePublisher.assert_liveliness LifecyclePublisher.destroy
        LifecyclePublisher.get_subscription_count LifecyclePublisher.on_activate
        LifecyclePublisher.on_cleanup LifecyclePublisher.on_configure
        LifecyclePublisher.on_deactivate LifecyclePublisher.on_error LifecyclePublisher.on_shutdown
        LifecyclePublisher.publish LifecyclePublisher.wait_for_all_acked
        LifecyclePublisher.when_enabled
    """,
    "rclpy.logging": """
        get_logger get_logger_effective_level get_logger_level get_logging_severity_from_string
        set_logger_level
    """,
    "rclpy.logging_service": "LoggingService",
    "rclpy.node": """
        Node Node.add_on_set_parameters_callback Node.add_post_set_parameters_callback
        Node.add_pre_set_parameters_callback Node.add_waitable Node.count_clients
        Node.count_publishers Node.count_services Node.count_subscribers Node.create_client
        Node.create_guard_condition Node.create_publisher Node.create_rate Node.create_service
        Node.create_subscription Node.create_timer Node.declare_parameter Node.declare_parameters
        Node.describe_parameter Node.describe_parameters Node.destroy_client
        Node.destroy_guard_condition Node.destroy_node Node.destroy_publisher Node.destroy_rate
        Node.destroy_service Node.destroy_subscription Node.destroy_timer
        Node.get_client_names_and_types_by_node Node.get_clock Node.get_fully_qualified_name
        Node.get_fully_qualified_node_names Node.get_logger Node.get_name Node.get_namespace
        Node.get_node_names Node.get_node_names_and_namespaces
        Node.get_node_names_and_namespaces_with_enclaves Node.get_parameter Node.get_parameter_or
        Node.get_parameter_type Node.get_parameter_types Node.get_parameters
        Node.get_parameters_by_prefix Node.get_publisher_names_and_types_by_node
        Node.get_publishers_info_by_topic Node.get_service_names_and_types
        Node.get_service_names_and_types_by_node Node.get_subscriber_names_and_types_by_node
        Node.get_subscriptions_info_by_topic Node.get_topic_names_and_types Node.has_parameter
        Node.list_parameters Node.remove_on_set_parameters_callback
        Node.remove_post_set_parameters_callback Node.remove_pre_set_parameters_callback
        Node.remove_waitable Node.resolve_service_name Node.resolve_topic_name Node.set_descriptor
        Node.set_parameters Node.set_parameters_atomically Node.undeclare_parameter
        Node.wait_for_node
    """,
    "rclpy.parameter": """
        Parameter Parameter.from_parameter_msg Parameter.get_parameter_value
        Parameter.to_parameter_msg get_parameter_value parameter_dict_from_yaml_file
        parameter_value_to_python
    """,
    "rclpy.parameter_client": """
        AsyncParameterClient AsyncParameterClient.delete_parameters
        AsyncParameterClient.describe_parameters AsyncParameterClient.get_parameter_types
        AsyncParameterClient.get_parameters AsyncParameterClient.list_parameters
        AsyncParameterClient.load_parameter_file AsyncParameterClient.load_parameter_file_atomically
        AsyncParameterClient.services_are_ready AsyncParameterClient.set_parameters
        AsyncParameterClient.set_parameters_atomically AsyncParameterClient.wait_for_services
    """,
    "rclpy.parameter_event_handler": """
        ParameterCallbackHandle ParameterEventCallbackHandle ParameterEventHandler
        ParameterEventHandler.add_parameter_callback
        ParameterEventHandler.add_parameter_event_callback ParameterEventHandler.destroy
        ParameterEventHandler.get_parameter_from_event
        ParameterEventHandler.get_parameters_from_event
        ParameterEventHandler.remove_parameter_callback
        ParameterEventHandler.remove_parameter_event_callback
    """,
    "rclpy.parameter_service": "ParameterService",
    "rclpy.publisher": """
        Publisher.assert_liveliness Publisher.destroy Publisher.get_subscription_count
        Publisher.publish Publisher.wait_for_all_acked
    """,
    "rclpy.qos": """
        InvalidQoSProfileException QoSProfile qos_check_compatible qos_policy_name_from_kind
    """,
    "rclpy.qos_overriding_options": """
        InvalidQosOverridesError QoSOverridingOptions QoSOverridingOptions.with_default_policies
    """,
    "rclpy.serialization": "deserialize_message serialize_message",
    "rclpy.service": "Service.configure_introspection Service.destroy Service.send_response",
    "rclpy.signals": "install_signal_handlers uninstall_signal_handlers",
    "rclpy.subscription": "Subscription.destroy Subscription.get_publisher_count",
    "rclpy.task": """
        Future Future.add_done_callback Future.cancel Future.cancelled Future.done Future.exception
        Future.remove_done_callback Future.result Future.set_exception Future.set_result Task
        Task.add_done_callback Task.cancel Task.cancelled Task.done Task.exception Task.executing
        Task.remove_done_callback Task.result Task.set_exception Task.set_result
    """,
    "rclpy.time": "Time Time.from_msg Time.seconds_nanoseconds Time.to_msg",
    "rclpy.time_source": """
        TimeSource TimeSource.attach_clock TimeSource.attach_node TimeSource.clock_callback
        TimeSource.detach_node
    """,
    "rclpy.timer": """
        Rate Rate.destroy Rate.sleep Timer.cancel Timer.destroy Timer.is_canceled Timer.reset
        Timer.time_since_last_call Timer.time_until_next_call
    """,
    "rclpy.topic_endpoint_info": "TopicEndpointInfo",
    "rclpy.topic_or_service_is_hidden": "topic_or_service_is_hidden",
    "rclpy.type_description_service": "TypeDescriptionService",
    "rclpy.type_hash": "TypeHash",
    "rclpy.utilities": """
        get_available_rmw_implementations get_default_context get_rmw_implementation_identifier ok
        remove_ros_args timeout_sec_to_nsec
    """,
    "rclpy.validate_full_topic_name": "validate_full_topic_name",
    "rclpy.validate_namespace": "validate_namespace",
    "rclpy.validate_node_name": "validate_node_name",
    "rclpy.validate_parameter_name": "validate_parameter_name",
    "rclpy.validate_topic_name": "validate_topic_name",
    "rclpy.wait_for_message": "wait_for_message",
}
EXCEPTIONS = """
    InvalidHandle InvalidNamespaceException
    InvalidNodeNameException InvalidParameterException InvalidParameterTypeException
    InvalidParameterValueException InvalidServiceNameException InvalidTopicNameException
    NameValidationException NotInitializedException
    ParameterAlreadyDeclaredException ParameterException ParameterImmutableException
    ParameterNotDeclaredException ParameterUninitializedException
    ROSInterruptException
"""
RAISED = {
    "parameter": ("ParameterException", "Unknown", ["a", "b"]),
    "parameter_alone": ("ParameterException", "Unknown"),
    "immutable": ("ParameterImmutableException", "a"),
    "not_declared": ("ParameterNotDeclaredException", ["a"]),
    "already_declared": ("ParameterAlreadyDeclaredException", "a"),
    "uninitialized": ("ParameterUninitializedException", "a"),
    "name": ("InvalidParameterException", ""),
    "value": ("InvalidParameterValueException", "a", 3, "too large"),
    "type": ("InvalidParameterTypeException", Parameter("a", value=3), "STRING"),
    "type_of_member": ("InvalidParameterTypeException", Parameter("a", value=3.5), Parameter.Type.STRING),
    "validation": ("NameValidationException", "robot name", "a b", "has a space", 1),
    "topic": ("InvalidTopicNameException", "a b", "has a space", 1),
    "service": ("InvalidServiceNameException", "a b", "has a space", 1),
    "node": ("InvalidNodeNameException", "a b", "has a space", 1),
    "namespace": ("InvalidNamespaceException", "a b", "has a space", 1),
    "handle": ("InvalidHandle", "is gone"),
    "not_initialized": ("NotInitializedException",),
    "not_initialized_because": ("NotInitializedException", "no context"),
    "interrupt": ("ROSInterruptException",),
}
ATTRIBUTES = {
    "action_server": "action_type",
    "client": "callback_group context logger_name qos_profile service_name srv_name srv_type",
    "clock": "clock_type ros_time_is_active",
    "duration": "nanoseconds",
    "group": "entities",
    "guard": "callback callback_group",
    "handler": "node parameter_event_subscription",
    "logger": "name",
    "managed": """
        PARAM_REL_TOL clients context default_callback_group executor guards publishers services
        subscriptions timers
    """,
    "managed_publisher": """
        event_handlers is_activated logger_name msg_type qos_profile topic topic_name
    """,
    "many": "context",
    "node": """
        PARAM_REL_TOL clients context default_callback_group executor guards publishers services
        subscriptions timers
    """,
    "overriding": "callback entity_id policy_kinds",
    "parameter": "Type name type_ value",
    "parameter_client": "node remote_node_name",
    "profile": """
        avoid_ros_namespace_conventions deadline depth durability history lifespan liveliness
        liveliness_lease_duration reliability
    """,
    "publisher": "event_handlers logger_name msg_type qos_profile topic topic_name",
    "publisher_events": """
        deadline incompatible_qos incompatible_type liveliness matched use_default_callbacks
    """,
    "service": """
        callback callback_group logger_name qos_profile service_name srv_name srv_type
    """,
    "single": "context",
    "state": "label state_id",
    "subscription": """
        callback callback_group event_handlers logger_name msg_type qos_profile raw topic
        topic_name
    """,
    "subscription_events": """
        deadline incompatible_qos incompatible_type liveliness matched message_lost
        use_default_callbacks
    """,
    "threshold": "min_backward min_forward on_clock_change",
    "time": "clock_type nanoseconds",
    "time_source": "ros_time_is_active",
    "timer": "callback callback_group clock timer_period_ns",
}


def _static(module: str, name: str) -> Any:
    """Return a function of a module or class; of a class its constructor."""
    found: Any = importlib.import_module(module)
    for part in name.split("."):
        found = inspect.getattr_static(found, part)
        found = getattr(found, "__func__", found)
    return found.__init__ if inspect.isclass(found) else found


def _parameters(module: str, name: str) -> list[str]:
    """Return the parameters of a function with their kinds and defaults."""
    kinds = {"VAR_POSITIONAL": "*", "VAR_KEYWORD": "**", "KEYWORD_ONLY": ">", "POSITIONAL_ONLY": "<"}
    found = []
    for parameter in inspect.signature(_static(module, name)).parameters.values():
        default = parameter.default
        is_plain = default is None or type(default) in (int, float, str, bool, tuple)
        text = repr(default) if is_plain else getattr(default, "__name__", type(default).__name__)
        given = "" if default is parameter.empty else f"={text}"
        found.append(f"{kinds.get(parameter.kind.name, '')}{parameter.name}{given}")
    return found


def _bases(name: str) -> list[str]:
    """Return the public bases of an exception; those of the kit are left out."""
    kinds = inspect.getmro(getattr(rclpy.exceptions, name))
    return [kind.__name__ for kind in kinds if not kind.__module__.startswith("course_lib")]


def _raised(name: str, *arguments: Any) -> str:
    return str(getattr(rclpy.exceptions, name)(*arguments))


def _thing(kind: str) -> Any:
    node, executor = Node("plain"), SingleThreadedExecutor()
    makers = {
        "node": lambda: node,
        "managed": lambda: LifecycleNode("managed"),
        "single": lambda: executor,
        "many": lambda: MultiThreadedExecutor(2),
        "future": rclpy.Future,
        "task": lambda: executor.create_task(print),
        "publisher": lambda: node.create_publisher(String, "t", 1),
        "managed_publisher": lambda: LifecycleNode("m").create_lifecycle_publisher(String, "u", 1),
        "subscription": lambda: node.create_subscription(String, "t", lambda message: None, 1),
        "client": lambda: node.create_client(SetBool, "s"),
        "service": lambda: node.create_service(SetBool, "s", print),
        "timer": lambda: node.create_timer(1.0, print),
        "guard": lambda: node.create_guard_condition(print),
        "group": MutuallyExclusiveCallbackGroup,
        "clock": node.get_clock,
        "time": lambda: node.get_clock().now(),
        "logger": node.get_logger,
        "duration": Duration,
        "parameter": lambda: Parameter("p"),
        "profile": lambda: QoSProfile(depth=1),
        "action_server": lambda: ActionServer(node, Fibonacci, "f", print),
        "action_client": lambda: ActionClient(node, Fibonacci, "f"),
        "parameter_client": lambda: AsyncParameterClient(node, "plain"),
        "handler": lambda: ParameterEventHandler(node),
        "time_source": lambda: TimeSource(node=node),
        "context": rclpy.get_default_context,
        "threshold": lambda: JumpThreshold(min_forward=None, min_backward=None),
        "publisher_events": PublisherEventCallbacks,
        "subscription_events": SubscriptionEventCallbacks,
        "overriding": lambda: QoSOverridingOptions([]),
        "state": lambda: LifecycleState("a", 1),
    }
    return makers[kind]()


def _assigned(thing: Any, name: str) -> str:
    """Assign the value that an attribute has."""
    try:
        setattr(thing, name, getattr(thing, name))
    except AttributeError as error:
        return type(error).__name__
    return "can be assigned"


def _later(function: Any, *arguments: Any) -> Any:
    return lambda: function(*arguments)


def _all_parameters(module: str) -> dict[str, list[str]]:
    return {name: _parameters(module, name) for name in FUNCTIONS[module].split()}


def _all_assigned(kind: str) -> dict[str, str]:
    thing = _thing(kind)
    return {name: _assigned(thing, name) for name in ATTRIBUTES[kind].split()}


lines("parameters", **{module: _later(_all_parameters, module) for module in FUNCTIONS})
lines("bases", **{name: _later(_bases, name) for name in EXCEPTIONS.split()})
lines("raised", **{name: _later(_raised, *arguments) for name, arguments in RAISED.items()})
lines("assigned", **{kind: _later(_all_assigned, kind) for kind in ATTRIBUTES})

if __name__ == "__main__":
    main()
