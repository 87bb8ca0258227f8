import json
from pathlib import Path
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.displays.render import render_bag, replay, scene_of
from course_lib.errors import CourseError
from course_lib.recording import Recording, write_bag
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize, type_name
from tests.displays.bench import marker, ns
from tests.displays.stage import LATCHED
from tests.displays.test_layout import LAYOUT


def sample(topic: str, message: Any, at: float = 0.0) -> Sample:
    return Sample(ns(at), topic, type_name(message), serialize(message), Qos(), 1)


def frame(parent: str, child: str) -> TFMessage:
    transform = TransformStamped(child_frame_id=child)
    transform.header.frame_id = parent
    return TFMessage(transforms=[transform])


def markers_of(recording: Recording, at: float | None = None) -> list[str]:
    scene = scene_of(recording, at=at)
    return [path for path in scene.objects() if "Marker" in path and scene.is_visible(path)]


COMES_AND_GOES = Recording(
    [
        sample("/chatter", marker(), 0.0),
        sample("/m", marker(), 1.0),
        sample("/m", marker(action=Marker.DELETE), 2.0),
    ]
)


@pytest.mark.parametrize(("at", "seen"), [(0.5, 0), (1.0, 1), (1.99, 1), (2.0, 0), (9.0, 0), (None, 0)])
def test_recording_is_drawn_at_the_requested_time(at: float | None, seen: int) -> None:
    recording = Recording([s for s in COMES_AND_GOES.samples if s.topic == "/m"])
    later = None if at is None else at - 1.0  # counted from the first message
    assert len(markers_of(recording, later)) == seen


def test_all_marker_topics_and_a_grid_are_shown_without_a_layout() -> None:
    both = [
        sample("/a", marker()),
        sample("/a_array", MarkerArray(markers=[marker(number=1)])),
        sample("/b", MarkerArray(markers=[marker()])),
    ]
    session = replay(Recording(both))
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
def test_fixed_frame_is_guessed_and_printed_without_a_layout(name: str) -> None:
    samples, fixed_frame = FRAMES[name]
    session = replay(Recording(samples))
    assert session.fixed_frame == fixed_frame
    assert any(f"no layout was given: {fixed_frame!r}" in row.text for row in session.rows())


def test_equal_recordings_give_equal_scenes() -> None:
    first, second = (replay(COMES_AND_GOES, at=1.5) for _ in range(2))
    assert first.rows() == second.rows()
    assert first.context.scene.objects().keys() == second.context.scene.objects().keys()


def test_bag_is_rendered_to_an_image_or_page_with_its_problems_reported(tmp_path: Path) -> None:
    write_bag(Recording([sample("/boxes", MarkerArray(markers=[marker(frame="mapp")]))]), tmp_path / "bag")
    layout = tmp_path / "view.rviz"
    layout.write_text(LAYOUT.replace("Enabled: false", "Enabled: true").replace("/world", "map"))
    size = (80, 60)
    message = render_bag(tmp_path / "bag", rviz=layout, png=tmp_path / "out.png", size=size)
    assert (tmp_path / "out.png").stat().st_size > 0
    assert message.startswith(f"Wrote {tmp_path / 'out.png'}, drawn by ")
    assert "Boxes / n/0: error: For frame [mapp]: Fixed Frame [map] does not exist" in message
    message = render_bag(tmp_path / "bag", html=tmp_path / "out.html")
    assert message.startswith(f"Wrote {tmp_path / 'out.html'}.")
    assert "<html" in (tmp_path / "out.html").read_text()[:200].lower()


def test_invalid_bag_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(CourseError):
        render_bag(tmp_path / "nowhere", png=tmp_path / "out.png")


@pytest.mark.slow
def test_bag_with_malformed_messages_is_drawn_with_error_statuses(tmp_path: Path) -> None:
    box, paint = (
        "<geometry><box size='1 1 1'/></geometry>",
        "<material name='m'><color rgba='red'/></material>",
    )
    robot = String(data=f'<robot name="r"><link name="base"><visual>{box}{paint}</visual></link></robot>')
    sound = marker(frame="base")
    samples = [
        Sample(ns(0), "/robot_description", type_name(robot), serialize(robot), LATCHED, 1),
        Sample(ns(0.1), "/markers", type_name(sound), b"\0\1\0\0cut", Qos(), 1),
        Sample(ns(0.2), "/markers", type_name(sound), serialize(sound), Qos(), 1),
    ]
    write_bag(Recording(tuple(samples)), tmp_path / "bag")
    layout = tmp_path / "l.rviz"
    displays = [
        {
            "Class": "rviz_default_plugins/RobotModel",
            "Name": "Robot",
            "Description Topic": "/robot_description",
        },
        {"Class": "rviz_default_plugins/Marker", "Name": "Marker", "Topic": "/markers"},
    ]
    options = {"Fixed Frame": "base"}
    layout.write_text(
        json.dumps({"Visualization Manager": {"Global Options": options, "Displays": displays}})
    )
    message = render_bag(tmp_path / "bag", rviz=layout, png=tmp_path / "a.png", size=(160, 120))
    assert "Robot / URDF: hint: Material [m] has malformed color rgba values" in message
    assert "Marker / Message" not in message
    assert render_bag(tmp_path / "bag", html=tmp_path / "a.html")
    early = render_bag(tmp_path / "bag", rviz=layout, at=0.15, png=tmp_path / "b.png", size=(160, 120))
    assert "Marker / Message: error: These 7 bytes are not a valid visualization_msgs/msg/Marker" in early
