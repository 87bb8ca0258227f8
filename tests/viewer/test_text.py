import numpy as np
import pytest

from course_lib.viewer.encoding import rasterize


def ink(text: str) -> np.ndarray:
    return rasterize(text).mask > 128


def test_capital_letter_has_the_requested_height() -> None:
    rows = np.flatnonzero(ink("H").any(axis=1))
    assert len(rows) == pytest.approx(rasterize("H").pixels_per_height, abs=1)


@pytest.mark.parametrize("text", ["ÄÖÜ", "Привет", "αβγ", "→ ✓ ≤", "½ µ °"])
def test_letters_of_many_languages_have_glyphs(text: str) -> None:
    missing = ink("\uffff")
    for sign in text.replace(" ", ""):
        assert ink(sign).any()
        assert ink(sign).shape != missing.shape or (ink(sign) != missing).any()


def test_lines_are_drawn_below_each_other() -> None:
    two, one = ink("H\nH"), ink("H")
    assert two.any(axis=1).sum() == 2 * one.any(axis=1).sum()


@pytest.mark.parametrize("text", ["x" * 100_000, "x\n" * 100_000, ("x" * 70 + "\n") * 70])
def test_text_of_any_length_fits_the_texture_limit(text: str) -> None:
    glyphs = rasterize(text)
    assert max(glyphs.mask.shape) <= 4096
    assert glyphs.pixels_per_height > 0


def test_empty_text_is_not_drawn() -> None:
    assert not ink("").any()


def test_lines_begin_at_the_same_position() -> None:
    columns = [np.flatnonzero(ink(f"HHHH\nH{end}")[-60:].any(axis=0)) for end in ("", "\nH")]
    assert columns[0][0] == columns[1][0]
    assert columns[0][-1] < ink("HHHH\nH").shape[1] / 2


def test_space_has_the_requested_width_in_heights_of_a_capital_letter() -> None:
    def gap(width: float) -> int:
        inked = np.flatnonzero(rasterize("H H", width).mask.any(axis=0))
        return int(np.diff(inked).max())

    assert gap(5.0) - gap(1.0) == pytest.approx(4 * rasterize("H H").pixels_per_height, abs=2)
    assert rasterize("H H", 1e308).mask.shape[1] <= 4096


def test_text_with_a_space_has_the_font_of_text_without_one() -> None:
    one, two = ink("R"), ink("R R")
    letter = slice(np.flatnonzero(one.any(axis=0))[0], np.flatnonzero(one.any(axis=0))[-1] + 2)
    np.testing.assert_array_equal(two[:, letter], one[:, letter])
