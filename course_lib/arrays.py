"""Names for the types of arrays; shape, unit and frame stand where an array is used."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Vector: TypeAlias = tuple[float, float, float]  # (x, y, z)

Floats: TypeAlias = NDArray[np.float64]
Matrix: TypeAlias = NDArray[np.float64]  # of two dimensions, or a stack of such; mostly (4, 4)
Reals: TypeAlias = NDArray[np.floating]  # of any precision
Indices: TypeAlias = NDArray[np.intp]
Bools: TypeAlias = NDArray[np.bool_]
Bytes: TypeAlias = NDArray[np.uint8]
Pixels: TypeAlias = NDArray[np.uint8]  # RGB, shape (rows, columns, 3)
AnyArray: TypeAlias = NDArray[Any]

Float32s: TypeAlias = NDArray[np.float32]  # what a page draws
UInt32s: TypeAlias = NDArray[np.uint32]  # indices that a page draws with
