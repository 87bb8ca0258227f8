from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from course_lib.displays.display import Display
from course_lib.ros.graph.topics import Qos
from course_lib.viewer.drawables import Points
from tests.displays.bench import START_NS, Bench
from tests.displays.clouds.test_depth import image, packed

DEPTH, COLOR, INFO = "/camera/depth", "/camera/color", "/camera/camera_info"
RED = np.array([[[255, 0, 0]] * 2], np.uint8)


def add(bench: Bench, **properties: Any) -> Display:
    config = {"Depth Map Topic": DEPTH}
    return bench.session.add("rviz_default_plugins/DepthCloud", "Cloud", config, **properties)


def stamped(message: Any, at: float = 0.0, frame: str = "map") -> Any:
    message.header.frame_id = frame
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(START_NS + round(at * 1e9), 10**9)
    return message


def depth(*metres: float, at: float = 0.0) -> Image:
    message: Image = stamped(image(np.array([metres], np.float32), "32FC1"), at)
    return message


def color(rgb: np.ndarray = RED, at: float = 0.0, frame: str = "map") -> Image:
    message: Image = stamped(image(rgb, "rgb8"), at, frame)
    return message


def info(width: int = 2, focal_length: float = 100.0) -> CameraInfo:
    message: CameraInfo = stamped(CameraInfo(width=width, height=1))
    message.k = np.diag([focal_length, focal_length, 1.0]).ravel()
    message.p = np.array([focal_length, 0, 0, 0, 0, focal_length, 0, 0, 0, 0, 1.0, 0])
    return message


def hear(bench: Bench, *messages: Any, at: float = 0.0) -> None:
    """Publish messages, each on its topic."""
    for message in messages:
        by_type = COLOR if getattr(message, "encoding", "") == "rgb8" else DEPTH
        bench.publish(INFO if isinstance(message, CameraInfo) else by_type, message, at)
    bench.update(at)


def displayed_points(bench: Bench) -> Points | None:
    clouds = [
        drawable
        for path, drawable in bench.scene.objects().items()
        if path.startswith("displays/Cloud/clouds/")
    ]
    assert all(isinstance(cloud, Points) for cloud in clouds)
    return clouds[-1] if clouds else None  # type: ignore[return-value]  # all are, as was just seen


def test_depths_become_points_with_the_size_of_their_pixels() -> None:
    bench = Bench()
    display = add(bench)
    hear(bench, info(), depth(2.0, 4.0))
    cloud = displayed_points(bench)
    assert cloud is not None
    np.testing.assert_allclose(cloud.points, [[0.0, 0.0, 2.0], [0.04, 0.0, 4.0]])
    assert cloud.colors[:, :3].tolist() == [[1, 1, 1]] * 2
    assert (cloud.grow, cloud.size[0]) == (True, 0.01)
    assert bench.status(display, "Depth Image Size") == ("ok", "2 x 1")
    display["Auto Size Factor"] = 3.0
    hear(bench, depth(2.0, 4.0, at=0.1), at=0.1)
    assert display["Size (m)"] == pytest.approx(0.03)
    display["Auto Size"] = False
    display["Size (m)"] = 0.5
    bench.update(0.1)
    cloud = displayed_points(bench)
    assert cloud is not None
    assert (cloud.grow, cloud.size[0]) == (False, 0.5)


def test_nothing_is_drawn_without_camera_info_and_a_hint_is_shown() -> None:
    bench = Bench()
    display = add(bench)
    assert bench.status(display, "Depth Map") == ("ok", "0 depth maps received")
    hear(bench, depth(1.0, 1.0))
    assert displayed_points(bench) is None
    assert bench.status(display, "Depth Map") == ("ok", "1 messages received at inf hz.")
    assert INFO in " ".join(bench.hints(display))


def test_camera_info_without_focal_lengths_causes_a_hint() -> None:
    bench = Bench()
    display = add(bench)
    without = info()
    without.p = np.zeros(12)  # often forgotten: k seems to be enough
    hear(bench, without, depth(1.0, 1.0))
    assert bench.status(display, "Points") == ("ok", "Showing [0] points from [1] messages")
    assert f"p[0] and p[5] are 0 in the CameraInfo on {INFO}" in " ".join(bench.hints(display))
    hear(bench, info(), depth(1.0, 1.0, at=0.1), at=0.1)
    assert bench.hints(display) == []


def test_depth_image_waits_for_its_color_image() -> None:
    bench = Bench()
    display = add(bench, color_image_topic=COLOR)
    assert display["Color Transformer"] == "RGB8"
    hear(bench, info(), depth(1.0, 1.0))
    assert displayed_points(bench) is None
    hear(bench, color())
    cloud = displayed_points(bench)
    assert cloud is not None
    assert cloud.colors[:, :3].tolist() == [[1, 0, 0]] * 2
    assert bench.status(display, "Image Size") == ("ok", "2 x 1")


def test_color_image_with_the_nearest_time_is_used() -> None:
    bench = Bench()
    add(bench, color_image_topic=COLOR)
    images = [color(RED // 3 * part, at) for part, at in ((1, 0.0), (2, 0.1), (3, 0.2))]
    hear(bench, info(), *images, depth(1.0, 1.0, at=0.12))
    cloud = displayed_points(bench)
    assert cloud is not None
    assert cloud.colors[0, 0] == pytest.approx(170 / 255)


def test_compressed_images_arrive_on_separate_topics() -> None:
    bench = Bench()
    add(
        bench,
        color_image_topic=COLOR,
        color_transport_hint="compressed",
        depth_map_transport_hint="compressed",
    )
    bench.publish(INFO, info())
    packed_depth = packed(np.array([[1000, 2000]], np.uint16), "16UC1; png compressed")
    bench.publish(f"{DEPTH}/compressed", stamped(packed_depth))
    bench.publish(f"{COLOR}/compressed", stamped(packed(RED, "rgb8; png compressed bgr8")))
    bench.update()
    cloud = displayed_points(bench)
    assert cloud is not None
    assert cloud.points[:, 2].tolist() == [1, 2]
    assert isinstance(packed_depth, CompressedImage)


def test_mismatched_images_are_errors_with_rviz_text() -> None:
    bench = Bench()
    display = add(bench)
    hear(bench, info(width=5), depth(1.0, 2.0))
    level, text = bench.status(display, "Message") or ("", "")
    assert level == "error"
    assert text.startswith(
        "Error updating depth cloud: Depth image size and camera info don't match: 2 x 1 vs"
    )
    hear(bench, info(), depth(1.0, 2.0))
    assert bench.status(display, "Message") is None
    assert bench.status(display, "Points") == ("ok", "Showing [2] points from [1] messages")


def test_color_image_in_another_frame_causes_a_hint() -> None:
    bench = Bench()
    display = add(bench, color_image_topic=COLOR)
    hear(bench, info(), depth(1.0, 1.0), color(frame="elsewhere"))
    assert "frame id [map] doesn't match color image frame id [elsewhere]" in " ".join(bench.hints(display))


def test_occluded_points_are_kept_until_the_timeout_or_a_camera_motion() -> None:
    bench = Bench("fixed")
    display = add(bench, occlusion_compensation=True)
    display["Occlusion Time-Out"] = 5.0
    observed = []
    moves = {0.0: 0.0, 1.0: 0.001, 7.0: 0.001, 8.0: 0.5}  # [s]: where the camera is, [m]
    for at, x in moves.items():
        bench.transform("fixed", "map", (x, 0.0, 0.0), at=at, static=False)
        hear(bench, info(), depth(*((1.0, 2.0) if at == 1.0 else (4.0, 4.0)), at=at), at=at)
        cloud = displayed_points(bench)
        observed.append(0 if cloud is None else len(cloud.points))
    assert observed == [2, 4, 2, 2]
    hear(bench, depth(1.0, 1.0, at=8.0), at=8.0)
    display["Occlusion Compensation"] = False
    hear(bench, depth(1.0, 1.0, at=8.0), at=8.0)
    cloud = displayed_points(bench)
    assert cloud is not None
    assert len(cloud.points) == 2


def test_qos_follows_the_properties() -> None:
    bench = Bench()
    display = add(bench)
    assert display.subscriptions[1].qos == Qos(depth=5, reliability="best_effort")
    display["Reliability Policy"], display["Queue Size"] = "Reliable", 9
    assert display.subscriptions[1].qos == Qos(depth=9, reliability="reliable")
