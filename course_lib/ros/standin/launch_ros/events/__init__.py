"""Events of nodes in a launch."""

from launch_ros.events import lifecycle as lifecycle
from launch_ros.events import matchers as matchers
