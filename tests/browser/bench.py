"""A viewer in a page without Jupyter, with a graph that publishes to it."""

from typing import Any, Literal

from playwright.sync_api import Locator

from course_lib.displays.viewer import Viewer
from course_lib.ros.graph.graph import Graph, Sample
from course_lib.ros.messages import deserialize
from course_lib.viewer.widget import SceneWidget
from tests.browser.fake_host import Host
from tests.displays.bench import marker
from tests.displays.stage import publish


class Bench:
    """A viewer in a page, with its graph."""

    def __init__(self, host: Host, graph: Graph) -> None:
        self.host, self.page, self.graph = host, host.page, graph
        self.viewer = Viewer()
        self.viewer.add("Marker", topic="/m")
        publish(graph, "/m", marker())
        self.viewer._repr_mimebundle_()
        self.widget: SceneWidget = self.viewer._cell._view  # type: ignore[assignment]  # it was just shown
        host.open(self.widget)
        host.show(self.widget, 780)
        self.heard: list[Sample] = []
        graph.tap(self.heard.append)

    def row(self, label: str) -> Locator:
        return self.page.get_by_role("row").filter(has=self.page.get_by_text(label, exact=True))

    def press(self, name: str) -> None:
        self.page.get_by_role("button", name=name, exact=True).click()
        self.host.carry()

    def open(self, *labels: str) -> None:
        self.press("Displays panel")
        for label in labels:
            self.row(label).press("ArrowRight")

    def choose(self, label: str) -> None:
        """Select an option in the open window."""
        self.page.get_by_role("dialog").get_by_role("listbox").select_option(label=label)
        self.page.get_by_role("dialog").locator("button[type=submit]").click()
        self.host.carry()

    def drag(self, *points: tuple[int, int], button: Literal["left", "right"] = "left") -> None:
        """Drag from the middle of the view by `right`, `down` pixels."""
        box = self.page.locator("canvas").bounding_box()
        assert box is not None
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.page.mouse.move(x + points[0][0], y + points[0][1])
        self.page.mouse.down(button=button)
        for dx, dy in points[1:]:
            self.page.mouse.move(x + dx, y + dy)
        self.page.mouse.up(button=button)
        self.host.carry()

    def hover(self, to: tuple[int, int]) -> None:
        """Move the pointer to a point `right`, `up` pixels from the middle of the view."""
        box = self.page.locator("canvas").bounding_box()
        assert box is not None
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.page.mouse.move(x + to[0], y + to[1])
        self.host.carry()

    def message(self, topic: str, kind: Any) -> Any:
        (sample,) = (sample for sample in self.heard if sample.topic == topic)
        return deserialize(sample.cdr, kind)
