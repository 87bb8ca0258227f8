"""Names for the types of arrays. Shape, unit and frame are documented where an array is used."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

# (x, y, z)
Vector: TypeAlias = tuple[float, float, float]

Floats: TypeAlias = NDArray[np.float64]
# Two-dimensional arrays or stacks of them, mostly of shape (4, 4).
Matrix: TypeAlias = NDArray[np.float64]
# Floating-point arrays of any precision.
Reals: TypeAlias = NDArray[np.floating]
Indices: TypeAlias = NDArray[np.intp]
Bools: TypeAlias = NDArray[np.bool_]
Bytes: TypeAlias = NDArray[np.uint8]
# RGB, shape (rows, columns, 3).
Pixels: TypeAlias = NDArray[np.uint8]
AnyArray: TypeAlias = NDArray[Any]

# Arrays for the graphics card, which uses single precision.
Float32s: TypeAlias = NDArray[np.float32]
# Indices into arrays for the graphics card.
UInt32s: TypeAlias = NDArray[np.uint32]
