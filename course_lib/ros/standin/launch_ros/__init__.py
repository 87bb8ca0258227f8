"""Nodes in launch files; the kit's stand-in."""
