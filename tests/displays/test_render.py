from pathlib import Path
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.displays.render import render_bag, replayed, scene_of
from course_lib.errors import CourseError
from course_lib.recording import Recording, write_bag
from course_lib.ros.graph import Sample
from course_lib.ros.messages import serialize, type_name
from course_lib.ros.qos import Qos
from tests.displays.bench import marker, ns
from tests.displays.test_layout import LAYOUT


def sample(topic: str, message: Any, at: float = 0.0) -> Sample:
    return Sample(ns(at), topic, type_name(message), serialize(message), Qos(), 1)


def frame(parent: str, child: str) -> TFMessage:
    transform = TransformStamped(child_frame_id=child)
    transform.header.frame_id = parent
    return TFMessage(transforms=[transform])


def markers_of(recording: Recording, at: float | None = None) -> list[str]:
    scene = scene_of(recording, at=at)
    return [path for path in scene.objects() if "Marker" in path and scene.visible(path)]


COMES_AND_GOES = Recording(
    [
        sample("/chatter", marker(), 0.0),
        sample("/m", marker(), 1.0),
        sample("/m", marker(action=Marker.DELETE), 2.0),
    ]
)


@pytest.mark.parametrize(("at", "seen"), [(0.5, 0), (1.0, 1), (1.99, 1), (2.0, 0), (9.0, 0), (None, 0)])
def test_a_recording_is_drawn_as_it_was_at_a_time(at: float | None, seen: int) -> None:
    recording = Recording([s for s in COMES_AND_GOES.samples if s.topic == "/m"])
    later = None if at is None else at - 1.0  # counted from the first message
    assert len(markers_of(recording, later)) == seen


def test_without_a_layout_all_topics_of_markers_are_shown_with_a_grid() -> None:
    both = [
        sample("/a", marker()),
        sample("/a_array", MarkerArray(markers=[marker(number=1)])),
        sample("/b", MarkerArray(markers=[marker()])),
    ]
    session = replayed(Recording(both))
    assert [(d.name, d["Topic"]) for d in session.displays[1:]] == [("Marker", "/a"), ("MarkerArray", "/b")]
    assert len(markers_of(Recording(both))) == 3


FRAMES: dict[str, tuple[list[Sample], str]] = {
    "nothing": ([], "map"),
    "markers only": ([sample("/m", marker(frame="world"))], "world"),
    "root of the markers": (
        [
            sample("/tf", frame("odom", "base")),
            sample("/tf", frame("earth", "odom")),
            sample("/m", marker(frame="base")),
        ],
        "earth",
    ),
    "transforms only": ([sample("/tf_static", frame("odom", "base"))], "odom"),
    "a loop": ([sample("/tf", frame("a", "b")), sample("/tf", frame("b", "a"))], "b"),
    "most markers": (
        [sample("/m", marker(frame=name, number=i)) for i, name in enumerate(["x", "y", "y"])],
        "y",
    ),
}


@pytest.mark.parametrize("name", FRAMES)
def test_without_a_layout_the_fixed_frame_is_guessed_and_said(name: str) -> None:
    samples, fixed_frame = FRAMES[name]
    session = replayed(Recording(samples))
    assert session.fixed_frame == fixed_frame
    assert any(f"no layout was given: {fixed_frame!r}" in row.text for row in session.rows())


def test_the_same_recording_gives_the_same_scene() -> None:
    first, second = (replayed(COMES_AND_GOES, at=1.5) for _ in range(2))
    assert first.rows() == second.rows()
    assert first.context.scene.objects().keys() == second.context.scene.objects().keys()


def test_a_bag_becomes_a_picture_or_a_page_with_what_the_statuses_complain_about(tmp_path: Path) -> None:
    write_bag(Recording([sample("/boxes", MarkerArray(markers=[marker(frame="mapp")]))]), tmp_path / "bag")
    layout = tmp_path / "view.rviz"
    layout.write_text(LAYOUT.replace("Enabled: false", "Enabled: true").replace("/world", "map"))
    size = (80, 60)
    said = render_bag(tmp_path / "bag", rviz=layout, png=tmp_path / "out.png", size=size)
    assert (tmp_path / "out.png").stat().st_size > 0
    assert said.startswith(f"Wrote {tmp_path / 'out.png'}, drawn by ")
    assert "Boxes / n/0: error: For frame [mapp]: Fixed Frame [map] does not exist" in said
    said = render_bag(tmp_path / "bag", html=tmp_path / "out.html")
    assert said.startswith(f"Wrote {tmp_path / 'out.html'}.")
    assert "<html" in (tmp_path / "out.html").read_text()[:200].lower()


def test_what_is_no_bag_is_one_clear_line(tmp_path: Path) -> None:
    with pytest.raises(CourseError):
        render_bag(tmp_path / "nowhere", png=tmp_path / "out.png")
