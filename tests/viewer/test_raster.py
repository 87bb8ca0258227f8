import numpy as np
import pytest

from course_lib.viewer.zbuffer import clipped, covered


def samples(xy: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    return np.concatenate([part.sample for part in covered(xy, size)])


def test_two_halves_of_a_square_cover_each_sample_once() -> None:
    square = np.array([[[1, 1], [9, 1], [9, 9]], [[1, 1], [9, 9], [1, 9]]], float)
    found, times = np.unique(samples(square, (10, 10)), return_counts=True)
    assert len(found) == 64
    assert (times == 1).all()


def test_a_triangle_covers_its_area() -> None:
    triangle = np.array([[[10.3, 12.1], [180.2, 40.5], [77.7, 190.9]]])
    a, b, c = triangle[0]
    area = abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2
    assert len(samples(triangle, (200, 200))) == pytest.approx(area, rel=0.01)


def test_shares_are_the_corners_weights() -> None:
    triangle = np.array([[[0, 0], [8, 0], [0, 8]]], float)
    part = next(covered(triangle, (8, 8)))
    centres = np.stack([part.sample % 8, part.sample // 8], axis=1) + 0.5
    assert part.share @ triangle[0] == pytest.approx(centres)
    assert part.share.sum(axis=1) == pytest.approx(1)


def test_what_is_off_the_picture_or_flat_or_no_number_covers_nothing() -> None:
    off = [[-9, -9], [-5, -9], [-9, -5]]
    flat = [[1, 1], [5, 5], [9, 9]]
    broken = [[1, 1], [np.nan, 5], [9, 2]]
    with np.errstate(invalid="ignore"):
        assert [len(samples(np.array([bad], float), (10, 10))) for bad in (off, flat, broken)] == [0, 0, 0]


def test_clipping_keeps_what_is_ahead_and_interpolates_the_rest() -> None:
    # depths 3, 1 and -1: one corner is behind the eye
    triangle = np.array([[[0, 0, -3, 0.0], [4, 0, -1, 1.0], [0, 4, 1, 2.0]]], np.float32)
    pieces = clipped(triangle, 0.5)
    assert len(pieces) == 2
    assert (-pieces[..., 2] >= 0.5 - 1e-6).all()
    assert pieces[..., 3] == pytest.approx((3 + pieces[..., 2]) / 2, abs=1e-6)
    nearer = np.array([0, 0, 9, 0], np.float32)
    assert len(clipped(triangle - nearer, 0.5)) == 1
    assert len(clipped(triangle + nearer, 0.5)) == 0
