"""The Marker and MarkerArray displays."""

from typing import Any

from course_lib.displays.display import Interest
from course_lib.displays.marker.store import MarkerStore
from course_lib.displays.properties import Property, booleans
from course_lib.displays.statuses import StatusRow
from course_lib.displays.topic_display import FilteredDisplay, TopicDisplay, topic_properties

MARKER, MARKER_ARRAY = "visualization_msgs/msg/Marker", "visualization_msgs/msg/MarkerArray"
_NAMESPACES = Property("Namespaces", {}, booleans)


def _namespace(label: str) -> str | None:
    """Return the namespace that a label like ``Namespaces/labels`` is of, or None."""
    above, slash, name = label.partition("/")
    return name if slash and above.lower() == "namespaces" else None


class _Markers(TopicDisplay):
    """Base of the Marker and MarkerArray displays."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.markers = MarkerStore(self.context, self.path, self.statuses)

    def __getitem__(self, label: str) -> Any:
        name = _namespace(label)
        return super().__getitem__(label) if name is None else self.markers.namespaces.get(name, True)

    def __setitem__(self, label: str, value: Any) -> None:
        name = _namespace(label)
        super().__setitem__(*((label, value) if name is None else ("Namespaces", {name: value})))

    def changed(self, label: str) -> None:
        """Show or hide namespaces; other properties as usual."""
        super().changed(label)
        if label == "Namespaces":
            self.markers.tick(self["Namespaces"])

    def update(self) -> None:
        """Show what has come, remove what has expired, move what is locked to its frame."""
        super().update()
        self.markers.update()
        self._values["Namespaces"] = dict(self.markers.namespaces)

    def message_at(self, path: str) -> Any:
        """Return the marker that an object was drawn from."""
        live = self.markers.live.values()
        return next((one.marker for one in live if f"{path}/".startswith(f"{one.path}/")), None)

    def rows(self) -> list[StatusRow]:
        """List the statuses, and what has moved away from its markers."""
        behind = self.markers.behind() if self.enabled else ()
        return super().rows() + [StatusRow(self.name, name, "hint", text) for name, text in behind]

    def reset(self) -> None:
        """Forget all markers."""
        super().reset()
        self.markers.clear()


class MarkerDisplay(_Markers, FilteredDisplay):
    """Markers, each drawn when tf2 knows its frame; arrays on ``<topic>_array`` are drawn immediately."""

    class_name = "rviz_default_plugins/Marker"
    type_name = MARKER
    properties = (*FilteredDisplay.properties, _NAMESPACES)

    def wanted(self) -> tuple[Interest, ...]:
        """Listen to the topic, and to arrays beside it."""
        self.statuses.set("ok", "Array Topic", "OK")
        array = self.interest(self["Topic"] + "_array", MARKER_ARRAY, self.markers.add_array)
        return (*super().wanted(), array)

    def process(self, message: Any) -> None:
        """Show a marker."""
        self.markers.add([message])


class MarkerArrayDisplay(_Markers):
    """Arrays of markers, without a wait: a marker that tf2 cannot place yet is an error."""

    class_name = "rviz_default_plugins/MarkerArray"
    type_name = MARKER_ARRAY
    properties = (*topic_properties("visualization_marker_array"), _NAMESPACES)

    def process(self, message: Any) -> None:
        """Show an array."""
        self.markers.add_array(message)
