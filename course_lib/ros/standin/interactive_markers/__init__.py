"""Markers that are dragged and clicked: the server that owns them, and their menus."""

from interactive_markers.interactive_marker_server import InteractiveMarkerServer as InteractiveMarkerServer
from interactive_markers.menu_handler import MenuHandler as MenuHandler
