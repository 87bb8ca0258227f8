# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._grid_cells import GridCells as GridCells
from ._map_meta_data import MapMetaData as MapMetaData
from ._occupancy_grid import OccupancyGrid as OccupancyGrid
from ._odometry import Odometry as Odometry
from ._path import Path as Path
