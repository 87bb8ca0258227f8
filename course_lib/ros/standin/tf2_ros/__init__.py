from tf2_py import *  # noqa: F403  # tf2's exceptions

from tf2_ros.buffer import Buffer as Buffer
from tf2_ros.buffer_interface import TransformRegistration as TransformRegistration
from tf2_ros.buffer_interface import TypeException as TypeException
from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster as StaticTransformBroadcaster
from tf2_ros.transform_broadcaster import TransformBroadcaster as TransformBroadcaster
from tf2_ros.transform_listener import TransformListener as TransformListener
