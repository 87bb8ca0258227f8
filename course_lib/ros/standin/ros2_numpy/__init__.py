"""Conversions between messages and numpy arrays: `numpify(message)` and `msgify(Type, array)`."""

# ROS's modules for them, each of which has the names of the one module here.
from ros2_numpy import conversions as geometry
from ros2_numpy import conversions as image
from ros2_numpy import conversions as occupancy_grid
from ros2_numpy import conversions as point_cloud2
from ros2_numpy import conversions as registry
from ros2_numpy.conversions import msgify, numpify

__all__ = ["geometry", "image", "msgify", "numpify", "occupancy_grid", "point_cloud2", "registry"]
