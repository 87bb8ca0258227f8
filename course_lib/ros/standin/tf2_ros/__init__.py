# As in tf2_ros, the names of its modules are importable from the package. The official URDF
# tutorial imports one of them.
from geometry_msgs.msg import TransformStamped as TransformStamped
from rclpy.duration import Duration as Duration
from rclpy.node import Node as Node
from rclpy.qos import DurabilityPolicy as DurabilityPolicy
from rclpy.qos import HistoryPolicy as HistoryPolicy
from rclpy.qos import QoSProfile as QoSProfile
from rclpy.task import Future as Future
from rclpy.time import Time as Time
from tf2_msgs.msg import TFMessage as TFMessage
from tf2_py import *  # noqa: F403  # tf2's exceptions

from tf2_ros.buffer import Buffer as Buffer
from tf2_ros.buffer_interface import BufferInterface as BufferInterface
from tf2_ros.buffer_interface import ConvertRegistration as ConvertRegistration
from tf2_ros.buffer_interface import NotImplementedException as NotImplementedException
from tf2_ros.buffer_interface import Stamped as Stamped
from tf2_ros.buffer_interface import TransformRegistration as TransformRegistration
from tf2_ros.buffer_interface import TypeException as TypeException
from tf2_ros.buffer_interface import convert as convert
from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster as StaticTransformBroadcaster
from tf2_ros.transform_broadcaster import TransformBroadcaster as TransformBroadcaster
from tf2_ros.transform_listener import DEFAULT_STATIC_TF_TOPIC as DEFAULT_STATIC_TF_TOPIC
from tf2_ros.transform_listener import DEFAULT_TF_TOPIC as DEFAULT_TF_TOPIC
from tf2_ros.transform_listener import StaticTransformListener as StaticTransformListener
from tf2_ros.transform_listener import TransformListener as TransformListener
