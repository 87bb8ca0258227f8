import numpy as np
import pytest

from course_lib.displays.map import SCHEMES, palette

MINUS_ONE, MINUS_TWO = 255, 254  # as bytes
GREY = (0x70, 0x89, 0x86, 255)


def test_map_palette_ranges_from_white_to_black() -> None:
    colors = palette("map")
    assert [tuple(colors[value]) for value in (0, 50, 100)] == [
        (255, 255, 255, 255),
        (128, 128, 128, 255),
        (0, 0, 0, 255),
    ]


def test_costmap_is_transparent_if_free_and_cyan_and_magenta_at_obstacles() -> None:
    colors = palette("costmap")
    assert colors[0, 3] == 0
    assert tuple(colors[1]) == (2, 0, 253, 255)
    assert tuple(colors[99]) == (0, 255, 255, 255)
    assert tuple(colors[100]) == (255, 0, 255, 255)


def test_raw_scheme_shows_the_byte_as_gray() -> None:
    assert (palette("raw")[:, :3] == np.arange(256)[:, None]).all()


@pytest.mark.parametrize("threshold", [None, 50])
@pytest.mark.parametrize("scheme", ["map", "costmap"])
def test_invalid_cell_values_have_distinct_colors(scheme: str, threshold: int | None) -> None:
    colors = palette(scheme, threshold)
    assert tuple(colors[MINUS_ONE]) == GREY
    assert tuple(colors[101]) == tuple(colors[127]) == (0, 255, 0, 255)
    assert tuple(colors[128]) == (255, 0, 0, 255)
    assert tuple(colors[MINUS_TWO]) == (255, 255, 0, 255)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_binary_map_changes_only_at_its_threshold(scheme: str) -> None:
    colors = palette(scheme, 65)
    assert len(np.unique(colors[:65], axis=0)) == 1
    assert len(np.unique(colors[65:101], axis=0)) == 1
    assert (colors[64] != colors[65]).any()
