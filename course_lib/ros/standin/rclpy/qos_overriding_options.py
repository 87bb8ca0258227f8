"""Parameters with which users override the QoS of a publisher or subscription."""

from collections.abc import Callable, Iterable
from copy import copy
from dataclasses import dataclass
from typing import Any, Literal

from rcl_interfaces.msg import ParameterDescriptor

from rclpy.duration import Duration
from rclpy.exceptions import ParameterAlreadyDeclaredException
from rclpy.impl.node_handle import AnyNode
from rclpy.qos import POLICIES, QoSPolicyEnum, QoSPolicyKind, QoSProfile


class InvalidQosOverridesError(Exception):
    """The validation callback of the options has rejected a profile."""


@dataclass
class QosCallbackResult:
    """The result of a validation callback: whether a profile is valid, and the reason if not."""

    successful: bool = False
    reason: str = ""


QosCallbackType = Callable[[QoSProfile], QosCallbackResult]
_DEFAULT = (QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY)


class QoSOverridingOptions:
    """The QoS policies that parameters can override.

    Args:
        policy_kinds: The policies.
        callback: Called with the resulting profile; returns whether it is valid.
        entity_id: Distinguishes several publishers or subscriptions on one topic.
    """

    def __init__(
        self,
        policy_kinds: Iterable[QoSPolicyKind],
        *,
        callback: QosCallbackType | None = None,
        entity_id: str | None = None,
    ) -> None:
        self._policy_kinds, self._callback, self._entity_id = policy_kinds, callback, entity_id

    @property
    def policy_kinds(self) -> Iterable[QoSPolicyKind]:
        """The policies that parameters can override."""
        return self._policy_kinds

    @property
    def callback(self) -> QosCallbackType | None:
        """The function that validates a profile."""
        return self._callback

    @property
    def entity_id(self) -> str | None:
        """The suffix of the parameters' names."""
        return self._entity_id

    @classmethod
    def with_default_policies(
        cls, *, callback: QosCallbackType | None = None, entity_id: str | None = None
    ) -> "QoSOverridingOptions":
        """Return options for history, depth and reliability."""
        return cls(_DEFAULT, callback=callback, entity_id=entity_id)


def apply_overrides(
    node: AnyNode,
    kind: Literal["publisher", "subscription"],
    topic: str,
    profile: QoSProfile,
    options: QoSOverridingOptions | None,
) -> QoSProfile:
    """Declare the parameters and return the profile with their values.

    Raises:
        InvalidQosOverridesError: The callback rejects the profile.
        RuntimeError: A parameter has an unknown value.
    """
    if options is None:
        return profile
    profile, suffix = copy(profile), "" if options.entity_id is None else f"_{options.entity_id}"
    about = f"for {kind} `{topic}` with id `{options.entity_id}`"
    allowed = [
        policy for policy in QoSPolicyKind if kind == "publisher" or policy is not QoSPolicyKind.LIFESPAN
    ]
    for policy in options.policy_kinds:
        # As in ROS, names of policies are ignored: only members of QoSPolicyKind count.
        if policy not in allowed:
            continue
        field = policy.name.lower()
        name = f"qos_overrides.{topic}.{kind}{suffix}.{field}"
        descriptor = ParameterDescriptor(description=f"{field} {about}", read_only=True)
        default = getattr(profile, field)
        if isinstance(default, QoSPolicyEnum):
            default = default.short_key
        elif isinstance(default, Duration):
            default = default.nanoseconds
        try:
            value = node.declare_parameter(name, default, descriptor).value
        except ParameterAlreadyDeclaredException:
            value = node.get_parameter(name).value
        setattr(profile, field, _policy(field, value))
    result = QosCallbackResult(successful=True) if options.callback is None else options.callback(profile)
    if not result.successful:
        raise InvalidQosOverridesError(f"Provided QoS overrides {about}, are not valid: {result.reason}")
    return profile


def _policy(field: str, value: Any) -> Any:
    """Convert a parameter value to a policy's value."""
    if field not in POLICIES:
        return Duration(nanoseconds=value) if field in ("lifespan", "deadline") or "lease" in field else value
    try:
        return POLICIES[field][value.upper()]
    except KeyError:
        raise RuntimeError(f"Unexpected QoS override for policy `{field}`: `{value}`") from None
