"""RViz in a cell: what lessons import."""

import weakref
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from course_lib.displays.backlog import Backlog
from course_lib.displays.display import Display, node_name
from course_lib.displays.frames import NS
from course_lib.displays.layout import Options, read_layout
from course_lib.displays.node import RvizNode
from course_lib.displays.panel.cell import ViewerCell, end_all
from course_lib.displays.panel.tools import Tool
from course_lib.displays.registry import REGISTRY, known_name, short_name
from course_lib.displays.session import RvizSession
from course_lib.displays.statuses import StatusTable
from course_lib.displays.views import ViewController
from course_lib.displays.writer import save_rviz
from course_lib.errors import CourseError
from course_lib.ros.graph import current_graph
from course_lib.surroundings import announce
from course_lib.viewer.camera import Camera
from course_lib.viewer.film import Film
from course_lib.viewer.html import save_html
from course_lib.viewer.page_link import Click
from course_lib.viewer.picture import Picture, screenshot
from course_lib.viewer.scene import Scene

if TYPE_CHECKING:
    from course_lib.displays.panel.resting_view import RestingView
    from course_lib.displays.robot_model.still import Configuration
    from course_lib.robots.robot import Robot
    from course_lib.viewer.visualizer import Visualizer


class Viewer:
    """RViz in a notebook: listens to the running graph, shows displays and their statuses.

    Put it on the last line of a cell to see it; several cells may show the same viewer.

    Args:
        fixed_frame: RViz's Fixed Frame: where everything is placed.
        use_sim_time: RViz's parameter: whether its time is that on the topic /clock.
    """

    is_seen = True  # False where no page can show a viewer: when graded

    def __init__(self, fixed_frame: str = "map", *, use_sim_time: bool = False) -> None:
        self._graph = graph = current_graph()
        scene, matching = Scene(), not graph.keeps_wall_time
        session = RvizSession(scene, fixed_frame, graph.now_ns, matching, use_sim_time)
        session.context.is_seen, session.latched = self.is_seen, graph.latched
        session.context.node = node = RvizNode(graph, session.time)
        self._session, backlog = session, Backlog(session, graph)
        self.film = Film(scene, lambda: backlog.now_ns / NS)
        self._cell = ViewerCell(session, graph)
        stops = (graph.tap(backlog.receive, session.topics), graph.watch_time(backlog.tick), node.close)
        self._end = weakref.finalize(self, end_all, stops, self._cell)  # once no name or page holds it
        self._end.atexit = False
        session.catch_up(session.interests)
        self.add("Grid")

    @property
    def session(self) -> RvizSession:
        """Its displays without the window, after all messages so far."""
        self._session.context.settle()
        return self._session

    @property
    def scene(self) -> Scene:
        """The scene, drawn if it was not yet."""
        self.session.context.show()
        return self.session.context.scene

    @classmethod
    def from_rviz(cls, path: str | Path, *, use_sim_time: bool = False) -> Self:
        """Create a viewer with the displays, options and view of an .rviz file.

        Raises:
            CourseError: If it is not an .rviz file; with line and column.
        """
        layout, viewer = read_layout(path), cls(use_sim_time=use_sim_time)
        viewer.session.apply(layout)
        return viewer

    def save_rviz(self, path: str | Path) -> None:
        """Write displays, options and views as an .rviz file, which RViz2 opens too."""
        save_rviz(self.session, path)

    def add(
        self,
        class_name: str,
        topic: str | None = None,
        *,
        name: str | None = None,
        group: str | None = None,
        **properties: Any,
    ) -> Display:
        """Add a display, as RViz's Add button does.

        Args:
            class_name: RViz's name, ``Marker`` or ``rviz_default_plugins/Marker``.
            topic: Its Topic property, or whatever the display calls it.
            name: Its class if not given.
            group: The group that holds it, made if there is none of that name.
            properties: By RViz's labels, as Python names: ``cell_size=0.5``, or ``**{"Cell Size": 0.5}``.

        Raises:
            CourseError: If there is no such class or property, or a value does not fit.
        """
        wanted = known_name(class_name)
        if topic is not None:
            properties[getattr(REGISTRY[wanted], "topic_label", "Topic")] = topic
        holder = self.session.group(group) if group else None
        return self.session.add(wanted, name or short_name(wanted), {}, group=holder, **properties)

    def remove(self, display: Display) -> None:
        """Remove a display."""
        if display not in self.session.displays:
            raise CourseError(f"{display} is not in this viewer; it shows {self.displays}.")
        self.session.remove(display)

    @property
    def displays(self) -> list[Display]:
        """The displays, in the order of RViz's tree."""
        return list(self._session.displays)

    def __repr__(self) -> str:
        shown = ", ".join(display.name for display in self.displays) or "no display"
        return f"<Viewer of {self.fixed_frame} with {shown}>"

    def __getitem__(self, name: str) -> Display:
        """Return the first display with a name."""
        by_name = {display.name: display for display in reversed(self.displays)}
        if name not in by_name:
            raise CourseError(f"No display is called {name!r}; there is {', '.join(by_name) or 'none'}.")
        return by_name[name]

    @property
    def fixed_frame(self) -> str:
        """RViz's Fixed Frame; another one restarts all displays."""
        return self._session.fixed_frame

    @fixed_frame.setter
    def fixed_frame(self, frame: str) -> None:
        self.session.fixed_frame = frame

    @property
    def use_sim_time(self) -> bool:
        """RViz's parameter: whether its time is that on the topic /clock; a change resets all displays."""
        return self.session.time.use_sim_time

    @use_sim_time.setter
    def use_sim_time(self, use_sim_time: bool) -> None:
        self.session.follow_clock(use_sim_time)

    @property
    def options(self) -> Options:
        """RViz's Global Options: ``viewer.options["Background Color"] = "#ffffff"``."""
        return self.session.options

    def tool(self, label: str) -> Tool:
        """Return a tool by the label of its button: ``viewer.tool("2D Goal Pose")["Topic"] = "/goal"``."""
        tools = {tool.label: tool for tool in self.session.tools}
        if label not in tools:
            raise CourseError(f"No tool is called {label!r}; there is {', '.join(tools)}.")
        return tools[label]

    @property
    def view(self) -> ViewController:
        """The view controller: ``viewer.view = Orbit(distance=6.0)``, ``viewer.view["Yaw"] = 0.8``."""
        return self.session.view

    @view.setter
    def view(self, view: ViewController) -> None:
        if not isinstance(view, ViewController):
            raise CourseError(f"{view!r} is not a view; write one like viewer.view = Orbit().")
        self.session.view = view

    @property
    def camera(self) -> Camera:
        """The camera that results from the view."""
        self.look()
        return self.scene.camera

    @property
    def meshcat(self) -> "Visualizer":
        """The scene, for meshcat code: ``viewer.meshcat["box"].set_object(Box([1, 1, 1]))``."""
        from course_lib.viewer.visualizer import Visualizer  # here: heavy

        return Visualizer(self.scene)

    def statuses(self) -> StatusTable:
        """Return the statuses of RViz's Displays panel, and hints where RViz is silent."""
        self.session.update(self._graph.now_ns)  # which draws nothing where nobody can look
        return StatusTable(self.session.rows())

    def show_robot(self, robot: "Robot", configuration: "Configuration" = None) -> None:
        """Draw a robot's links in the fixed frame, without any messages.

        Args:
            robot: What `load_robot` returns.
            configuration: Joint positions by name, as `link_poses` takes them, or Pinocchio's vector, shape
                (nq,); None takes the rest posture.
        """
        from course_lib.displays.robot_model.still import draw_still  # here: heavy

        draw_still(self.scene, f"robots/{node_name(robot.name)}", robot, configuration)

    def save_html(self, path: str | Path, playback: bool = False) -> None:
        """Write the scene as one page that opens without a network.

        Args:
            path: The page's file.
            playback: Whether the page plays what was seen so far; it says so if that is not all.
        """
        self.look()
        save_html(self.film if playback else self.scene, path, title=f"Viewer: {self.fixed_frame}")

    def screenshot(self, path: str | Path | None = None, size: tuple[int, int] = (800, 600)) -> Picture:
        """Draw the scene into a PNG of a size in [px]; the result names its renderer.

        That is a page that shows the viewer, else Chromium or Chrome, else numpy.
        """
        self.look()
        png = self._cell.picture(size)
        if png is None:
            return screenshot(self.scene, path, size)
        picture = Picture(png, "page")
        if path is not None:
            picture.save(path)
        return picture

    def beside(self) -> None:
        """Show the viewer in a panel beside the notebook, where JupyterLab has one, else in the cell."""
        self._cell.dock(self)

    def freeze(self, seconds: float = 5.0) -> "RestingView":
        """Return the view as it is now, for the last line of a cell: later messages do not change it.

        Args:
            seconds: How much of what was seen before its bar can play, [s] of robot time.
        """
        self.look()
        return self._cell.at_rest(self.film, seconds)

    def open(self, *, browser: bool = True, port: int = 0, token: str | None = None) -> str:
        """Show the viewer in a browser's tab; it ends with the program.

        Args:
            browser: Whether to open the page, besides printing its address.
            port: Where to listen, on this machine only; 0 lets the system choose a free one.
            token: The secret part of the address; None makes one up.

        Returns:
            The address; on a JupyterHub that of its proxy.

        Raises:
            CourseError: The port is taken, or the hub has no jupyter-server-proxy.
        """
        self.look()
        url = self._cell.opened(port, token)
        announce("The viewer", url, browser=browser)
        return url

    def summary(self) -> str:
        """Describe in words the objects drawn, their places in the fixed frame, and the statuses."""
        self.look()
        return self.session.summary()

    def on_click(self, callback: Callable[[Click], None]) -> Callable[[Click], None]:
        """Register a callback for every click into the view: ``@viewer.on_click`` above it."""
        self._cell.on_click.append(callback)
        return callback

    async def pick(self) -> Click:
        """Wait for the next click into the view: ``click = await viewer.pick()``.

        Raises:
            CourseError: At once, if no page shows the viewer.
        """
        return await self._cell.next_click()

    def look(self) -> None:
        """Bring the scene up to date, as robot time stands."""
        self.session.context.show()
        self.session.update(self._graph.now_ns)

    def close(self) -> None:
        """Stop listening, and take the viewer out of all cells."""
        self._end()

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        self.look()
        return self._cell.shown(self, **kwargs)
