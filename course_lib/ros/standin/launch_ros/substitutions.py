"""Substitutions for packages and parameters."""

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import Any

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch.entities import LaunchContext, SomeSubstitutionsType, Substitution, SubstitutionFailure, text_of

from course_lib.ros.programs.packages import INSTALLED, find_package
from launch_ros.actions import PARAMETERS


class FindPackagePrefix(Substitution):
    """The installation prefix of a package.

    Raises PackageNotFoundError if there is no such package.
    """

    def __init__(self, package: SomeSubstitutionsType) -> None:
        super().__init__(lambda context: self.find(text_of(context, package)))

    def find(self, package_name: str) -> str:
        """Return the prefix."""
        return get_package_prefix(package_name)


class FindPackageShare(FindPackagePrefix):
    """The folder with a package's launch/, config/ and rviz/. Raises PackageNotFoundError."""

    def find(self, package_name: str) -> str:
        """Return the folder."""
        return get_package_share_directory(package_name)


class ExecutableInPackage(FindPackagePrefix):
    """The path of an executable of a package after its installation."""

    def __init__(self, executable: SomeSubstitutionsType, package: SomeSubstitutionsType) -> None:
        super().__init__(package)
        self._executable, self._package = executable, package

    def perform(self, context: LaunchContext) -> str:
        """Return the path. Raise SubstitutionFailure if the package has no such executable."""
        name, package = text_of(context, self._executable), text_of(context, self._package)
        if context.runner is not None and context.runner.has_executable(package, name):
            return str(INSTALLED.parent / "lib" / package / name)
        prefix = super().perform(context)
        package_found = find_package(package)
        if package_found is None or name not in package_found.executables:
            raise SubstitutionFailure(f"executable '{name}' not found on the libexec directory of '{prefix}'")
        return str(Path(prefix) / "lib" / package / name)


@dataclass(eq=False, repr=False)
class Parameter(Substitution):
    """The value of a parameter that SetParameter has set, or a default."""

    name: SomeSubstitutionsType
    _: KW_ONLY
    default: Any = None

    def perform(self, context: LaunchContext) -> str:
        """Return the value of the parameter, or the default."""
        parameter_name = text_of(context, self.name)
        for entry in context.launch_configurations.get(PARAMETERS, ()):
            if isinstance(entry, Mapping) and parameter_name in entry:
                return str(entry[parameter_name])
        if self.default is None:
            raise SubstitutionFailure(f"parameter '{parameter_name}' not found")
        return text_of(
            context, self.default if isinstance(self.default, list | Substitution) else str(self.default)
        )
