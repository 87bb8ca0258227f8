"""The `--qos-…` options of `ros2 topic echo` and `pub` (ros2topic.api)."""

from argparse import Namespace
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from course_lib.ros.qos import Qos
from course_lib.tools.verb import Option, Write, value

PRESETS: Mapping[str, Qos] = {
    "system_default": Qos(depth=1),
    "sensor_data": Qos(depth=5, reliability="best_effort"),
    "services_default": Qos(),
    "parameters": Qos(depth=1000),
    "parameter_events": Qos(depth=1000),
    "action_status_default": Qos(depth=1, durability="transient_local"),
    "default": Qos(),
}
_CHOICES: Mapping[str, tuple[str, ...]] = {
    "history": ("keep_last", "keep_all"),
    "reliability": ("reliable", "best_effort"),
    "durability": ("transient_local", "volatile"),
    "liveliness": ("automatic", "manual_by_topic"),
}


def qos_options(verb: str, preset: str) -> tuple[Option, ...]:
    """Give the options; `verb` is subscribe or publish."""
    return (
        value(
            "--qos-profile",
            choices=tuple(PRESETS),
            default=preset,
            help=f"Quality of service preset profile to {verb} with (default: {preset})",
        ),
        value("--qos-depth", type=int, metavar="N", help=f"Queue size setting to {verb} with"),
        *(
            value(f"--qos-{name}", choices=names, help=f"Quality of service {name} setting to {verb} with")
            for name, names in _CHOICES.items()
        ),
    )


def asked_qos(arguments: Namespace) -> Qos | None:
    """Give the preset with what was asked for instead of its settings; None if nothing was."""
    names = (*_CHOICES, "depth")
    given: dict[str, Any] = {name: getattr(arguments, f"qos_{name}") for name in names}
    changes = {name: setting for name, setting in given.items() if setting is not None}
    return replace(PRESETS[arguments.qos_profile], **changes) if changes else None


def adapted_qos(offered: list[Qos], preset: Qos, write: Write) -> Qos:
    """Request what all publishers offer, as ROS does."""
    qos = preset
    for name, strong, weak in (
        ("reliability", "reliable", "best_effort"),
        ("durability", "transient_local", "volatile"),
    ):
        count = sum(getattr(one, name) == strong for one in offered)
        if 0 < count < len(offered):
            policy = f"QoS{name.capitalize()}Policy."
            write(
                f"Some, but not all, publishers are offering {policy}{strong.upper()}. Falling back to "
                f"{policy}{weak.upper()} as it will connect to all publishers\n"
            )
        common: dict[str, Any] = {name: strong if count == len(offered) else weak}
        qos = replace(qos, **common) if offered else qos
    return qos
