"""Events of nodes in a launch; the kit's stand-in."""

from launch_ros.events import lifecycle as lifecycle
from launch_ros.events import matchers as matchers
