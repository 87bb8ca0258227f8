"""Substitutions about packages and parameters."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch.entities import LaunchContext, SomeSubstitutionsType, Substitution, SubstitutionFailure, text_of

from course_lib.ros.packages import find_package
from launch_ros.settings import PARAMETERS


class FindPackagePrefix(Substitution):
    """The folder that a package is installed under; raises PackageNotFoundError."""

    def __init__(self, package: SomeSubstitutionsType) -> None:
        super().__init__(lambda context: self.find(text_of(context, package)))

    def find(self, package_name: str) -> str:
        """Return it now."""
        return get_package_prefix(package_name)


class FindPackageShare(FindPackagePrefix):
    """The folder with a package's launch/, config/ and rviz/; raises PackageNotFoundError."""

    def find(self, package_name: str) -> str:
        """Return it now."""
        return get_package_share_directory(package_name)


class ExecutableInPackage(FindPackagePrefix):
    """The path that an executable of a package has, once it is installed."""

    def __init__(self, executable: SomeSubstitutionsType, package: SomeSubstitutionsType) -> None:
        super().__init__(package)
        self._executable, self._package = executable, package

    def perform(self, context: LaunchContext) -> str:
        """Return the path; raises SubstitutionFailure for an executable that the package has not."""
        prefix = super().perform(context)
        name, package = text_of(context, self._executable), text_of(context, self._package)
        found = find_package(package)
        if found is None or name not in found.executables:
            raise SubstitutionFailure(f"executable '{name}' not found on the libexec directory of '{prefix}'")
        return str(Path(prefix) / "lib" / package / name)


class Parameter(Substitution):
    """The value of a parameter that SetParameter has set for all nodes, or a default."""

    def __init__(self, name: SomeSubstitutionsType, *, default: Any = None) -> None:
        def make(context: LaunchContext) -> str:
            wanted = text_of(context, name)
            for entry in context.launch_configurations.get(PARAMETERS, ()):
                if isinstance(entry, Mapping) and wanted in entry:
                    return str(entry[wanted])
            if default is None:
                raise SubstitutionFailure(f"parameter '{wanted}' not found")
            return text_of(context, default if isinstance(default, list | Substitution) else str(default))

        super().__init__(make)
