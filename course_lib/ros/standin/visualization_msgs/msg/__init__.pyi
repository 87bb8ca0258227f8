# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from ._image_marker import ImageMarker as ImageMarker
from ._interactive_marker import InteractiveMarker as InteractiveMarker
from ._interactive_marker_control import InteractiveMarkerControl as InteractiveMarkerControl
from ._interactive_marker_feedback import InteractiveMarkerFeedback as InteractiveMarkerFeedback
from ._interactive_marker_init import InteractiveMarkerInit as InteractiveMarkerInit
from ._interactive_marker_pose import InteractiveMarkerPose as InteractiveMarkerPose
from ._interactive_marker_update import InteractiveMarkerUpdate as InteractiveMarkerUpdate
from ._marker import Marker as Marker
from ._marker_array import MarkerArray as MarkerArray
from ._menu_entry import MenuEntry as MenuEntry
from ._mesh_file import MeshFile as MeshFile
from ._uv_coordinate import UVCoordinate as UVCoordinate
