"""Interactive markers, which users drag and click: their server and their menus."""

from interactive_markers.interactive_marker_server import InteractiveMarkerServer as InteractiveMarkerServer
from interactive_markers.menu_handler import MenuHandler as MenuHandler
