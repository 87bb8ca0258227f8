"""Helpers that launch files import."""

from launch.substitution import perform_substitutions as perform_substitutions
