"""Stand-in for ROS's launch, with launch descriptions in Python, XML and YAML files."""

from launch.entities import Action as Action
from launch.entities import Condition as Condition
from launch.entities import Event as Event
from launch.entities import InvalidLaunchFileError as InvalidLaunchFileError
from launch.entities import LaunchContext as LaunchContext
from launch.entities import LaunchDescription as LaunchDescription
from launch.entities import LaunchDescriptionEntity as LaunchDescriptionEntity
from launch.entities import LaunchIntrospector as LaunchIntrospector
from launch.entities import LaunchService as LaunchService
from launch.entities import SomeEntitiesType as SomeEntitiesType
from launch.entities import SomeSubstitutionsType as SomeSubstitutionsType
from launch.entities import Substitution as Substitution
from launch.event_handlers import EventHandler as EventHandler
from launch.launch_description_sources import LaunchDescriptionSource as LaunchDescriptionSource
