"""Descriptions of components and parameters in launch files."""

from launch_ros.actions import ComposableLifecycleNode as ComposableLifecycleNode
from launch_ros.actions import ComposableNode as ComposableNode
from launch_ros.parameter_descriptions import Parameter as Parameter
from launch_ros.parameter_descriptions import ParameterFile as ParameterFile
from launch_ros.parameter_descriptions import ParameterValue as ParameterValue
