"""Sources of descriptions: Python files."""

from pathlib import Path
from typing import Any

from launch.entities import LaunchContext, LaunchDescription, SomeSubstitutionsType, text_of


class InvalidPythonLaunchFileError(Exception):
    """A file does not describe a launch."""


class LaunchDescriptionSource:
    """A launch file."""

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        self._path = launch_file_path

    def location(self, context: LaunchContext) -> Path:
        """Return the path of the file."""
        return Path(text_of(context, self._path)).absolute()

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """Run the file and return its description."""
        file = self.location(context)
        if file.suffix != ".py":
            raise InvalidPythonLaunchFileError(
                f"{file} is not a Python file; other launch files do not run here."
            )
        names: dict[str, Any] = {"__name__": file.stem, "__file__": str(file)}
        exec(compile(file.read_bytes(), str(file), "exec"), names)
        if "generate_launch_description" not in names:
            raise InvalidPythonLaunchFileError(
                f"launch file at '{file}' does not contain the required function "
                "'generate_launch_description()'"
            )
        description = names["generate_launch_description"]()
        if not isinstance(description, LaunchDescription):
            raise InvalidPythonLaunchFileError(
                f"generate_launch_description() in '{file}' returned {description!r}; end it with: return "
                "LaunchDescription([...])"
            )
        return description


PythonLaunchDescriptionSource = AnyLaunchDescriptionSource = LaunchDescriptionSource
