"""Hatchling's build hook, which writes the type stubs of the message packages."""

import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

STUBS = "course_lib/ros/standin/*/*/__init__.pyi"


class StubsHook(BuildHookInterface[Any]):
    """Write the stubs before a wheel is built or an editable install is made."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Write the stubs into the source tree and add them to the wheel, as git ignores them."""
        sys.path.insert(0, self.root)
        from course_lib.ros.messages.stubs import write_stubs

        write_stubs(Path(self.root, "course_lib", "ros", "standin"))
        build_data["artifacts"].append(STUBS)
