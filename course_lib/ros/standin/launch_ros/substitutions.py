"""Texts about packages."""

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch.launch_context import LaunchContext
from launch.substitution import SomeSubstitutionsType, Substitution, perform_substitutions


class FindPackagePrefix(Substitution):
    """What a package is installed under."""

    def __init__(self, package: SomeSubstitutionsType) -> None:
        self.package = package

    def perform(self, context: LaunchContext) -> str:
        """Find it; raises PackageNotFoundError."""
        return self.find(perform_substitutions(context, self.package))

    def find(self, package_name: str) -> str:
        """Find it at once."""
        return get_package_prefix(package_name)


class FindPackageShare(FindPackagePrefix):
    """The folder with a package's launch/, config/ and rviz/."""

    def find(self, package_name: str) -> str:
        """Find it at once."""
        return get_package_share_directory(package_name)
