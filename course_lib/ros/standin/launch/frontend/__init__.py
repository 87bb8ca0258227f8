"""XML and YAML launch files."""

from launch.frontend.element import InvalidFrontendLaunchFileError as InvalidFrontendLaunchFileError
from launch.frontend.element import description_of as description_of
from launch.frontend.element import parse_substitution as parse_substitution
