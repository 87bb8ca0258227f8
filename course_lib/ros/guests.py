"""Names that programs import from modules which only import them in ROS, as `rclpy.node.Publisher`."""

_ERRORS = (
    "InvalidHandle InvalidParameterTypeException InvalidParameterValueException InvalidTopicNameException "
    "ParameterAlreadyDeclaredException ParameterImmutableException ParameterNotDeclaredException "
    "ParameterUninitializedException"
)
_PARAMETER_SERVICES = (
    "DescribeParameters GetParameterTypes GetParameters ListParameters SetParameters SetParametersAtomically"
)
_EVENTS = "PublisherEventCallbacks SubscriptionEventCallbacks"
_GROUPS = "CallbackGroup MutuallyExclusiveCallbackGroup ReentrantCallbackGroup"
# module -> the modules that its guests are from; rclpy 7.1 (Jazzy)
GUESTS = {
    "rclpy.client": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.clock": "Clock",
        "rclpy.context": "Context",
        "rclpy.qos": "QoSProfile",
    },
    "rclpy.executors": {
        "concurrent.futures": "ThreadPoolExecutor",
        "rclpy.client": "Client",
        "rclpy.clock": "Clock",
        "rclpy.clock_type": "ClockType",
        "rclpy.exceptions": "InvalidHandle",
        "rclpy.guard_condition": "GuardCondition",
        "rclpy.service": "Service",
        "rclpy.subscription": "Subscription",
        "rclpy.task": "Future",
        "rclpy.timer": "Timer",
        "rclpy.utilities": "get_default_context",
    },
    "rclpy.lifecycle.node": {"rclpy.qos": "QoSProfile", "rclpy.service": "Service"},
    "rclpy.node": {
        "rcl_interfaces.msg": "FloatingPointRange IntegerRange ListParametersResult ParameterType "
        "ParameterValue SetParametersResult",
        "rcl_interfaces.srv": "ListParameters",
        "rclpy.callback_groups": _GROUPS,
        "rclpy.client": "Client",
        "rclpy.clock": "ROSClock",
        "rclpy.constants": "S_TO_NS",
        "rclpy.event_handler": _EVENTS,
        "rclpy.exceptions": _ERRORS,
        "rclpy.expand_topic_name": "expand_topic_name",
        "rclpy.guard_condition": "GuardCondition",
        "rclpy.parameter": "PARAMETER_SEPARATOR_STRING ParameterMsg",
        "rclpy.publisher": "Publisher",
        "rclpy.qos": "qos_profile_services_default",
        "rclpy.qos_overriding_options": "QoSOverridingOptions",
        "rclpy.service": "Service",
        "rclpy.subscription": "Subscription",
        "rclpy.timer": "Rate Timer",
        "rclpy.topic_endpoint_info": "TopicEndpointInfo",
        "rclpy.validate_full_topic_name": "validate_full_topic_name",
        "rclpy.validate_namespace": "validate_namespace",
        "rclpy.validate_node_name": "validate_node_name",
        "rclpy.validate_topic_name": "validate_topic_name",
    },
    "rclpy.parameter": {"rcl_interfaces.msg": "ParameterType"},
    "rclpy.parameter_client": {
        "rcl_interfaces.srv": _PARAMETER_SERVICES,
        "rclpy.event_handler": "SubscriptionEventCallbacks",
        "rclpy.node": "Node",
        "rclpy.parameter": "parameter_dict_from_yaml_file",
        "rclpy.qos_overriding_options": "QoSOverridingOptions",
    },
    "rclpy.parameter_event_handler": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.event_handler": "SubscriptionEventCallbacks",
        "rclpy.node": "Node",
        "rclpy.parameter": "Parameter",
        "rclpy.qos_overriding_options": "QoSOverridingOptions",
    },
    "rclpy.parameter_service": {
        "rcl_interfaces.msg": "ListParametersResult",
        "rcl_interfaces.srv": _PARAMETER_SERVICES,
    },
    "rclpy.publisher": {
        "rclpy.callback_groups": "CallbackGroup",
        "rclpy.duration": "Duration",
        "rclpy.event_handler": "EventHandler PublisherEventCallbacks",
        "rclpy.qos": "QoSProfile",
    },
    "rclpy.qos_overriding_options": {
        "rcl_interfaces.msg": "SetParametersResult",
        "rclpy.parameter": "Parameter",
        "rclpy.publisher": "Publisher",
        "rclpy.qos": "QoSDurabilityPolicy QoSHistoryPolicy QoSLivelinessPolicy QoSReliabilityPolicy",
        "rclpy.subscription": "Subscription",
    },
    "rclpy.service": {"rclpy.clock": "Clock"},
    "rclpy.subscription": {"rclpy.event_handler": "EventHandler SubscriptionEventCallbacks"},
    "rclpy.timer": {"rclpy.utilities": "get_default_context"},
    "rclpy.utilities": {"rclpy": "shutdown try_shutdown"},
    "tf2_ros.buffer_interface": {
        "copy": "deepcopy",
        "geometry_msgs.msg": "PointStamped PoseStamped PoseWithCovarianceStamped Vector3Stamped",
        "sensor_msgs.msg": "PointCloud2",
    },
    "tf2_ros.static_transform_broadcaster": {
        "geometry_msgs.msg": "TransformStamped",
        "rclpy.qos": "HistoryPolicy",
    },
    "tf2_ros.transform_listener": {"rclpy.qos": "HistoryPolicy"},
}
