"""Substitutions about packages."""

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch.entities import SomeSubstitutionsType, Substitution, text_of


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
