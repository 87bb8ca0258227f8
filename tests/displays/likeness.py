"""Likeness of two pictures of the same scene: outline and hue, not brightness."""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageFilter

Pixels: TypeAlias = npt.NDArray[np.float64]  # (H, W, 3), 0..255
Mask: TypeAlias = npt.NDArray[np.bool_]  # (H, W)

SHAPE, COLOUR = 0.97, 0.90  # required similarity to RViz's pictures

_STANDS_OUT = 14  # from the background, in one channel
_DARK = 40  # below this, a pixel has no hue to speak of
_SAME_HUE = 0.12  # in the share that one channel has of all


@dataclass(frozen=True)
class Likeness:
    """The likeness of two pictures.

    Args:
        shape: F1 of the outlines, with a tolerance of two pixels, in [0, 1].
        colour: Share of the pixels drawn in both that have the same hue, in [0, 1].
    """

    shape: float
    colour: float


def likeness(reference: Image.Image, picture: Image.Image, background: tuple[int, int, int]) -> Likeness:
    """Compare two pictures of the same size."""
    ours, theirs = (np.asarray(image.convert("RGB"), dtype=float) for image in (picture, reference))
    assert ours.shape == theirs.shape
    in_ours, in_theirs = (np.abs(pixels - background).max(axis=2) > _STANDS_OUT for pixels in (ours, theirs))
    assert in_ours.any()
    assert in_theirs.any()
    precision = (in_ours & _grown(in_theirs)).sum() / in_ours.sum()
    recall = (in_theirs & _grown(in_ours)).sum() / in_theirs.sum()
    both = in_ours & in_theirs
    shape = 2 * precision * recall / max(precision + recall, 1e-9)
    return Likeness(float(shape), _same_hue(ours[both], theirs[both]))


def _grown(mask: Mask) -> Mask:
    image = Image.fromarray(mask.astype(np.uint8) * 255).filter(ImageFilter.MaxFilter(5))
    grown: Mask = np.asarray(image) > 0
    return grown


def _same_hue(ours: Pixels, theirs: Pixels) -> float:
    """Return the share of pixels, shape (N, 3), that have the same hue."""
    bright = (ours.max(axis=1) >= _DARK) & (theirs.max(axis=1) >= _DARK)
    shares = [pixels / np.maximum(pixels.sum(axis=1, keepdims=True), 1) for pixels in (ours, theirs)]
    same = np.abs(shares[0] - shares[1]).max(axis=1) < _SAME_HUE
    return float(same[bright].mean()) if bright.any() else 1.0
