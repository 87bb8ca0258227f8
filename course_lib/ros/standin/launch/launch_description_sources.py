"""Sources of descriptions: Python, XML and YAML files."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from course_lib.ros.packages import LAUNCH_IN_WORDS
from launch.entities import (
    InvalidLaunchFileError,
    LaunchContext,
    LaunchDescription,
    SomeSubstitutionsType,
    text_of,
)
from launch.frontend.element import InvalidFrontendLaunchFileError as InvalidFrontendLaunchFileError
from launch.frontend.element import description_of


class InvalidPythonLaunchFileError(InvalidLaunchFileError):
    """A Python file does not describe a launch."""


def get_launch_description_from_python_launch_file(launch_file_path: str | Path) -> LaunchDescription:
    """Run a Python file and return its description."""
    file = Path(launch_file_path)
    if file.suffix in LAUNCH_IN_WORDS:
        raise InvalidPythonLaunchFileError(
            f"{file} is not a Python file. Include it with AnyLaunchDescriptionSource."
        )
    names: dict[str, Any] = {"__name__": file.stem, "__file__": str(file)}
    exec(compile(file.read_bytes(), str(file), "exec"), names)
    if "generate_launch_description" not in names:
        raise InvalidPythonLaunchFileError(
            f"launch file at '{file}' does not contain the required function 'generate_launch_description()'"
        )
    description = names["generate_launch_description"]()
    if not isinstance(description, LaunchDescription):
        raise InvalidPythonLaunchFileError(
            f"generate_launch_description() in '{file}' returned {description!r}; end it with: return "
            "LaunchDescription([...])"
        )
    return description


def get_launch_description_from_frontend_launch_file(launch_file_path: str | Path) -> LaunchDescription:
    """Read an XML or YAML file and return its description."""
    return description_of(Path(launch_file_path))


def get_launch_description_from_any_launch_file(launch_file_path: str | Path) -> LaunchDescription:
    """Return the description of a file by its suffix; without one of these it is a Python file."""
    in_words = Path(launch_file_path).suffix in LAUNCH_IN_WORDS
    return (description_of if in_words else get_launch_description_from_python_launch_file)(
        Path(launch_file_path)
    )


class LaunchDescriptionSource:
    """A launch file of any kind."""

    read: ClassVar[Callable[[Path], LaunchDescription]] = get_launch_description_from_any_launch_file

    def __init__(self, launch_file_path: SomeSubstitutionsType, **options: Any) -> None:
        self._path = launch_file_path

    def location(self, context: LaunchContext) -> Path:
        """Return the path of the file."""
        return Path(text_of(context, self._path)).absolute()

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """Return the description of the file."""
        return type(self).read(self.location(context))


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in Python, XML or YAML."""


class PythonLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in Python."""

    read = get_launch_description_from_python_launch_file


class FrontendLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in XML or YAML."""

    read = get_launch_description_from_frontend_launch_file
