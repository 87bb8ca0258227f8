"""The names of parameter_descriptions, where some launch files look for them."""

from launch_ros.parameter_descriptions import ParameterFile as ParameterFile
from launch_ros.parameter_descriptions import ParameterValue as ParameterValue
