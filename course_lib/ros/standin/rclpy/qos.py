"""Quality of service (QoS): policies that publishers offer and subscriptions request."""

import warnings
from enum import Enum, IntEnum
from typing import Any

from rclpy.duration import Duration

# Incompatible pairs: (policy, publisher's value, subscription's value, text).
_CLASHES = (
    ("reliability", "BEST_EFFORT", "RELIABLE", "Best effort publisher and reliable subscription"),
    ("durability", "VOLATILE", "TRANSIENT_LOCAL", "Volatile publisher and transient local subscription"),
    (
        "liveliness", "AUTOMATIC", "MANUAL_BY_TOPIC",
        "Publisher's liveliness is automatic and subscription's is manual by topic",
    ),
)  # fmt: skip
# Pairs in which one value is SYSTEM_DEFAULT or UNKNOWN. For each policy: the subscription's value
# that leads to a warning and its text, then the same for the publisher's value.
_DOUBTS = {
    "reliability": (
        "RELIABLE", "Reliable subscription, but publisher is {}",
        "BEST_EFFORT", "Best effort publisher, but subscription is {}",
    ),
    "durability": (
        "TRANSIENT_LOCAL", "Transient local subscription, but publisher is {}",
        "VOLATILE", "Volatile publisher, but subscription is {}",
    ),
    "liveliness": (
        "MANUAL_BY_TOPIC", "Subscription's liveliness is manual by topic, but publisher's is {}",
        "AUTOMATIC", "Publisher's liveliness is automatic, but subscription's is {}",
    ),
}  # fmt: skip
_OPEN = ("SYSTEM_DEFAULT", "UNKNOWN")
# The duration that is compared after each policy: its name, the message if the publisher has none,
# and the message if the subscription's duration is shorter.
_TIMES = {
    "durability": (
        "deadline",
        "Subscription has a deadline, but publisher does not",
        "Subscription deadline is less than publisher deadline",
    ),
    "liveliness": (
        "liveliness_lease_duration",
        "Subscription has a liveliness lease duration, but publisher does not",
        "Subscription liveliness lease duration is less than publisher",
    ),
}


class QoSCompatibility(IntEnum):
    """Whether a publisher can reach a subscription.

    At WARNING it depends on the middleware's defaults.
    """

    OK = 0
    WARNING = 1
    ERROR = 2

    __str__ = Enum.__str__


def qos_check_compatible(publisher_qos: Any, subscription_qos: Any) -> tuple[QoSCompatibility, str]:
    """Return whether two QoS profiles are compatible, and the reasons if they are not."""
    both = publisher_qos, subscription_qos
    errors: list[str] = []
    for policy, offer, request, text in _CLASHES:
        if tuple(getattr(qos, policy).name for qos in both) == (offer, request):
            errors.append(text)
        if policy in _TIMES:
            name, missing, shorter = _TIMES[policy]
            offered_ns, requested_ns = (getattr(qos, name).nanoseconds for qos in both)
            if requested_ns and not offered_ns:
                errors.append(missing)
            elif requested_ns and requested_ns < offered_ns:
                errors.append(shorter)
    if errors:
        return QoSCompatibility.ERROR, "".join(f"ERROR: {text};" for text in errors)
    doubts: list[str] = []
    for policy, (requested, of_publisher, offered, of_subscription) in _DOUBTS.items():
        publisher, subscription = (getattr(qos, policy).name for qos in both)
        if publisher in _OPEN and subscription in _OPEN:
            # This misspelling is ROS's own.
            spelled = "durabilty" if policy == "durability" else policy
            description = f"is {publisher.lower()} and subscription {policy} is {subscription.lower()}"
            doubts.append(f"Publisher {spelled} {description}")
        elif publisher in _OPEN and subscription == requested:
            doubts.append(of_publisher.format(publisher.lower()))
        elif publisher == offered and subscription in _OPEN:
            doubts.append(of_subscription.format(subscription.lower()))
    level = QoSCompatibility.WARNING if doubts else QoSCompatibility.OK
    return level, "".join(f"WARNING: {text};" for text in doubts)


# ruff: noqa: N818 - the names are ROS's


class QoSPolicyKind(IntEnum):
    """The QoS policies, as reported in events about incompatible QoS."""

    INVALID = 1
    DURABILITY = 2
    DEADLINE = 4
    LIVELINESS = 8
    RELIABILITY = 16
    HISTORY = 32
    LIFESPAN = 64
    DEPTH = 128
    LIVELINESS_LEASE_DURATION = 256
    AVOID_ROS_NAMESPACE_CONVENTIONS = 512


class _DeprecatedAlias:
    """A policy value under its deprecated rmw name, like `RMW_QOS_POLICY_RELIABILITY_RELIABLE`."""

    def __init__(self, name: str, deprecated: str) -> None:
        self._name, self._deprecated = name, deprecated

    def __get__(self, instance: object, policy: "type[QoSPolicyEnum]") -> "QoSPolicyEnum":
        old_name, new = (f"{policy.__name__}.{name}" for name in (self._deprecated, self._name))
        warnings.warn(f"{old_name} is deprecated. Use {new} instead.", stacklevel=2)
        return policy[self._name]


class QoSPolicyEnum(IntEnum):
    """Base class of the enumerations of policy values."""

    @classmethod
    def short_keys(cls) -> list[str]:
        """List the names in lower case."""
        return [name.lower() for name in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> int:
        """Return the value with this name. Case is ignored."""
        return cls[name.upper()].value

    @property
    def short_key(self) -> str:
        """The name in lower case."""
        return self.name.lower()


class HistoryPolicy(QoSPolicyEnum):
    """Which samples are kept: the last `depth` samples, or all."""

    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2
    UNKNOWN = 3


class ReliabilityPolicy(QoSPolicyEnum):
    """Whether lost samples are sent again."""

    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class DurabilityPolicy(QoSPolicyEnum):
    """Whether late-joining subscriptions receive the last samples."""

    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class LivelinessPolicy(QoSPolicyEnum):
    """How a publisher's liveliness is asserted."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3
    UNKNOWN = 4
    BEST_AVAILABLE = 5


class InvalidQoSProfileException(Exception):
    """A profile was created with incompatible arguments."""

    def __init__(self, *args: object) -> None:
        super().__init__("Invalid QoSProfile", *args)


QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy

UNSPECIFIED = Duration()
DeadlineBestAvailable = Duration(nanoseconds=2**63 - 2)
# Spelled as in rclpy.
LivelinessLeaseDurationeBestAvailable = DeadlineBestAvailable

POLICIES: dict[str, type[QoSPolicyEnum]] = {
    "history": HistoryPolicy,
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "liveliness": LivelinessPolicy,
}
for _word, _policy in POLICIES.items():
    for _name in _policy.__members__:
        _deprecated = f"RMW_QOS_POLICY_{_word.upper()}_{_name}"
        if _name != "BEST_AVAILABLE":
            setattr(_policy, _deprecated, _DeprecatedAlias(_name, _deprecated))
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
    """The QoS of one publisher or subscription.

    `depth` or `history` is required. The other policies default to reliable and volatile.
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
        if name not in _DEFAULTS:
            raise AttributeError(f"'QoSProfile' object has no attribute '{name}'")
        policy = POLICIES.get(name)
        expected_type = int if policy else type(_DEFAULTS.get(name))
        if not isinstance(value, expected_type):
            raise AssertionError(
                f"The '{name}' of a QoSProfile must be {(policy or expected_type).__name__}: {value!r}"
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
qos_profile_unknown = QoSProfile(
    history=HistoryPolicy.UNKNOWN,
    depth=0,
    reliability=ReliabilityPolicy.UNKNOWN,
    durability=DurabilityPolicy.UNKNOWN,
    liveliness=LivelinessPolicy.UNKNOWN,
)
qos_profile_best_available = QoSProfile(
    depth=10,
    reliability=ReliabilityPolicy.BEST_AVAILABLE,
    durability=DurabilityPolicy.BEST_AVAILABLE,
    deadline=DeadlineBestAvailable,
    liveliness=LivelinessPolicy.BEST_AVAILABLE,
    liveliness_lease_duration=LivelinessLeaseDurationeBestAvailable,
)


class QoSPresetProfiles(Enum):
    """The predefined profiles by name."""

    UNKNOWN = qos_profile_unknown
    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default
    BEST_AVAILABLE = qos_profile_best_available

    @classmethod
    def short_keys(cls) -> list[str]:
        """List the names in lower case."""
        return [name.lower() for name in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> QoSProfile:
        """Return the profile with this name. Case is ignored."""
        return cls[name.upper()].value


def qos_policy_name_from_kind(policy_kind: QoSPolicyKind | int) -> str:
    """Return the name of a policy."""
    return QoSPolicyKind(policy_kind).name
