"""Conversions of occupancy grids."""

from typing import Any

import numpy as np
from nav_msgs.msg import MapMetaData, OccupancyGrid

from ros2_numpy.registry import converts_from_numpy, converts_to_numpy


@converts_to_numpy(OccupancyGrid)
def occupancygrid_to_numpy(msg: OccupancyGrid) -> "np.ma.MaskedArray[Any, np.dtype[np.int8]]":
    """Return the cells, shape (height, width). Unknown cells, with the value -1, are masked."""
    cells = np.asarray(msg.data, dtype=np.int8).reshape(msg.info.height, msg.info.width)
    return np.ma.array(cells, mask=cells == -1, fill_value=-1)


@converts_from_numpy(OccupancyGrid)
def numpy_to_occupancy_grid(arr: Any, info: MapMetaData | None = None) -> OccupancyGrid:
    """Convert cells of type int8, shape (height, width), to a map. Masked cells are unknown.

    Raises:
        TypeError: The array has another shape or type.
    """
    if np.ndim(arr) != 2:
        raise TypeError("Array must be 2D")
    if arr.dtype != np.int8:
        raise TypeError("Array must be of int8s")
    cells = arr.filled(-1) if isinstance(arr, np.ma.MaskedArray) else arr
    about = info or MapMetaData()
    about.height, about.width = map(int, cells.shape)
    return OccupancyGrid(info=about, data=cells.ravel().tolist())
