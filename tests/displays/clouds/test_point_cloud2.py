import numpy as np
import pytest

from course_lib.displays.clouds import STYLES
from tests.displays.bench import Bench
from tests.displays.clouds.clouds import TOPIC, add, cloud, plain, points_of

TWO = [[1, 2, 3], [4, 5, 6]]


def test_cloud_is_placed_by_its_frame_and_its_points_are_counted() -> None:
    bench = Bench()
    bench.transform("map", "laser", (1.0, 0.0, 0.0))
    display = add(bench)
    bench.publish(TOPIC, cloud(plain(TWO), "laser"))
    bench.update()
    (points,) = points_of(bench, display)
    np.testing.assert_array_equal(points.points, TWO)
    assert bench.status(display, "Points") == ("ok", "Showing [2] points from [1] messages")
    path = f"{display.path}/clouds/1"
    assert bench.scene.world_transform(path)[:3, 3].tolist() == [1.0, 0.0, 0.0]


def test_cloud_in_an_unknown_frame_is_an_error_and_the_next_cloud_is_shown() -> None:
    bench = Bench()
    display = add(bench)
    for frame in ("nowhere", ""):
        bench.publish(TOPIC, cloud(plain(TWO), frame))
        bench.update()
        assert bench.status(display, "Transform") == ("error", f"Could not transform from [{frame}] to [map]")
        assert not points_of(bench, display)
    bench.publish(TOPIC, cloud(plain(TWO)))
    bench.update()
    assert bench.status(display, "Transform") == ("ok", "Ok")
    assert len(points_of(bench, display)) == 1


def test_inconsistent_sizes_are_an_error_until_a_valid_cloud_is_received() -> None:
    bench = Bench()
    display = add(bench)
    wrong = cloud(plain(TWO))
    wrong.width = 3
    bench.publish(TOPIC, wrong)
    bench.update()
    assert bench.status(display, "Message") == (
        "error",
        "Data size (24 bytes) does not match width (3) times height (1) times point_step (12).  "
        "Dropping message.",
    )
    bench.publish(TOPIC, cloud(plain(TWO)))
    bench.update()
    assert bench.status(display, "Message") is None


def test_double_precision_positions_have_no_transformer() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish(TOPIC, cloud(np.zeros(2, np.dtype([(axis, "<f8") for axis in "xyz"]))))
    bench.update()
    assert bench.status(display, "Message") == ("error", "No position transformer available for cloud")


def test_missing_coordinates_cause_a_hint_although_rviz_reports_nothing() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish(TOPIC, cloud(np.zeros(2, np.dtype([("x", "<f4"), ("y", "<f4")]))))
    bench.update()
    assert bench.status(display, "Message") is None
    assert bench.hints(display) == ["the cloud has no fields x, y and z: RViz draws nothing."]


@pytest.mark.parametrize(("decay", "remaining"), [(0.0, 1), (0.25, 2), (10.0, 4)])
def test_clouds_are_kept_for_the_decay_time(decay: float, remaining: int) -> None:
    bench = Bench()
    display = add(bench, decay_time=decay)
    for number in range(4):
        bench.publish(TOPIC, cloud(plain([[number, 0, 0]])), at=number * 0.2)
        bench.update(number * 0.2)
    assert [points.points[0, 0] for points in points_of(bench, display)] == list(range(4))[-remaining:]
    assert bench.status(display, "Points") == (
        "ok",
        f"Showing [{remaining}] points from [{remaining}] messages",
    )


def test_last_cloud_is_kept_without_a_decay_time() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish(TOPIC, cloud(plain(TWO)))
    bench.update(100.0)
    assert len(points_of(bench, display)) == 1
    display["Decay Time"] = 1.0
    bench.update(100.0)
    assert not points_of(bench, display)


@pytest.mark.parametrize("style", STYLES)
def test_each_style_has_its_shape_and_size(style: str) -> None:
    bench = Bench()
    display = add(bench, style=style, **{"Size (m)": 0.5, "Size (Pixels)": 7.0})
    bench.publish(TOPIC, cloud(plain(TWO)))
    bench.update()
    (points,) = points_of(bench, display)
    assert points.spot == STYLES[style]
    assert points.pixels == (style == "Points")
    assert points.size == ((7.0,) * 3 if points.pixels else (0.5,) * 3)


def test_changed_property_redraws_the_current_cloud() -> None:
    bench = Bench()
    display = add(bench, color_transformer="FlatColor")
    bench.publish(TOPIC, cloud(plain(TWO)))
    display["Color"] = (255, 0, 0)
    display["Alpha"] = 0.5
    (points,) = points_of(bench, display)
    np.testing.assert_allclose(points.colors, [[1, 0, 0, 0.75]] * 2)  # drawn twice


def test_empty_cloud_has_no_points() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish(TOPIC, cloud(plain([])))
    bench.update()
    assert bench.status(display, "Points") == ("ok", "Showing [0] points from [1] messages")


def test_argument_name_of_a_property_has_no_parentheses() -> None:
    display = Bench().session.add("rviz_default_plugins/PointCloud2", "Cloud", {}, size_m=0.2)
    assert display["Size (m)"] == display["size_m"] == 0.2
    display["size_pixels"] = 5
    assert display["Size (Pixels)"] == 5.0
