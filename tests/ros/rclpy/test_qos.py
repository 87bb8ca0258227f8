import pytest
from rclpy.duration import Duration, Infinite
from rclpy.impl.graph_queries import to_profile, to_qos
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    InvalidQoSProfileException,
    LivelinessPolicy,
    QoSCompatibility,
    QoSDurabilityPolicy,
    QoSHistoryPolicy,
    QoSLivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    QoSReliabilityPolicy,
    ReliabilityPolicy,
    qos_check_compatible,
    qos_profile_parameter_events,
    qos_profile_sensor_data,
    qos_profile_system_default,
)

from course_lib.ros.graph.topics import Qos, find_incompatible_policy

BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_profile_requires_a_depth_or_a_history() -> None:
    with pytest.raises(InvalidQoSProfileException) as caught:
        QoSProfile()
    assert caught.value.args == ("Invalid QoSProfile", "History and/or depth settings are required.")
    with pytest.raises(InvalidQoSProfileException) as caught:
        QoSProfile(history=HistoryPolicy.KEEP_LAST)
    assert caught.value.args[1] == "History set to KEEP_LAST without a depth setting."
    assert QoSProfile(history=HistoryPolicy.KEEP_ALL).depth == 10


def test_qos_profile_defaults_to_reliable_and_volatile() -> None:
    profile = QoSProfile(depth=7)
    assert profile.history is HistoryPolicy.KEEP_LAST
    assert profile.reliability is ReliabilityPolicy.RELIABLE
    assert profile.durability is DurabilityPolicy.VOLATILE
    assert profile == QoSProfile(history=HistoryPolicy.KEEP_LAST, depth=7)
    assert profile != QoSProfile(depth=8)


def test_unknown_and_wrongly_typed_arguments_are_rejected() -> None:
    with pytest.raises(
        AssertionError, match=r"^Invalid arguments passed to constructor: dict_keys\(\['dept'\]\)$"
    ):
        QoSProfile(dept=1)
    with pytest.raises(AssertionError, match="'depth' of a QoSProfile must be int: 'ten'"):
        QoSProfile(depth="ten")
    with pytest.raises(AssertionError, match=r"'deadline' of a QoSProfile must be Duration: 1.0"):
        QoSProfile(depth=1).deadline = 1.0  # type: ignore[assignment]  # the mistake under test


def test_integers_become_policies() -> None:
    profile = QoSProfile(depth=1)
    profile.reliability = 2  # type: ignore[assignment]  # allowed in ROS
    assert profile.reliability is ReliabilityPolicy.BEST_EFFORT


def test_depth_zero_causes_a_warning() -> None:
    with pytest.warns(
        UserWarning, match="A zero depth with KEEP_LAST doesn't make sense; no data could be stored"
    ):
        QoSProfile(depth=0)


def test_long_policy_class_name_is_an_alias_of_the_short_one() -> None:
    assert (QoSHistoryPolicy, QoSReliabilityPolicy) == (HistoryPolicy, ReliabilityPolicy)
    assert QoSDurabilityPolicy is DurabilityPolicy
    assert QoSLivelinessPolicy is LivelinessPolicy


@pytest.mark.parametrize(
    ("name", "depth", "reliability", "durability"),
    [
        ("default", 10, "RELIABLE", "VOLATILE"),
        ("sensor_data", 5, "BEST_EFFORT", "VOLATILE"),
        ("services_default", 10, "RELIABLE", "VOLATILE"),
        ("parameters", 1000, "RELIABLE", "VOLATILE"),
        ("parameter_events", 1000, "RELIABLE", "VOLATILE"),
        ("action_status_default", 1, "RELIABLE", "TRANSIENT_LOCAL"),
        ("system_default", 0, "SYSTEM_DEFAULT", "SYSTEM_DEFAULT"),
    ],
)
def test_qos_presets_agree_with_ros(name: str, depth: int, reliability: str, durability: str) -> None:
    profile = QoSPresetProfiles[name.upper()].value
    assert (profile.depth, profile.reliability.name, profile.durability.name) == (
        depth,
        reliability,
        durability,
    )


@pytest.mark.parametrize(
    ("publisher", "subscription", "policy"),
    [
        (BEST_EFFORT, QoSProfile(depth=1), "RELIABILITY"),
        (QoSProfile(depth=1), LATCHED, "DURABILITY"),
        (QoSProfile(depth=1), QoSProfile(depth=1, deadline=Duration(seconds=1)), "DEADLINE"),
        (
            QoSProfile(depth=1, deadline=Duration(seconds=2)),
            QoSProfile(depth=1, deadline=Duration(seconds=1)),
            "DEADLINE",
        ),
        (
            QoSProfile(depth=1, liveliness_lease_duration=Duration(seconds=2)),
            QoSProfile(depth=1, liveliness_lease_duration=Duration(seconds=1)),
            "LIVELINESS",
        ),
    ],
)
def test_incompatible_qos_policy_is_returned(
    publisher: QoSProfile, subscription: QoSProfile, policy: str
) -> None:
    assert find_incompatible_policy(to_qos(publisher, "pub"), to_qos(subscription, "sub")) == policy


def test_qos_profile_converts_to_graph_qos_and_back() -> None:
    qos = to_qos(qos_profile_sensor_data, "sub")
    assert qos == Qos(depth=5, reliability="best_effort")
    profile = to_profile(qos)
    assert (profile.depth, profile.reliability) == (5, ReliabilityPolicy.BEST_EFFORT)
    assert profile.deadline == Infinite
    limited = QoSProfile(depth=1, deadline=Duration(seconds=1), lifespan=Infinite)
    assert to_qos(limited, "pub") == Qos(depth=1, deadline_ns=10**9)


def test_system_default_profile_resolves_to_the_dds_defaults() -> None:
    assert to_qos(qos_profile_system_default, "pub") == Qos(depth=1, durability="transient_local")
    assert to_qos(qos_profile_system_default, "sub") == Qos(depth=1, reliability="best_effort")


AUTOMATIC = {"liveliness": LivelinessPolicy.AUTOMATIC}


@pytest.mark.parametrize(
    ("offered", "requested", "level", "reason"),
    [
        (
            {},
            {},
            "WARNING",
            "WARNING: Publisher liveliness is system_default and subscription liveliness is system_default;",
        ),
        (AUTOMATIC, AUTOMATIC, "OK", ""),
        ({"durability": DurabilityPolicy.TRANSIENT_LOCAL}, AUTOMATIC, "OK", ""),
        (
            {"durability": DurabilityPolicy.VOLATILE},
            {"durability": DurabilityPolicy.TRANSIENT_LOCAL, "deadline": Duration(seconds=1)},
            "ERROR",
            "ERROR: Volatile publisher and transient local subscription;"
            "ERROR: Subscription has a deadline, but publisher does not;",
        ),
        (
            {"liveliness_lease_duration": Duration(seconds=2)},
            {"liveliness_lease_duration": Duration(seconds=1)},
            "ERROR",
            "ERROR: Subscription liveliness lease duration is less than publisher;",
        ),
        ({"deadline": Duration(seconds=1)}, {"deadline": Duration(seconds=2)} | AUTOMATIC, "OK", ""),
        (
            {"reliability": ReliabilityPolicy.SYSTEM_DEFAULT},
            {"reliability": ReliabilityPolicy.RELIABLE} | AUTOMATIC,
            "WARNING",
            "WARNING: Reliable subscription, but publisher is system_default;",
        ),
    ],
)
def test_profiles_are_compared_as_in_ros(
    offered: dict[str, object], requested: dict[str, object], level: str, reason: str
) -> None:
    profiles = QoSProfile(depth=1, **offered), QoSProfile(depth=1, **requested)
    assert qos_check_compatible(*profiles) == (QoSCompatibility[level], reason)


def test_best_effort_publisher_does_not_reach_a_reliable_subscription() -> None:
    assert qos_check_compatible(qos_profile_sensor_data, qos_profile_parameter_events) == (
        QoSCompatibility.ERROR,
        "ERROR: Best effort publisher and reliable subscription;",
    )
