"""Quality of service: what a publisher offers and a subscription requests."""

# ruff: noqa: N818 - the names are ROS's

import warnings
from enum import Enum, IntEnum
from typing import Any

from rclpy.duration import Duration


class QoSPolicyKind(IntEnum):
    """Names the policy that keeps a publisher and a subscription apart."""

    DURABILITY = 2
    DEADLINE = 4
    LIVELINESS = 8
    RELIABILITY = 16


class HistoryPolicy(IntEnum):
    """The samples that are kept: the last `depth`, or all."""

    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2


class ReliabilityPolicy(IntEnum):
    """Lost samples are sent again, or not."""

    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2


class DurabilityPolicy(IntEnum):
    """A subscription that comes late gets the last samples, or not."""

    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2


class LivelinessPolicy(IntEnum):
    """The source of a publisher's signs of life."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3


class InvalidQoSProfileException(Exception):
    """A profile was made of arguments that do not fit together."""

    def __init__(self, *args: object) -> None:
        super().__init__("Invalid QoSProfile", *args)


QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy

UNSPECIFIED = Duration()


POLICIES: dict[str, type[IntEnum]] = {
    "history": HistoryPolicy,
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "liveliness": LivelinessPolicy,
}
_DEFAULTS: dict[str, Any] = {
    "history": HistoryPolicy.KEEP_LAST,
    "depth": 10,
    "reliability": ReliabilityPolicy.RELIABLE,
    "durability": DurabilityPolicy.VOLATILE,
    "lifespan": UNSPECIFIED,
    "deadline": UNSPECIFIED,
    "liveliness": LivelinessPolicy.SYSTEM_DEFAULT,
    "liveliness_lease_duration": UNSPECIFIED,
    "avoid_ros_namespace_conventions": False,
}


class QoSProfile:
    """The quality of service of one publisher or subscription.

    `depth` or `history` is required; the rest defaults to reliable and volatile.
    """

    history: HistoryPolicy
    depth: int
    reliability: ReliabilityPolicy
    durability: DurabilityPolicy
    lifespan: Duration
    deadline: Duration
    liveliness: LivelinessPolicy
    liveliness_lease_duration: Duration
    avoid_ros_namespace_conventions: bool

    def __init__(self, **kwargs: Any) -> None:
        if not _DEFAULTS.keys() >= kwargs.keys():
            raise AssertionError(f"Invalid arguments passed to constructor: {kwargs.keys()!r}")
        if "depth" not in kwargs:
            if "history" not in kwargs:
                raise InvalidQoSProfileException("History and/or depth settings are required.")
            if kwargs["history"] == HistoryPolicy.KEEP_LAST:
                raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        for name, value in (_DEFAULTS | kwargs).items():
            setattr(self, name, value)

    def __setattr__(self, name: str, value: Any) -> None:
        policy = POLICIES.get(name)
        wanted = int if policy else type(_DEFAULTS.get(name))
        if not isinstance(value, wanted):
            raise AssertionError(
                f"The '{name}' of a QoSProfile must be {(policy or wanted).__name__}: {value!r}"
            )
        if name == "depth" and value == 0 and self.history == HistoryPolicy.KEEP_LAST:
            warnings.warn(
                "A zero depth with KEEP_LAST doesn't make sense; no data could be stored. "
                "This will be interpreted as SYSTEM_DEFAULT",
                stacklevel=3,
            )
        super().__setattr__(name, policy(value) if policy else value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, QoSProfile) and vars(self) == vars(other)

    __hash__ = None  # type: ignore[assignment]  # profiles can be changed

    def __str__(self) -> str:
        return f"QoSProfile({', '.join(f'{name}={value}' for name, value in vars(self).items())})"


qos_profile_default = QoSProfile(depth=10)
qos_profile_system_default = QoSProfile(
    history=HistoryPolicy.SYSTEM_DEFAULT,
    depth=0,
    reliability=ReliabilityPolicy.SYSTEM_DEFAULT,
    durability=DurabilityPolicy.SYSTEM_DEFAULT,
)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
qos_profile_services_default = QoSProfile(depth=10)
qos_profile_parameters = QoSProfile(depth=1000)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_action_status_default = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class QoSPresetProfiles(Enum):
    """The presets by name."""

    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default
