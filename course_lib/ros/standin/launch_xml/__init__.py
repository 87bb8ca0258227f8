"""Launch files in XML; the kit's stand-in."""

from launch_xml import launch_description_sources as launch_description_sources
