"""Arrays at the viewer's border: what comes in is checked, converted and frozen once."""

from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Float32s
from course_lib.errors import CourseError


class ShapeError(CourseError):
    """An array does not have the shape that its name asks for."""


def checked(name: str, value: npt.ArrayLike, dtype: npt.DTypeLike, *shapes: tuple[int | None, ...]) -> Any:
    """Return a read-only copy of an array that has one of the shapes (None stands for any length).

    Raises:
        ShapeError: If it has none of them; the message shows both shapes.
    """
    array = np.array(value, dtype=dtype)
    if array.size == 0 and not shapes[0][0]:  # [] is an empty list of anything
        array = array.reshape(tuple(length or 0 for length in shapes[0]))
    if array.shape not in shapes and not any(_fits(array.shape, shape) for shape in shapes):
        wanted = " or ".join(_shape_text(shape) for shape in shapes)
        raise ShapeError(f"{name} has shape {_shape_text(array.shape)}, expected {wanted}.")
    array.setflags(write=False)
    return array


def floats(name: str, value: npt.ArrayLike, *shapes: tuple[int | None, ...]) -> Float32s:
    """Check an array and keep it in single precision, as it is drawn."""
    array: Float32s = checked(name, value, np.float32, *shapes)
    return array


def rgba(value: npt.ArrayLike, count: int | None = None) -> Float32s:
    """Check RGBA, shape (4,), or also (count, 4), and keep it within 0..1; what is no number is 0."""
    shapes = ((4,),) if count is None else ((count, 4), (4,))
    checked_rgba: Float32s = np.nan_to_num(floats("colors", value, *shapes)).clip(0, 1)
    checked_rgba.setflags(write=False)
    return checked_rgba


def _fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    return len(shape) == len(wanted) and all(w in (None, n) for n, w in zip(shape, wanted, strict=True))


def _shape_text(shape: tuple[int | None, ...]) -> str:
    return f"({', '.join('N' if length is None else str(length) for length in shape)})"
