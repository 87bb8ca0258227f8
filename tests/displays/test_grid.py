from math import pi
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from course_lib.displays.display import Display
from course_lib.viewer.drawables import Lines
from tests.displays.bench import Bench

NODE = "displays/Grid/drawing"


def grid(bench: Bench, **properties: Any) -> Display:
    return bench.session.add("rviz_default_plugins/Grid", "Grid", {}, **properties)


def lines(bench: Bench) -> Lines:
    drawable = bench.scene.objects()[NODE]
    assert isinstance(drawable, Lines)
    return drawable


def ends(bench: Bench) -> npt.NDArray[np.float64]:
    """Return all ends of lines in the fixed frame, shape (N, 3)."""
    points = np.column_stack([lines(bench).points, np.ones(len(lines(bench).points))])
    in_fixed: npt.NDArray[np.float64] = (bench.scene.world_transform(NODE) @ points.T).T[:, :3]
    return np.round(in_fixed, 6)


def test_default_grid_is_ten_by_ten_meters_on_the_ground() -> None:
    bench = Bench()
    grid(bench)
    assert len(lines(bench).points) == 2 * 2 * 11
    assert np.abs(ends(bench)).max(axis=0).tolist() == [5.0, 5.0, 0.0]
    np.testing.assert_allclose(lines(bench).colors, [160 / 255, 160 / 255, 164 / 255, 0.5], rtol=1e-6)
    assert lines(bench).width == 0.0


@pytest.mark.parametrize(("plane", "flat"), [("XY", 2), ("XZ", 1), ("YZ", 0)])
def test_plane_property_orients_the_grid(plane: str, flat: int) -> None:
    bench = Bench()
    grid(bench, Plane=plane)
    extent = np.abs(ends(bench)).max(axis=0)
    assert np.flatnonzero(extent == 0).tolist() == [flat]


def test_normal_cell_count_adds_layers_and_posts() -> None:
    bench = Bench()
    grid(bench, plane_cell_count=2, normal_cell_count=3, cell_size=0.5)
    assert np.abs(ends(bench)).max(axis=0).tolist() == [0.5, 0.5, 0.75]
    assert len(lines(bench).points) == 2 * (2 * 3 * 4 + 3 * 3)


def test_billboards_have_a_width_and_lines_do_not() -> None:
    bench = Bench()
    display = grid(bench, line_width=0.1)
    assert lines(bench).width == 0.0
    display["Line Style"] = "Billboards"
    assert lines(bench).width == pytest.approx(0.1)


def test_offset_and_reference_frame_move_the_grid() -> None:
    bench = Bench()
    bench.transform("map", "base", (10.0, 0.0, 1.0), yaw=pi / 2)
    grid(bench, reference_frame="base", offset=(2.0, 0.0, 0.5), plane_cell_count=1)
    np.testing.assert_allclose(ends(bench).mean(axis=0), [10, 2, 1.5])
    bench.transform("map", "base", (0.0, 0.0, 0.0), at=1.0)
    bench.update(1.0)
    np.testing.assert_allclose(ends(bench).mean(axis=0), [2, 0, 0.5])


def test_unknown_frame_hides_the_grid_and_is_an_error_with_rviz_text() -> None:
    bench = Bench()
    display = grid(bench, reference_frame="base")
    assert not bench.scene.is_visible(NODE)
    assert bench.status(display, "Transform") == ("error", "Could not transform from [base] to [map]")
    display["Reference Frame"] = "<Fixed Frame>"
    assert bench.scene.is_visible(NODE)
    assert bench.status(display, "Transform") == ("ok", "Ok")


def test_grid_is_redrawn_after_a_change_of_the_fixed_frame() -> None:
    bench = Bench()
    grid(bench)
    bench.session.fixed_frame = "odom"
    assert bench.scene.is_visible(NODE)
    assert len(ends(bench)) == 44


def test_oversized_grid_is_reported_and_not_drawn() -> None:
    bench = Bench()
    display = grid(bench, plane_cell_count=10**9, normal_cell_count=10**6)
    bench.update()
    assert len(lines(bench).points) == 0
    assert "at most 100000 are drawn" in bench.hints(display)[0]
    display["Plane Cell Count"], display["Normal Cell Count"] = 4, 0
    bench.update()
    assert len(lines(bench).points) == 20
    assert bench.hints(display) == []


def test_scene_does_not_change_while_other_frames_move_and_the_fixed_frame_rests() -> None:
    bench = Bench()
    grid(bench)
    bench.transform("map", "base", static=False)
    bench.update(0.0)
    received: list[tuple[str, str]] = []
    bench.scene.listen(lambda kind, path: received.append((kind, path)))
    for step in range(1, 5):
        bench.transform("map", "base", (0.1 * step, 0.0, 0.0), at=0.1 * step, static=False)
        bench.update(0.1 * step)
    assert received == []
