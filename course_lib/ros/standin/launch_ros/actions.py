"""The actions of a launch with nodes; each takes a `condition`."""

from launch.actions import TimerAction

from launch_ros.composition import ComposableNodeContainer as ComposableNodeContainer
from launch_ros.composition import LoadComposableNodes as LoadComposableNodes
from launch_ros.nodes import LifecycleNode as LifecycleNode
from launch_ros.nodes import Node as Node
from launch_ros.settings import PushROSNamespace as PushROSNamespace
from launch_ros.settings import PushRosNamespace as PushRosNamespace
from launch_ros.settings import SetParameter as SetParameter
from launch_ros.settings import SetParametersFromFile as SetParametersFromFile
from launch_ros.settings import SetRemap as SetRemap
from launch_ros.settings import SetROSLogDir as SetROSLogDir
from launch_ros.settings import SetUseSimTime as SetUseSimTime
from launch_ros.transitions import LifecycleTransition as LifecycleTransition


class ROSTimer(TimerAction):
    """Actions after so many seconds of ROS time, which is robot time."""


RosTimer = ROSTimer
