"""The PointCloud2 display."""

from typing import Any

from course_lib.displays.clouds.cloud import Cloud, channels_of, has_positions, size_problem
from course_lib.displays.clouds.display import CLOUD_PROPERTIES, CloudDisplay


class PointCloud2Display(CloudDisplay):
    """Shows clouds of any layout at once: there is no waiting for transforms."""

    class_name = "rviz_default_plugins/PointCloud2"
    type_name = "sensor_msgs/msg/PointCloud2"
    properties = (*CloudDisplay.properties, *CLOUD_PROPERTIES)

    def process(self, message: Any) -> None:
        """Show a cloud; one without x, y and z is passed over in silence, as RViz does, but for a hint."""
        silent = [] if has_positions(message) else ["the cloud has no fields x, y and z: RViz draws nothing."]
        self.statuses.hint("Fields", *silent)
        if silent:
            return
        problem = size_problem(message)
        if problem:
            self.statuses.set("error", "Message", problem)
            return
        transform = self.transform_at(message.header)
        if transform is not None:
            channels, wrong = channels_of(message)
            self.statuses.hint("Fields", *wrong)
            self.keep(Cloud(channels, transform, self.context.now_ns))
