import numpy as np
import pytest

from course_lib.viewer.renderer import clip_triangles, covered_samples


def samples(xy: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    return np.concatenate([part.sample for part in covered_samples(xy, size)])


def test_two_triangles_of_a_square_cover_each_sample_once() -> None:
    square = np.array([[[1, 1], [9, 1], [9, 9]], [[1, 1], [9, 9], [1, 9]]], float)
    found, times = np.unique(samples(square, (10, 10)), return_counts=True)
    assert len(found) == 64
    assert (times == 1).all()


def test_triangle_covers_its_area() -> None:
    triangle = np.array([[[10.3, 12.1], [180.2, 40.5], [77.7, 190.9]]])
    a, b, c = triangle[0]
    area = abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2
    assert len(samples(triangle, (200, 200))) == pytest.approx(area, rel=0.01)


def test_barycentric_coordinates_are_the_weights_of_the_vertices() -> None:
    triangle = np.array([[[0, 0], [8, 0], [0, 8]]], float)
    part = next(covered_samples(triangle, (8, 8)))
    centres = np.stack([part.sample % 8, part.sample // 8], axis=1) + 0.5
    assert part.share @ triangle[0] == pytest.approx(centres)
    assert part.share.sum(axis=1) == pytest.approx(1)


def test_offscreen_degenerate_or_nan_triangle_covers_no_pixels() -> None:
    off = [[-9, -9], [-5, -9], [-9, -5]]
    flat = [[1, 1], [5, 5], [9, 9]]
    broken = [[1, 1], [np.nan, 5], [9, 2]]
    with np.errstate(invalid="ignore"):
        assert [len(samples(np.array([bad], float), (10, 10))) for bad in (off, flat, broken)] == [0, 0, 0]


def test_clipping_keeps_the_visible_part_and_interpolates_attributes() -> None:
    # depths 3, 1 and -1: one corner is behind the eye
    triangle = np.array([[[0, 0, -3, 0.0], [4, 0, -1, 1.0], [0, 4, 1, 2.0]]], np.float32)
    pieces = clip_triangles(triangle, 0.5)
    assert len(pieces) == 2
    assert (-pieces[..., 2] >= 0.5 - 1e-6).all()
    assert pieces[..., 3] == pytest.approx((3 + pieces[..., 2]) / 2, abs=1e-6)
    nearer = np.array([0, 0, 9, 0], np.float32)
    assert len(clip_triangles(triangle - nearer, 0.5)) == 1
    assert len(clip_triangles(triangle + nearer, 0.5)) == 0
