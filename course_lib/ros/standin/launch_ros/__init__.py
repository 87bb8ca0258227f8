"""Stand-in for launch_ros, the actions and substitutions for nodes in launch files."""

from importlib import import_module
from types import ModuleType

_MODULES = (
    "actions",
    "descriptions",
    "event_handlers",
    "events",
    "parameter_descriptions",
    "substitutions",
    "utilities",
)


def __getattr__(name: str) -> ModuleType:
    """Import a submodule on first access, as it is imported together with ROS's package."""
    if name in _MODULES:
        return import_module(f"launch_ros.{name}")
    raise AttributeError(f"module 'launch_ros' has no attribute '{name}'")
