"""Conversions between messages and numpy arrays: `numpify(message)` and `msgify(Type, array)`."""

from ros2_numpy import geometry as geometry
from ros2_numpy import image as image
from ros2_numpy import occupancy_grid as occupancy_grid
from ros2_numpy import point_cloud2 as point_cloud2
from ros2_numpy.registry import msgify as msgify
from ros2_numpy.registry import numpify as numpify
