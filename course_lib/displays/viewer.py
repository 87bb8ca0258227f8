"""RViz in a notebook cell: the viewer that lessons import."""

import weakref
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeAlias

from course_lib.displays.display import Display, RvizNode, node_name
from course_lib.displays.frames import NS, frame_name
from course_lib.displays.layout import Options, read_layout
from course_lib.displays.panel.cell import ViewerCell, close_viewer
from course_lib.displays.panel.tools import Tool
from course_lib.displays.properties import KnownAttributes
from course_lib.displays.registry import REGISTRY, known_name, short_name
from course_lib.displays.session import Backlog, RvizSession
from course_lib.displays.statuses import StatusTable
from course_lib.displays.views import ViewController
from course_lib.displays.writer import save_rviz
from course_lib.errors import CourseError
from course_lib.host import announce, in_notebook, running_cell
from course_lib.ros.graph.graph import ProgramNodes, current_graph
from course_lib.ros.notices import print_notice
from course_lib.viewer.drawables import Camera
from course_lib.viewer.html import save_html
from course_lib.viewer.page_link import Click
from course_lib.viewer.renderer import Picture, screenshot
from course_lib.viewer.scene import Scene
from course_lib.viewer.scene_recording import SceneRecording

if TYPE_CHECKING:
    from course_lib.displays.panel.resting_view import RestingView
    from course_lib.displays.robot_model import Configuration
    from course_lib.robots.robot import Robot
    from course_lib.viewer.visualizer import Visualizer

# Id of a cell, and the class, name and topic of a display that it adds.
Source: TypeAlias = tuple[str | None, str, str, str | None]


class Viewer(KnownAttributes):
    """RViz in a notebook: subscribes to the running graph, and shows displays and their statuses.

    Put it on the last line of a cell to display it; several cells may show the same viewer. As long
    as nobody sets the view, it shows what is drawn.

    Args:
        fixed_frame: RViz's Fixed Frame, in which everything is placed.
        use_sim_time: RViz's parameter: whether its time is the time on the topic /clock.
    """

    # This is False during grading, when no page can show a viewer.
    is_seen = True

    def __init__(self, fixed_frame: str = "map", *, use_sim_time: bool = False) -> None:
        self._graph = graph = current_graph()
        scene, match_qos = Scene(), graph.is_qos_enforced
        session = RvizSession(scene, fixed_frame, graph.now_ns, match_qos, use_sim_time)
        session.context.is_seen, session.latched_samples = self.is_seen, graph.latched_samples
        session.context.node = node = RvizNode(graph, session.time)
        self._session, backlog = session, Backlog(session, graph)
        # By display: what added it, and the id of that run of the cell.
        self._sources: weakref.WeakKeyDictionary[Display, tuple[Source, str | None]]
        self._sources = weakref.WeakKeyDictionary()
        self.scene_recording = SceneRecording(scene, lambda: backlog.now_ns / NS)
        self.scene_recording.steady_camera = session.default_camera
        self._cell = ViewerCell(session, graph)
        stops = (graph.tap(backlog.receive, session.topics), graph.watch_time(backlog.tick), node.close)
        # Runs once no variable or page refers to the viewer.
        self._end = weakref.finalize(self, close_viewer, stops, self._cell)
        self._end.atexit = False
        nodes = graph.state(ProgramNodes)
        session.unspun_nodes = lambda: list(nodes.unspun_nodes.values())
        session.node_errors = lambda: list(nodes.errors.values())
        session.link_error = graph.link_error
        session.published_types = lambda topic: {
            info.type_name for info in graph.endpoints_on(topic) if info.kind == "pub"
        }
        session.deliver_latched(session.subscriptions)
        self.add("Grid")

    @property
    def session(self) -> RvizSession:
        """The session, with all received messages processed."""
        self._session.context.process_backlog()
        return self._session

    @property
    def scene(self) -> Scene:
        """The scene, drawn on access if that was postponed."""
        self.session.context.show()
        return self.session.context.scene

    @classmethod
    def from_rviz(cls, path: str | Path, *, use_sim_time: bool = False) -> Self:
        """Create a viewer with the displays, options and view of an .rviz file.

        Raises:
            CourseError: It is not an .rviz file; the message has line and column.
        """
        layout, viewer = read_layout(path), cls(use_sim_time=use_sim_time)
        viewer.session.apply(layout)
        return viewer

    def save_rviz(self, path: str | Path) -> None:
        """Write displays, options and views as an .rviz file, which RViz2 can open, too.

        A notebook prints how to open it.
        """
        save_rviz(self.session, path)
        # Reports of checks show a task's output, and exercises save layouts.
        if in_notebook():
            print_notice(f"Saved {path}. The real RViz2 opens it with: rviz2 -d {path}")

    def add(
        self,
        class_name: str,
        topic: str | None = None,
        *,
        name: str | None = None,
        group: str | None = None,
        **properties: Any,
    ) -> Display:
        """Add a display, like RViz's Add button.

        If a cell runs again, its display replaces the one of the same class, name and topic that
        the cell has added before.

        Args:
            class_name: RViz's class name, ``Marker`` or ``rviz_default_plugins/Marker``.
            topic: The value of its Topic property, whatever its label.
            name: The display's name; default: its class.
            group: The group to add it to, which is created if it does not exist.
            properties: Values by RViz's labels, as Python names: ``cell_size=0.5``, or ``**{"Cell
                Size": 0.5}``.

        Raises:
            CourseError: The class or property does not exist, or a value is invalid.
        """
        full_class_name = known_name(class_name)
        if not isinstance(name, str | None):
            raise CourseError(f"name is {name!r}, expected the display's name, a string")
        if topic is not None:
            properties[getattr(REGISTRY[full_class_name], "topic_label", "Topic")] = topic
        holder = self.session.group(group) if group else None
        display_name = name or short_name(full_class_name)
        cell, run = running_cell() or (None, None)
        source = (cell, full_class_name, display_name, topic)
        if cell is not None:
            # The cell was run again: replace the display that it added with the same arguments.
            for earlier in self.displays:
                other_source, other_run = self._sources.get(earlier, (None, None))
                if other_source == source and other_run != run:
                    self.remove(earlier)
                    break
        display = self.session.add(full_class_name, display_name, {}, group=holder, **properties)
        self._sources[display] = source, run
        return display

    def remove(self, display: Display) -> None:
        """Remove a display."""
        if display not in self.session.displays:
            text = f"{display} is not in this viewer; it shows {self.displays}."
            if isinstance(display, str):
                text = f"{display!r} is a name: write viewer.remove(viewer[{display!r}])."
            raise CourseError(text)
        self.session.remove(display)

    @property
    def displays(self) -> list[Display]:
        """The displays, in the order of RViz's tree."""
        return list(self._session.displays)

    def _suggest(self, name: str) -> str:
        return super()._suggest(name) or self.options._suggest(name)

    def __repr__(self) -> str:
        names = ", ".join(display.name for display in self.displays) or "no display"
        return f"<Viewer of {self.fixed_frame} with {names}>"

    def __getitem__(self, name: str) -> Display:
        """Return the first display with a name."""
        by_name = {display.name: display for display in reversed(self.displays)}
        if name not in by_name:
            raise CourseError(
                f"No display has the name {name!r}; the displays are {', '.join(by_name) or 'none'}."
            )
        return by_name[name]

    @property
    def fixed_frame(self) -> str:
        """RViz's Fixed Frame; setting another one restarts all displays."""
        return self._session.fixed_frame

    @fixed_frame.setter
    def fixed_frame(self, frame: str) -> None:
        self.session.fixed_frame = frame

    @property
    def use_sim_time(self) -> bool:
        """RViz's parameter: whether the topic /clock is its time source; a change resets all displays."""
        return self.session.time.use_sim_time

    @use_sim_time.setter
    def use_sim_time(self, use_sim_time: bool) -> None:
        self.session.set_sim_time(use_sim_time)

    @property
    def options(self) -> Options:
        """RViz's Global Options: ``viewer.options["Background Color"] = "#ffffff"``."""
        return self.session.options

    def tool(self, label: str) -> Tool:
        """Return a tool by the label of its button: ``viewer.tool("2D Goal Pose")["Topic"] = "/goal"``."""
        tools = {tool.label: tool for tool in self.session.tools}
        if label not in tools:
            raise CourseError(f"No tool has the label {label!r}; the tools are {', '.join(tools)}.")
        return tools[label]

    @property
    def view(self) -> ViewController:
        """The view controller: ``viewer.view = Orbit(distance=6.0)``, ``viewer.view["Yaw"] = 0.8``."""
        return self.session.view

    @view.setter
    def view(self, view: ViewController) -> None:
        if not isinstance(view, ViewController):
            is_class = isinstance(view, type) and issubclass(view, ViewController)
            example = view.__name__ if is_class else "Orbit"
            names = [kind.__name__ for kind in ViewController.__subclasses__()]
            if isinstance(view, str):
                example = next((one for one in names if one.lower() == view.lower()), example)
            raise CourseError(f"{view!r} is not a view; assign one, like viewer.view = {example}().")
        self.session.view = view

    @property
    def camera(self) -> Camera:
        """The camera that results from the view."""
        self.refresh()
        return self.scene.camera

    @property
    def meshcat(self) -> "Visualizer":
        """The scene, for meshcat code: ``viewer.meshcat["box"].set_object(Box([1, 1, 1]))``."""
        # Imported here because it is slow to load.
        from course_lib.viewer.visualizer import Visualizer

        return Visualizer(self.scene)

    def statuses(self) -> StatusTable:
        """Return the statuses of RViz's Displays panel, with hints."""
        # `update` draws nothing if no page can show the viewer.
        self.session.update(self._graph.now_ns)
        return StatusTable(self.session.rows())

    def show_robot(
        self,
        robot: "Robot",
        configuration: "Configuration" = None,
        *,
        frame: str | None = None,
        at: Sequence[float] = (0.0, 0.0, 0.0),
        alpha: float = 1.0,
    ) -> None:
        """Draw a robot's links in a frame. No messages are needed except transforms.

        Args:
            robot: A robot from `load_robot`.
            configuration: Joint positions by name as for `link_poses`, or Pinocchio's vector, shape
                (nq,); None uses the rest posture.
            frame: The frame that the robot moves with, which hides it while tf2 doesn't know it;
                None is the fixed frame.
            at: Its position in that frame, [m].
            alpha: From 0.0, invisible, to 1.0, opaque. Frames and their names are visible through
                a robot with an alpha below 1.

        Raises:
            CourseError: The alpha is not between 0 and 1, or the robot cannot be drawn.
        """
        # Imported here because it is slow to load.
        from course_lib.displays.robot_model import draw_robot

        if not 0.0 <= alpha <= 1.0:
            raise CourseError(f"alpha is {alpha}, expected a number from 0.0 to 1.0")
        path = f"robots/{node_name(robot.name)}"
        draw_robot(self.scene, path, robot, configuration, alpha)
        self.session.attach(path, frame_name(frame or ""), at)

    def save_html(self, path: str | Path, playback: bool = False) -> None:
        """Write the scene as a single page that opens without a network, and print how to open it.

        Args:
            path: The path of the page.
            playback: Whether the page can play the scene's history; it states it if the history is
                incomplete.

        Raises:
            CourseError: The page cannot be written.
        """
        self.refresh()
        scene: Scene | SceneRecording = self.scene_recording if playback else self.scene
        seconds = round(self.scene_recording.duration) if playback else 0
        subject = f"{seconds} s of robot time" if seconds else "the view"
        # Saving a history of two minutes takes seconds.
        print_notice(f"Saving {subject} …")
        size = save_html(scene, path, title=f"Viewer: {self.fixed_frame}").stat().st_size
        how = "right-click it in the file browser, Open in New Browser Tab"
        how = how if in_notebook() else "any browser"
        print_notice(f"Saved {path} ({size / 1e6:.1f} MB). To open it: {how}. It works offline.")

    def screenshot(
        self,
        path: str | Path | None = None,
        size: tuple[int, int] = (800, 600),
    ) -> Picture:
        """Render the scene as a PNG with a size in [px].

        It is rendered by a page that shows the viewer, else by Chromium or Chrome, else by numpy.
        """
        self.refresh()
        png = self._cell.picture(size)
        picture = screenshot(self.scene, size=size) if png is None else Picture(png, "page")
        if path is not None:
            picture.save(path)
            print_notice(f"Saved {path}.")
        return picture

    def beside(self) -> None:
        """Show the viewer in a panel next to the notebook in JupyterLab, or otherwise in the cell.

        The viewers of later cells take the panel in turn, until the reader closes it or moves the
        view back. A window of less than 1200 px has no room for it.
        """
        self._cell.dock(self)

    def freeze(self, seconds: float = 5.0) -> "RestingView":
        """Return a copy of the view for a cell's last line, which later messages do not change.

        Args:
            seconds: The length [s] of robot time before now that the copy can play.
        """
        self.refresh()
        return self._cell.resting_view(self.scene_recording, seconds)

    def replay(self, seconds: float = 5.0) -> "RestingView":
        """Return a recording for the last line of a cell. It plays in a loop while it is visible.

        Args:
            seconds: The length [s] of robot time before now that it plays.
        """
        self.refresh()
        self.session.show_all(self.scene_recording.scenes(seconds))
        return self._cell.resting_view(self.scene_recording, seconds, plays=True)

    def reset(self) -> None:
        """Discard all received messages and transforms, as RViz's button Reset does."""
        self.session.reset()
        # Without it, nothing would be drawn until the next message, and a replay of what follows
        # would begin with an empty picture.
        self.session.refresh()

    def open(self, *, browser: bool = True, port: int = 0, token: str | None = None) -> str:
        """Show the viewer in a browser tab until the program ends.

        Args:
            browser: Whether to open the page, in addition to printing its URL.
            port: The port on this machine; 0 lets the system choose a free one.
            token: The secret part of the URL; None generates one.

        Returns:
            The URL; on a JupyterHub the URL of its proxy.

        Raises:
            CourseError: The port is in use, or the hub has no jupyter-server-proxy.
        """
        self.refresh()
        url = self._cell.open_page(port, token)
        announce("The viewer", url, browser=browser)
        return url

    def summary(self) -> str:
        """Describe in words the drawn objects, their positions in the fixed frame, and the statuses."""
        self.refresh()
        return self.session.summary()

    def on_click(self, callback: Callable[[Click], None]) -> Callable[[Click], None]:
        """Register a callback for clicks into the view; use ``@viewer.on_click`` above it."""
        self._cell.on_click.append(callback)
        return callback

    async def pick(self) -> Click:
        """Wait for the next click into the view: ``click = await viewer.pick()``.

        Raises:
            CourseError: No page shows the viewer.
        """
        return await self._cell.next_click()

    def refresh(self) -> None:
        """Bring the scene up to date at the current robot time."""
        self.session.context.show()
        self.session.update(self._graph.now_ns, is_opened=True)

    def close(self) -> None:
        """Unsubscribe, and remove the viewer from all cells."""
        self._end()

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        self.refresh()
        return self._cell.mime_bundle(self, **kwargs)
