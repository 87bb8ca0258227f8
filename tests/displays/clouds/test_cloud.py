import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from course_lib.displays.clouds import Cloud, channels_of, size_problem
from tests.displays.clouds.clouds import cloud, plain


@settings(deadline=None)  # machines may be busy
@given(st.permutations(["x", "y", "z", "a", "b"]), st.integers(0, 7), st.sampled_from("<>"))
def test_fields_are_read_regardless_of_order_gaps_and_byte_order(
    names: list[str], gap: int, order: str
) -> None:
    kinds = {"a": "f8", "b": "u2"}
    offsets = np.cumsum([gap, *(8 + gap for _ in names[1:])]).tolist()
    formats = [order + kinds.get(name, "f4") for name in names]
    dtype = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": offsets[-1] + 11})
    points = np.zeros(6, dtype)
    for number, name in enumerate(names):
        points[name] = np.arange(6) * (number + 1)
    channels, wrong = channels_of(cloud(points))
    assert wrong == []
    for name in names:
        np.testing.assert_array_equal(channels[name], points[name])


@settings(deadline=None)  # machines may be busy
@given(st.lists(st.sampled_from([0.0, 1.5, np.nan, np.inf, -np.inf]), min_size=3, max_size=30))
def test_only_finite_points_are_kept(numbers: list[float]) -> None:
    positions = np.reshape(numbers[: len(numbers) // 3 * 3], (-1, 3))
    channels, _ = channels_of(cloud(plain(positions, number=np.arange(len(positions), dtype="u4"))))
    kept = np.isfinite(positions).all(axis=1)
    np.testing.assert_array_equal(channels["number"], np.flatnonzero(kept))
    np.testing.assert_array_equal(Cloud(channels, np.eye(4), 0).positions, positions[kept])


def test_field_outside_the_point_step_is_ignored_and_reported() -> None:
    message = cloud(plain([[1, 2, 3]]))
    message.fields[1].offset = 9
    channels, wrong = channels_of(message)
    assert sorted(channels) == ["x", "z"]
    assert wrong == ["field 'y' (datatype 7, offset 9) is not a number within the 12 bytes of a point."]


@pytest.mark.parametrize("change", [{"width": 3}, {"height": 2}, {"point_step": 13}, {"data": b""}])
def test_inconsistent_cloud_sizes_are_reported_with_rviz_text(change: dict[str, object]) -> None:
    message = cloud(plain([[1, 2, 3], [4, 5, 6]]))
    assert size_problem(message) is None
    for name, value in change.items():
        setattr(message, name, value)
    assert size_problem(message) == (
        f"Data size ({len(message.data)} bytes) does not match width ({message.width}) times "
        f"height ({message.height}) times point_step ({message.point_step}).  Dropping message."
    )
