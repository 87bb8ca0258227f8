"""ROS's launch: descriptions of what to start, in Python files; the kit's stand-in."""

from launch.action import Action as Action
from launch.action import LaunchDescriptionEntity as LaunchDescriptionEntity
from launch.conditions import Condition as Condition
from launch.events import Event as Event
from launch.launch_context import LaunchContext as LaunchContext
from launch.launch_description import LaunchDescription as LaunchDescription
from launch.launch_description_sources import LaunchDescriptionSource as LaunchDescriptionSource
from launch.substitution import SomeSubstitutionsType as SomeSubstitutionsType
from launch.substitution import Substitution as Substitution
