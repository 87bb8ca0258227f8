"""Sources of launch descriptions: Python, XML and YAML files."""

import inspect
from collections.abc import Callable
from difflib import get_close_matches
from pathlib import Path
from types import ModuleType
from typing import ClassVar, cast

from course_lib.ros.programs.packages import LAUNCH_IN_WORDS
from course_lib.ros.syntax_hints import syntax_hint
from course_lib.ros.tracebacks import format_location
from course_lib.third_party import compile_python, read_bytes
from launch.entities import (
    InvalidLaunchFileError,
    LaunchContext,
    LaunchDescription,
    LaunchDescriptionEntity,
    SomeSubstitutionsType,
    Substitution,
    text_of,
)
from launch.frontend.grammar import InvalidFrontendLaunchFileError as InvalidFrontendLaunchFileError
from launch.frontend.grammar import description_of


class InvalidPythonLaunchFileError(InvalidLaunchFileError):
    """A Python file is not a valid launch file."""


def load_python_launch_file_as_module(python_launch_file_path: str | Path) -> ModuleType:
    """Execute a Python file and return its namespace as a module."""
    file = Path(python_launch_file_path)
    module = ModuleType(file.stem)
    module.__file__ = str(file)
    try:
        code = compile_python(read_bytes(file), str(file))
    except SyntaxError as error:
        place = format_location(str(file), error.lineno or 1)
        found = syntax_hint(error)
        text = f"SyntaxError: {error.msg} ({place})"
        raise InvalidPythonLaunchFileError(f"{text}; {found}" if found else text) from error
    exec(code, vars(module))
    return module


def get_launch_description_from_python_launch_file(
    python_launch_file_path: str | Path,
) -> LaunchDescription:
    """Execute a Python file and return its launch description."""
    file = Path(python_launch_file_path)
    if file.suffix in LAUNCH_IN_WORDS:
        raise InvalidPythonLaunchFileError(
            f"{file} is not a Python file. Include it with AnyLaunchDescriptionSource."
        )
    names = vars(load_python_launch_file_as_module(file))
    if "generate_launch_description" not in names:
        near = get_close_matches("generate_launch_description", names, 1, cutoff=0.8)
        renaming = f". Rename {near[0]}: launch calls generate_launch_description" if near else ""
        if "generate_test_description" in names:
            renaming = (
                ". It is a test for launch_testing, which this kit does not have. "
                "Run the launch file that it starts; on a computer with ROS 2: launch_test FILE"
            )
        raise InvalidPythonLaunchFileError(
            f"launch file at '{file}' does not contain the required function "
            f"'generate_launch_description()'{renaming}"
        )
    generate = names["generate_launch_description"]
    try:
        inspect.signature(generate).bind()
    except (TypeError, ValueError) as error:
        raise InvalidPythonLaunchFileError(
            f"generate_launch_description in '{file}' is called without arguments: {error}. Write: "
            "def generate_launch_description():"
        ) from None
    description = generate()
    # As in ROS, any entity is accepted.
    if not isinstance(description, LaunchDescriptionEntity):
        is_plain = description is None or isinstance(description, str | int | float)
        returned = repr(description) if is_plain else f"a {type(description).__name__}"
        remedy = "end it with: return LaunchDescription([...])"
        code = getattr(generate, "__code__", None)
        if description is None and code is not None and "add_action" in code.co_names:
            remedy = "end it with a return of the LaunchDescription; add_action() itself returns None"
        raise InvalidPythonLaunchFileError(
            f"generate_launch_description() in '{file}' returned {returned}; {remedy}"
        )
    return cast("LaunchDescription", description)


def get_launch_description_from_frontend_launch_file(
    frontend_launch_file_path: str | Path,
) -> LaunchDescription:
    """Read an XML or YAML file and return its launch description."""
    return description_of(Path(frontend_launch_file_path))


def get_launch_description_from_any_launch_file(launch_file_path: str | Path) -> LaunchDescription:
    """Return the description of a file.

    A file without a suffix of XML or YAML is executed as Python.
    """
    if Path(launch_file_path).suffix in LAUNCH_IN_WORDS:
        return description_of(Path(launch_file_path))
    return get_launch_description_from_python_launch_file(launch_file_path)


class LaunchDescriptionSource:
    """A launch description, or the location of its file.

    `location` is a path after `get_launch_description` was called.
    """

    def __init__(
        self,
        launch_description: LaunchDescription | None = None,
        location: SomeSubstitutionsType = "<string>",
        method: str = "unspecified mechanism from a script",
    ) -> None:
        self._description, self._parts, self.method = launch_description, location, method
        parts = [location] if isinstance(location, str | Path | Substitution) else location
        self.location = " + ".join(map(str, parts))

    def expand_location(self, context: LaunchContext) -> str:
        """Return the location as an absolute path, or unchanged if it has a description."""
        location = text_of(context, self._parts)
        self.location = location if self._description else str(Path(location).absolute())
        return self.location

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """Return the launch description."""
        if self._description is None:
            raise RuntimeError(
                "LaunchDescriptionSource.get_launch_description(): "
                "called without launch description being set"
            )
        return self._description


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in Python, XML or YAML."""

    read: ClassVar[Callable[[str], LaunchDescription]] = get_launch_description_from_any_launch_file

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(None, launch_file_path, "interpreted launch file")

    def get_launch_description(self, context: LaunchContext) -> LaunchDescription:
        """Return the launch description of the file."""
        return type(self).read(self.expand_location(context))


class PythonLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """A launch file in Python."""

    read = get_launch_description_from_python_launch_file

    def __init__(self, launch_file_path: SomeSubstitutionsType) -> None:
        super().__init__(launch_file_path)
        self.method = "interpreted python launch file"


class FrontendLaunchDescriptionSource(AnyLaunchDescriptionSource):
    """A launch file in XML or YAML."""

    read = get_launch_description_from_frontend_launch_file

    def __init__(
        self, launch_file_path: SomeSubstitutionsType, *, method: str = "interpreted frontend launch file"
    ) -> None:
        super().__init__(launch_file_path)
        self.method = method
