import pytest

from course_lib.displays.display import Interest, reaches
from course_lib.displays.statuses import Statuses
from course_lib.ros.graph import Sample
from course_lib.ros.qos import Qos

TYPE = "std_msgs/msg/String"

BEST_EFFORT, LATCHED = Qos(reliability="best_effort"), Qos(durability="transient_local")


@pytest.mark.parametrize(
    ("type_name", "offered", "requested", "hint"),
    [
        (TYPE, Qos(), Qos(), None),
        (TYPE, LATCHED, Qos(), None),
        ("std_msgs/msg/Header", Qos(), Qos(), "carries std_msgs/msg/Header; this display takes"),
        (TYPE, BEST_EFFORT, Qos(), "another RELIABILITY"),
        (TYPE, Qos(), LATCHED, "another DURABILITY"),
    ],
)
def test_what_does_not_reach_a_display_is_hinted_at(
    type_name: str, offered: Qos, requested: Qos, hint: str | None
) -> None:
    statuses = Statuses()
    interest = Interest("/t", TYPE, requested, lambda message: None, statuses)
    sample = Sample(0, "/t", type_name, b"", offered, 1)
    assert reaches(sample, interest, match_qos=True) == (hint is None)
    texts = [row.text for row in statuses.rows("")]
    assert texts == [] if hint is None else hint in texts[0]


def test_the_hint_goes_when_a_message_does_come() -> None:
    statuses = Statuses()
    interest = Interest("/t", TYPE, Qos(), lambda message: None, statuses)
    reaches(Sample(0, "/t", TYPE, b"", BEST_EFFORT, 1), interest, match_qos=True)
    reaches(Sample(0, "/t", TYPE, b"", Qos(), 1), interest, match_qos=True)
    assert statuses.rows("") == []
