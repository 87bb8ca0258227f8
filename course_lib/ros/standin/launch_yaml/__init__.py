"""Stand-in for launch_yaml, launch files in YAML."""

from launch_yaml import launch_description_sources as launch_description_sources
