import pytest

from course_lib.displays.display import Subscription, is_deliverable
from course_lib.displays.statuses import Statuses
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos

TYPE = "std_msgs/msg/String"

BEST_EFFORT, LATCHED = Qos(reliability="best_effort"), Qos(durability="transient_local")


@pytest.mark.parametrize(
    ("type_name", "offered", "requested", "hint"),
    [
        (TYPE, Qos(), Qos(), None),
        (TYPE, LATCHED, Qos(), None),
        ("std_msgs/msg/Header", Qos(), Qos(), "carries std_msgs/msg/Header; this display expects"),
        (TYPE, BEST_EFFORT, Qos(), "another RELIABILITY"),
        (TYPE, Qos(), LATCHED, "another DURABILITY"),
    ],
)
def test_undeliverable_message_is_reported_as_a_hint(
    type_name: str, offered: Qos, requested: Qos, hint: str | None
) -> None:
    statuses = Statuses()
    interest = Subscription("/t", TYPE, requested, lambda message: None, statuses)
    sample = Sample(0, "/t", type_name, b"", offered, 1)
    assert is_deliverable(sample, interest, match_qos=True) == (hint is None)
    texts = [row.text for row in statuses.rows("")]
    assert texts == [] if hint is None else hint in texts[0]


def test_delivery_hint_is_cleared_by_a_received_message() -> None:
    statuses = Statuses()
    interest = Subscription("/t", TYPE, Qos(), lambda message: None, statuses)
    is_deliverable(Sample(0, "/t", TYPE, b"", BEST_EFFORT, 1), interest, match_qos=True)
    is_deliverable(Sample(0, "/t", TYPE, b"", Qos(), 1), interest, match_qos=True)
    assert statuses.rows("") == []
