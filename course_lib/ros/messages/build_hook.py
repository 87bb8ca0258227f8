"""Hatchling's build hook, which writes the stubs of the message packages and the table of types."""

import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

STUBS = "course_lib/ros/standin/*/*/__init__.pyi"
TABLE = "course_lib/ros/messages/known_types.json"


class StubsHook(BuildHookInterface[Any]):
    """Writes the stubs and the table before a wheel or an editable install is built."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Write the files into the source tree; add them to the wheel, because git ignores them."""
        sys.path.insert(0, self.root)
        from course_lib.ros.messages.stubs import write_stubs, write_table

        write_table()
        write_stubs(Path(self.root, "course_lib", "ros", "standin"))
        build_data["artifacts"] += [STUBS, TABLE]
