"""Launch files in YAML; the kit's stand-in."""

from launch_yaml import launch_description_sources as launch_description_sources
