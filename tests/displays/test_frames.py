from itertools import pairwise

import pytest
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

from course_lib.displays.frames import NS, Frames, ViewTime
from course_lib.displays.session import CLOCK_WAS_SET_BACK
from tests.displays.bench import Bench


def transform(parent: str, child: str, x: float = 0.0) -> TransformStamped:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.transform.translation.x = x
    return message


def test_global_status_has_the_three_texts_of_rviz() -> None:
    frames = Frames("map")
    assert frames.global_status() == ("warn", "No tf data.  Actual error: Frame [map] does not exist")
    frames.add_transforms([transform("odom", "base")], is_static=True)
    assert frames.global_status() == ("error", "Frame [map] does not exist")
    frames.add_transforms([transform("map", "odom")], is_static=True)
    assert frames.global_status() == ("ok", "OK")


@pytest.mark.parametrize("frame", ["base", "/base"])
def test_leading_slash_is_stripped(frame: str) -> None:
    frames = Frames("map")
    frames.add_transforms([transform("/map", "/base", 2.0)], is_static=True)
    found = frames.transform(frame)
    assert found is not None
    assert found[0, 3] == 2.0


def test_lookups_are_cached_until_transforms_arrive_or_the_fixed_frame_changes() -> None:
    frames = Frames("map")
    frames.add_transforms([transform("map", "base", 1.0)], is_static=True)
    first = frames.transform("base")
    assert frames.transform("base") is first
    frames.add_transforms([transform("map", "base", 2.0)], is_static=True)
    second = frames.transform("base")
    assert second is not None
    assert second[0, 3] == 2.0
    frames.fixed_frame = "base"
    third = frames.transform("base")
    assert third is not None
    assert third[0, 3] == 0.0


def test_reset_forgets_the_transforms_that_were_drawn_last() -> None:
    bench = Bench("map")
    display = bench.session.add("rviz_default_plugins/TF", "TF", {})
    bench.publish("/tf", TFMessage(transforms=[transform("map", "base")]))
    bench.session.refresh()
    assert bench.status(display, "base") == ("ok", "Transform OK")
    bench.session.reset()
    bench.session.refresh()
    assert bench.status(display, "base") == ("warn", "No transform from [base] to [map]")


def test_view_of_a_robot_whose_clock_was_set_back_recovers_by_a_reset() -> None:
    bench = Bench("odom")
    late, early = transform("odom", "base"), transform("odom", "base", 1.0)
    late.header.stamp.sec, early.header.stamp.sec = 1300, 1000
    for message in (late, early):
        bench.publish("/tf", TFMessage(transforms=[message]))
    hints = [row.text for row in bench.session.rows() if (row.name, row.level) == ("TF", "hint")]
    assert hints[0].startswith("TF_OLD_DATA ignoring data from the past for frame base")
    assert hints[1:] == [CLOCK_WAS_SET_BACK]
    bench.session.reset()
    bench.publish("/tf", TFMessage(transforms=[early]))
    transform_to_odom = bench.session.context.frames.transform("base")
    assert transform_to_odom is not None
    assert transform_to_odom[0, 3] == 1.0
    assert [row.text for row in bench.session.rows() if row.level == "hint"] == []


def test_transform_ignored_by_tf2_is_reported() -> None:
    (complaint,) = Frames("map").add_transforms([transform("map", "map")], is_static=False)
    assert complaint.startswith("TF_SELF_TRANSFORM")
    assert 'from authority "Authority undetectable"' in complaint


@pytest.mark.parametrize("rate", [50, 100, 1000])
def test_frames_keep_their_rate_while_messages_are_more_frequent(rate: int) -> None:
    view_time = ViewTime(start_ns=0, use_sim_time=False)
    frames_ns = []
    for stamp_ns in range(0, NS, NS // rate):
        if (due_ns := view_time.overdue_ns(stamp_ns)) is not None:
            view_time.begin_frame(due_ns)
            frames_ns.append(due_ns)
        view_time.on_message(stamp_ns)
        view_time.request_frame()
    assert len(frames_ns) == view_time.frame_rate - 1
    assert {b - a for a, b in pairwise(frames_ns)} == {NS // view_time.frame_rate}


def test_frame_after_a_jump_back_in_time_is_due_one_interval_later() -> None:
    view_time = ViewTime(start_ns=0, use_sim_time=False)
    view_time.begin_frame(10 * NS)
    view_time.restart()
    view_time.on_message(2 * NS)
    view_time.request_frame()
    assert view_time.overdue_ns(3 * NS) == 2 * NS + NS // view_time.frame_rate
