"""Stand-in for launch_xml, launch files in XML."""

from launch_xml import launch_description_sources as launch_description_sources
