"""Components and parameters, as launch files describe them."""

from launch_ros.composition import ComposableNode as ComposableNode
from launch_ros.parameter_descriptions import Parameter as Parameter
from launch_ros.parameter_descriptions import ParameterFile as ParameterFile
from launch_ros.parameter_descriptions import ParameterValue as ParameterValue
