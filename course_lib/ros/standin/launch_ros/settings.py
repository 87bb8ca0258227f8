"""Actions that change the settings of all nodes that follow in the group."""

import os
from typing import Any

from launch.conditions import as_bool
from launch.entities import Action, LaunchContext, text_of
from launch.entities import SomeSubstitutionsType as Some

from launch_ros.parameter_descriptions import ParameterFile, evaluated

NAMESPACE, PARAMETERS, REMAPS = "ros_namespace", "global_params", "ros_remaps"  # launch configurations


class PushRosNamespace(Action):
    """Puts the nodes that follow in the group into a namespace."""

    def __init__(self, namespace: Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            settings = context.launch_configurations
            settings[NAMESPACE] = joined(settings.get(NAMESPACE, ""), text_of(context, namespace))

        super().__init__(do, **options)


PushROSNamespace = PushRosNamespace


class SetParameter(Action):
    """A parameter for all nodes that follow."""

    def __init__(self, name: Some, value: Any, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            _add(context, PARAMETERS, {text_of(context, name): evaluated(context, value)})

        super().__init__(do, **options)


class SetParametersFromFile(Action):
    """A file of parameters for all nodes that follow."""

    def __init__(self, filename: Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            _add(context, PARAMETERS, ParameterFile(text_of(context, filename)))

        super().__init__(do, **options)


class SetUseSimTime(Action):
    """The parameter `use_sim_time` for all nodes that follow."""

    def __init__(self, value: bool | Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            _add(context, PARAMETERS, {"use_sim_time": as_bool(context, value)})

        super().__init__(do, **options)


class SetRemap(Action):
    """Another name for a topic of all nodes that follow."""

    def __init__(self, src: Some, dst: Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            _add(context, REMAPS, (text_of(context, src), text_of(context, dst)))

        super().__init__(do, **options)


class SetROSLogDir(Action):
    """The folder for logs, in the environment of what follows."""

    def __init__(self, new_log_dir: Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            os.environ["ROS_LOG_DIR"] = text_of(context, new_log_dir)

        super().__init__(do, **options)


def _add(context: LaunchContext, setting: str, entry: Any) -> None:
    settings = context.launch_configurations
    settings[setting] = [*settings.get(setting, ()), entry]  # a new list: the group's end ends it


def joined(outer: str, inner: str) -> str:
    """Join a namespace to an outer one, absolute; an absolute one stands for itself."""
    whole = inner if inner.startswith("/") or not outer else f"{outer.rstrip('/')}/{inner}"
    whole = whole.rstrip("/")
    return f"/{whole}" if whole and not whole.startswith("/") else whole
