"""Substitutions about packages and parameters."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch.entities import LaunchContext, SomeSubstitutionsType, Substitution, SubstitutionFailure, text_of

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
    """The path of an executable of a package; raises SubstitutionFailure where it has no file."""

    def __init__(self, executable: SomeSubstitutionsType, package: SomeSubstitutionsType) -> None:
        super().__init__(package)
        self._executable = executable

    def perform(self, context: LaunchContext) -> str:
        """Return the path."""
        prefix, name = super().perform(context), text_of(context, self._executable)
        found = next((path for path in sorted(Path(prefix).glob(f"lib/*/{name}")) if path.is_file()), None)
        if found is None:
            raise SubstitutionFailure(f"executable '{name}' not found on the libexec directory of '{prefix}'")
        return str(found)


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
