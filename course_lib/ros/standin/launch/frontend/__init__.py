"""XML and YAML launch files."""

from launch.frontend.grammar import InvalidFrontendLaunchFileError as InvalidFrontendLaunchFileError
from launch.frontend.grammar import description_of as description_of
from launch.frontend.grammar import expose_substitution as expose_substitution
from launch.frontend.grammar import parse_substitution as parse_substitution
