"""ROS's launch: descriptions of programs to start, in Python, XML and YAML files; the kit's stand-in."""

from launch.entities import Action as Action
from launch.entities import Condition as Condition
from launch.entities import Event as Event
from launch.entities import InvalidLaunchFileError as InvalidLaunchFileError
from launch.entities import LaunchContext as LaunchContext
from launch.entities import LaunchDescription as LaunchDescription
from launch.entities import LaunchDescriptionEntity as LaunchDescriptionEntity
from launch.entities import SomeSubstitutionsType as SomeSubstitutionsType
from launch.entities import Substitution as Substitution
from launch.event_handlers import EventHandler as EventHandler
from launch.launch_description_sources import LaunchDescriptionSource as LaunchDescriptionSource
from launch.service import LaunchIntrospector as LaunchIntrospector
from launch.service import LaunchService as LaunchService
