"""nav2's map files (YAML and an image), the nodes that load and save them, lifecycle_manager."""

import array
import io
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml
from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetState
from nav2_msgs.srv import LoadMap, ManageLifecycleNodes, SaveMap
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from PIL import Image
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.exceptions import ParameterUninitializedException
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from std_srvs.srv import Trigger
from tf_transformations import euler_from_quaternion

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import current_graph
from course_lib.third_party import read_text

MODES = ("trinary", "scale", "raw")
FORMATS = ("pgm", "png", "bmp")
_KEYS = "image, resolution, origin, negate, occupied_thresh and free_thresh"
_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# Values of cells, and the gray levels of nav2_map_server for them.
_FREE, _OCCUPIED, _UNKNOWN = 0, 100, -1
_FREE_GRAY, _OCCUPIED_GRAY, _UNKNOWN_GRAY = 254, 0, 205
# The thresholds that belong to these gray levels.
_OF_GRAYS = (0.65, 0.196)


class MapYamlError(CourseError):
    """The YAML file of a map is malformed."""


class MapImageError(CourseError):
    """The image of a map is missing or malformed."""


@dataclass(frozen=True)
class MapSettings:
    """The content of a map's YAML file: its scale, and the meaning of its gray levels.

    Args:
        image: The path of the image.
        resolution: The size of a cell, [m].
        origin: The pose of the lower left corner, (x [m], y [m], yaw [rad]).
        occupied_thresh: Probability above which a cell is occupied.
        free_thresh: Probability below which a cell is free.
        negate: Whether white is occupied.
        mode: `trinary`, `scale` or `raw`.
    """

    image: Path
    resolution: float
    origin: tuple[float, float, float]
    occupied_thresh: float
    free_thresh: float
    negate: bool
    mode: str


def read_settings(path: Path) -> MapSettings:
    """Read the YAML file of a map.

    Raises:
        MapYamlError: The file is missing, or a key of it is missing or has an invalid value.
    """
    try:
        content = yaml.safe_load(read_text(path))
    except (OSError, UnicodeDecodeError) as error:
        raise MapYamlError(f"{path}: not readable: {getattr(error, 'strerror', None) or error}.") from None
    except RecursionError:
        raise MapYamlError(f"{path}: not YAML: it is nested too deeply.") from None
    except yaml.YAMLError as error:
        raise MapYamlError(f"{path}: not YAML: {' '.join(str(error).split())}.") from None
    if not isinstance(content, Mapping):
        raise MapYamlError(f"{path}: expected a mapping with {_KEYS}, got {content!r:.40}.")
    values = _YamlValues(path, content)
    mode = str(content.get("mode", "trinary")).lower()
    if mode not in MODES:
        raise MapYamlError(f"{path}: mode: {content['mode']!r}, expected trinary, scale or raw.")
    image = values.value("image")
    if not isinstance(image, str) or not image:
        raise MapYamlError(f"{path}: image: {image!r}, expected the name of an image file.")
    resolution, origin = values.number("resolution"), values.value("origin")
    if not isinstance(origin, list) or len(origin) != 3:
        raise MapYamlError(f"{path}: origin: {origin!r:.60}, expected [x, y, yaw] in m and rad.")
    x, y, yaw = (values.as_number("origin", value) for value in origin)
    return MapSettings(
        image=path.parent / image,
        resolution=resolution,
        origin=(x, y, yaw),
        occupied_thresh=values.number("occupied_thresh"),
        free_thresh=values.number("free_thresh"),
        negate=bool(values.number("negate")),
        mode=mode,
    )


class _YamlValues(NamedTuple):
    """Typed access to the keys of a map's YAML file."""

    path: Path
    content: Mapping[str, Any]

    def number(self, key: str) -> float:
        number = self.as_number(key, self.value(key))
        if key == "resolution" and number <= 0.0:
            raise MapYamlError(f"{self.path}: resolution: {number}, expected the size of a cell in m, > 0.")
        return number

    def value(self, key: str) -> Any:
        if key not in self.content:
            raise MapYamlError(f"{self.path}: the key '{key}' is missing. Expected {_KEYS}.")
        return self.content[key]

    def as_number(self, key: str, value: Any) -> float:
        # YAML 1.1 reads 5e-2 as a string, which nav2_map_server accepts as a number.
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if not math.isfinite(number):
            raise MapYamlError(f"{self.path}: {key}: {value!r:.60}, expected a number.")
        return number


def read_map(path: Path) -> OccupancyGrid:
    """Read a map: its YAML file, and the image that the file names.

    Raises:
        MapYamlError: The YAML file is missing or malformed.
        MapImageError: The image is missing or malformed.
    """
    settings = read_settings(path)
    if not os.path.exists(settings.image):
        name, text = settings.image.name, f"{path}: image: {settings.image} does not exist."
        # A file from another computer may contain the path of the image on that computer.
        if os.path.isfile(path.with_name(name)):
            text += f" It is next to {path.name}: write image: {name}"
        else:
            text += f" Write the name of an image next to {path.name}."
        raise MapImageError(text)
    gray, is_opaque = _read_image(settings.image)
    cells = _cells(settings, gray, is_opaque)
    grid = OccupancyGrid()
    grid.header.frame_id = "map"
    grid.info.height, grid.info.width = cells.shape
    grid.info.resolution = settings.resolution
    x, y, yaw = settings.origin
    grid.info.origin.position.x, grid.info.origin.position.y = x, y
    grid.info.origin.orientation.z, grid.info.origin.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    # The first row of a grid is the lowest one.
    grid.data = array.array("b", cells[::-1].tobytes())
    return grid


def _read_image(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the gray levels 0..255 of an image, and where it is opaque, both of shape (height, width)."""
    try:
        with Image.open(path) as image:
            if image.mode.startswith("I"):
                # The image has 16 bits per pixel.
                gray = (np.asarray(image, np.float64) * (255 / 65535)).round().astype(np.uint8)
            else:
                gray = np.asarray(image.convert("RGB").convert("L"))
            alpha = np.asarray(image.convert("RGBA"))[..., 3] if image.has_transparency_data else None
    # Pillow raises a SyntaxError for some malformed images.
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        reason = getattr(error, "strerror", None) or error
        raise MapImageError(f"{path}: not an image of a map: {reason}. Expected PGM, PNG or BMP.") from None
    return gray, np.full(gray.shape, True) if alpha is None else alpha == 255


def _cells(settings: MapSettings, gray: np.ndarray, is_opaque: np.ndarray) -> np.ndarray:
    """Return the values of the cells, int8 of shape (height, width), as nav2_map_server computes them."""
    if settings.mode == "raw":
        return np.where(gray <= _OCCUPIED, gray.astype(np.int8), np.int8(_UNKNOWN))
    level = gray.astype(np.float32) / np.float32(255)
    occupancy = level if settings.negate else np.float32(1) - level
    low, high = np.float32(settings.free_thresh), np.float32(settings.occupied_thresh)
    is_free, is_occupied = occupancy <= low, occupancy >= high
    between = np.full(gray.shape, _UNKNOWN, np.float32)
    if settings.mode == "scale" and high > low:
        between = np.round((occupancy - low) / (high - low) * 100)
    cells = np.where(is_free, _FREE, np.where(is_occupied, _OCCUPIED, between))
    return np.where(is_opaque, cells, _UNKNOWN).astype(np.int8)


def write_map(
    grid: OccupancyGrid,
    name: str,
    *,
    image_format: str = "pgm",
    mode: str = "trinary",
    occupied_thresh: float = 0.65,
    free_thresh: float = 0.25,
) -> list[Path]:
    """Write a map as `NAME.yaml` and an image in the same folder, as map_saver_cli does.

    Returns:
        The paths of the image and of the YAML file.

    Raises:
        CourseError: An option is invalid, or the size of the map does not match its data.
        OSError: A file cannot be written.
    """
    if image_format not in FORMATS:
        raise CourseError(f"image format {image_format!r}, expected pgm, png or bmp.")
    if not 0.0 <= free_thresh < occupied_thresh <= 1.0:
        raise CourseError(
            f"thresholds: free {free_thresh}, occupied {occupied_thresh}; expected 0 ≤ free < occupied ≤ 1."
        )
    shape = grid.info.height, grid.info.width
    if len(grid.data) != shape[0] * shape[1] or not len(grid.data):
        raise CourseError(f"the map has {len(grid.data)} cells, expected {shape[1]} x {shape[0]}.")
    cells = np.array(grid.data, np.int16).reshape(shape)[::-1]
    image = Image.fromarray(_gray_levels(cells, mode, occupied_thresh, free_thresh))
    encoded = io.BytesIO()
    image.save(encoded, {"pgm": "PPM"}.get(image_format, image_format.upper()))
    files = [Path(f"{name}.{image_format}"), Path(f"{name}.yaml")]
    turn = grid.info.origin.orientation
    yaw = euler_from_quaternion((turn.x, turn.y, turn.z, turn.w))[2]
    position = grid.info.origin.position
    high, low = _OF_GRAYS if mode == "trinary" else (f"{occupied_thresh:.3f}", f"{free_thresh:.3f}")
    text = (
        f"image: {files[0].name}\nmode: {mode}\nresolution: {grid.info.resolution:.3f}\n"
        f"origin: [{position.x:.3f}, {position.y:.3f}, {yaw:.7g}]\nnegate: 0\n"
        f"occupied_thresh: {high}\nfree_thresh: {low}\n"
    )
    # Write both files, or leave both as they were.
    contents = {files[0]: encoded.getvalue(), files[1]: text.encode()}
    drafts = {path: path.with_name(f".{path.name}.draft") for path in contents}
    try:
        for path, content in contents.items():
            drafts[path].write_bytes(content)
        for path, draft in drafts.items():
            draft.replace(path)
    finally:
        for draft in drafts.values():
            draft.unlink(missing_ok=True)
    return files


def _gray_levels(
    cells: np.ndarray,
    mode: str,
    occupied_thresh: float,
    free_thresh: float,
) -> np.ndarray:
    """Return the picture of cells: gray levels, in the mode `scale` with an alpha channel."""
    is_known = (cells >= 0) & (cells <= _OCCUPIED)
    if mode == "raw":
        return np.where(is_known, cells, 255).astype(np.uint8)
    if mode == "scale":
        gray = np.where(is_known, np.round((100 - cells) * 2.55), 128)
        return np.dstack([gray, gray, gray, is_known * 255]).astype(np.uint8)
    is_free = is_known & (cells <= round(free_thresh * 100))
    is_occupied = is_known & (cells >= round(occupied_thresh * 100))
    gray = np.where(is_free, _FREE_GRAY, np.where(is_occupied, _OCCUPIED_GRAY, _UNKNOWN_GRAY))
    return gray.astype(np.uint8)


class MapServer(LifecycleNode):
    """nav2's map_server: publishes the map of the file `yaml_filename` when it is active."""

    def __init__(self) -> None:
        super().__init__("map_server")
        self.get_logger().info("Creating")
        self.declare_parameter("yaml_filename", Parameter.Type.STRING)
        self.declare_parameter("topic_name", "map")
        self.declare_parameter("frame_id", "map")
        self._grid: OccupancyGrid | None = None
        self._entities: list[Any] = []
        self._is_active = False

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Load the map, if a file is given, and create the publisher and the services."""
        self.get_logger().info("Configuring")
        try:
            file = self.get_parameter("yaml_filename").value
        except ParameterUninitializedException:
            self.get_logger().error("The parameter yaml_filename is missing: the path of a map's YAML file.")
            return TransitionCallbackReturn.ERROR
        if file and self._load(file) != LoadMap.Response.RESULT_SUCCESS:
            return TransitionCallbackReturn.ERROR
        if not file:
            text = "yaml-filename parameter is empty, set map through 'load_map'-service"
            self.get_logger().info(text)
        topic = self.get_parameter("topic_name").value
        self._publisher = self.create_lifecycle_publisher(OccupancyGrid, topic, _LATCHED)
        name = self.get_name()
        self._entities = [
            self.create_service(GetMap, f"{name}/map", self._on_get_map),
            self.create_service(LoadMap, f"{name}/load_map", self._on_load_map),
        ]
        return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Publish the map."""
        self.get_logger().info("Activating")
        result = super().on_activate(state)
        self._is_active = True
        if self._grid is not None:
            self._publisher.publish(self._grid)
        return result

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop publishing."""
        self.get_logger().info("Deactivating")
        self._is_active = False
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Remove the map, the publisher and the services."""
        self.get_logger().info("Cleaning up")
        self.destroy_lifecycle_publisher(self._publisher)
        for service in self._entities:
            self.destroy_service(service)
        self._grid = None
        return super().on_cleanup(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Log the shutdown."""
        self.get_logger().info("Shutting down")
        self._is_active = False
        return super().on_shutdown(state)

    def _load(self, file: str) -> int:
        """Load a map. Return a result of LoadMap."""
        logger = get_logger("map_io")
        if not file:
            logger.error("YAML file name is empty, can't load!")
            return LoadMap.Response.RESULT_MAP_DOES_NOT_EXIST
        logger.info(f"Loading yaml file: {file}")
        path = Path(file).expanduser()
        try:
            grid = read_map(path)
        except MapYamlError as error:
            logger.error(f"Failed to parse map YAML loaded from file {file} for reason: {error}")
            return LoadMap.Response.RESULT_INVALID_MAP_METADATA
        except MapImageError as error:
            logger.error(f"Failed to load image file for reason: {error}")
            return LoadMap.Response.RESULT_INVALID_MAP_DATA
        info = grid.info
        logger.info(f"Read map {path}: {info.width} X {info.height} map @ {info.resolution:g} m/cell")
        info.map_load_time = self.get_clock().now().to_msg()
        grid.header.stamp, grid.header.frame_id = info.map_load_time, self.get_parameter("frame_id").value
        self._grid = grid
        return LoadMap.Response.RESULT_SUCCESS

    def _on_get_map(self, request: GetMap.Request, response: GetMap.Response) -> GetMap.Response:
        if not self._is_active:
            self.get_logger().warning("Received GetMap request but not in ACTIVE state, ignoring!")
            return response
        self.get_logger().info("Handling GetMap request")
        response.map = self._grid or OccupancyGrid()
        return response

    def _on_load_map(
        self,
        request: LoadMap.Request,
        response: LoadMap.Response,
    ) -> LoadMap.Response:
        if not self._is_active:
            self.get_logger().warning("Received LoadMap request but not in ACTIVE state, ignoring!")
            response.result = LoadMap.Response.RESULT_UNDEFINED_FAILURE
            return response
        self.get_logger().info("Handling LoadMap request")
        response.result = self._load(request.map_url)
        if response.result == LoadMap.Response.RESULT_SUCCESS and self._grid is not None:
            response.map = self._grid
            self._publisher.publish(self._grid)
        return response


class MapSaver(LifecycleNode):
    """Saves the map of a topic: the node of nav2's map_saver_cli and map_saver_server."""

    def __init__(self) -> None:
        super().__init__("map_saver")
        self.get_logger().info("Creating")
        self.declare_parameter("save_map_timeout", 2.0)
        self.declare_parameter("free_thresh_default", 0.25)
        self.declare_parameter("occupied_thresh_default", 0.65)
        self.declare_parameter("map_subscribe_transient_local", True)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Create the service that saves a map."""
        self.get_logger().info("Configuring")
        self._service = self.create_service(SaveMap, f"{self.get_name()}/save_map", self._on_save_map)
        return super().on_configure(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Remove the service."""
        self.get_logger().info("Cleaning up")
        self.destroy_service(self._service)
        return super().on_cleanup(state)

    async def save(
        self,
        topic: str = "",
        name: str = "",
        *,
        image_format: str = "",
        mode: str = "trinary",
        occupied_thresh: float = 0.0,
        free_thresh: float = 0.0,
    ) -> bool:
        """Wait for a map on a topic and write it. Options that are 0 or "" have their defaults.

        Returns:
            Whether the map was saved; otherwise the reason is logged.
        """
        logger, topic = self.get_logger(), topic or "map"
        name = name or f"map_{self.get_clock().now().nanoseconds // 10**9}"
        logger.info(f"Saving map from '{topic}' topic to '{name}' file")
        if mode.lower() not in MODES:
            logger.warning(f"Map mode parameter not recognized: '{mode}', using default value (trinary)")
            mode = "trinary"
        grid = await self._wait_for_map(topic)
        if grid is None:
            logger.error("Failed to spin map subscription")
            timeout = self.get_parameter("save_map_timeout").value
            logger.error(f"No map was published on '{topic}' within {timeout} s.")
            return False
        try:
            files = write_map(
                grid,
                name,
                image_format=image_format.lower() or ("png" if mode.lower() == "scale" else "pgm"),
                mode=mode.lower(),
                occupied_thresh=occupied_thresh or self.get_parameter("occupied_thresh_default").value,
                free_thresh=free_thresh or self.get_parameter("free_thresh_default").value,
            )
        except (CourseError, OSError) as error:
            get_logger("map_io").error(f"Failed to write map for reason: {error}")
            logger.error("Failed to save the map")
            return False
        get_logger("map_io").info(f"Writing map occupancy data to {files[0]}")
        get_logger("map_io").info(f"Writing map metadata to {files[1]}")
        logger.info("Map saved successfully")
        return True

    async def _wait_for_map(self, topic: str) -> OccupancyGrid | None:
        received: Future[OccupancyGrid | None] = Future()

        def receive(grid: OccupancyGrid | None) -> None:
            if not received.done():
                received.set_result(grid)

        is_latched = self.get_parameter("map_subscribe_transient_local").value
        subscription = self.create_subscription(OccupancyGrid, topic, receive, _LATCHED if is_latched else 10)
        timer = self.create_timer(self.get_parameter("save_map_timeout").value, lambda: receive(None))
        try:
            return await received
        finally:
            self.destroy_timer(timer)
            self.destroy_subscription(subscription)

    async def _on_save_map(
        self,
        request: SaveMap.Request,
        response: SaveMap.Response,
    ) -> SaveMap.Response:
        response.result = await self.save(
            request.map_topic,
            request.map_url,
            image_format=request.image_format,
            mode=request.map_mode,
            occupied_thresh=request.occupied_thresh,
            free_thresh=request.free_thresh,
        )
        return response


# The transitions, with the resulting state and the log message of each.
_TRANSITIONS = {
    Transition.TRANSITION_CONFIGURE: (State.PRIMARY_STATE_INACTIVE, "Configuring"),
    Transition.TRANSITION_CLEANUP: (State.PRIMARY_STATE_UNCONFIGURED, "Cleaning up"),
    Transition.TRANSITION_ACTIVATE: (State.PRIMARY_STATE_ACTIVE, "Activating"),
    Transition.TRANSITION_DEACTIVATE: (State.PRIMARY_STATE_INACTIVE, "Deactivating"),
    Transition.TRANSITION_UNCONFIGURED_SHUTDOWN: (State.PRIMARY_STATE_FINALIZED, "Shutting down"),
}
_UP = (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE)
_DOWN = (Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_CLEANUP)
# The transitions of each command, with the log messages before and after them.
_COMMANDS = {
    ManageLifecycleNodes.Request.STARTUP: (_UP, "Starting managed nodes bringup...", "are active"),
    ManageLifecycleNodes.Request.CONFIGURE: (_UP[:1], "Configuring managed nodes...", "are now configured"),
    ManageLifecycleNodes.Request.CLEANUP: (_DOWN[1:], "Cleaning up managed nodes...", "have been cleaned up"),
    ManageLifecycleNodes.Request.PAUSE: (_DOWN[:1], "Pausing managed nodes...", "have been paused"),
    ManageLifecycleNodes.Request.RESUME: (_UP[1:], "Resuming managed nodes...", "are active"),
    ManageLifecycleNodes.Request.RESET: (_DOWN, "Resetting managed nodes...", "have been reset"),
    ManageLifecycleNodes.Request.SHUTDOWN: (
        (*_DOWN, Transition.TRANSITION_UNCONFIGURED_SHUTDOWN),
        "Shutting down managed nodes...",
        "have been shut down",
    ),
}
# Interval between checks whether the nodes are available, and between log messages about missing
# ones [s].
_LOOK, _REPORT = 0.05, 2.0


class LifecycleManager(Node):
    """Configures and activates the nodes of the parameter `node_names`, in this order.

    A node that the launch has left out, such as a compiled server, is skipped with a warning. There
    are no bonds, so the end of a node is not detected.

    Raises:
        CourseError: The parameter `node_names` is missing.
    """

    def __init__(self) -> None:
        super().__init__("lifecycle_manager")
        self.get_logger().info("Creating")
        self.declare_parameter("node_names", Parameter.Type.STRING_ARRAY)
        self.declare_parameter("autostart", False)
        self.declare_parameter("bond_timeout", 4.0)
        self.declare_parameter("bond_respawn_max_duration", 10.0)
        self.declare_parameter("attempt_respawn_reconnection", True)
        try:
            self._managed = list(self.get_parameter("node_names").value)
        except ParameterUninitializedException:
            raise CourseError(
                "lifecycle_manager: the parameter node_names is missing, the names of the "
                "lifecycle nodes: parameters=[{'node_names': ['map_server'], 'autostart': True}]"
            ) from None
        self._is_active = False
        # Reentrant, because its callbacks wait for responses of the managed nodes.
        group = ReentrantCallbackGroup()
        name = self.get_name()
        manage, is_active = f"{name}/manage_nodes", f"{name}/is_active"
        self.create_service(ManageLifecycleNodes, manage, self._on_manage, callback_group=group)
        self.create_service(Trigger, is_active, self._on_is_active, callback_group=group)
        self.get_logger().info("Creating and initializing lifecycle service clients")
        self._links: dict[str, tuple[Any, Any]] = {
            name: (
                self.create_client(ChangeState, f"{name}/change_state", callback_group=group),
                self.create_client(GetState, f"{name}/get_state", callback_group=group),
            )
            for name in self._managed
        }
        self._look_count = 0
        self._timer = self.create_timer(_LOOK, self._wait_for_nodes, callback_group=group)

    async def _wait_for_nodes(self) -> None:
        """Start the nodes as soon as all of them exist."""
        for name in [name for name in self._managed if name in current_graph().left_out_nodes]:
            self.get_logger().warning(f"'{name}' cannot run here: the other nodes are managed without it.")
            self._managed.remove(name)
        self._look_count += 1
        for name in self._managed:
            get_state = self._links[name][1]
            if not get_state.service_is_ready():
                if self._look_count % round(_REPORT / _LOOK) == 0:
                    self.get_logger().info(f"Waiting for service {name}/get_state...")
                return
        self._timer.cancel()
        if self.get_parameter("autostart").value:
            await self._execute(ManageLifecycleNodes.Request.STARTUP)

    async def _execute(self, command: int) -> bool:
        transitions, before, after = _COMMANDS[command]
        self.get_logger().info(before)
        for transition in transitions:
            # Nodes are stopped in the reverse order.
            for name in self._managed if transition in _UP else reversed(self._managed):
                goal, text = _TRANSITIONS[transition]
                self.get_logger().info(f"{text} {name}")
                change_state, get_state = self._links[name]
                request = ChangeState.Request(transition=Transition(id=transition))
                answer = await change_state.call_async(request)
                state = await get_state.call_async(GetState.Request())
                if not answer.success or state.current_state.id != goal:
                    self.get_logger().error(f"Failed to change state for node: {name}")
                    self.get_logger().error("Failed to bring up all requested nodes. Aborting bringup.")
                    self._is_active = False
                    return False
        self.get_logger().info(f"Managed nodes {after}")
        self._is_active = after == "are active"
        return True

    async def _on_manage(
        self, request: ManageLifecycleNodes.Request, response: ManageLifecycleNodes.Response
    ) -> ManageLifecycleNodes.Response:
        if request.command in _COMMANDS:
            response.success = await self._execute(request.command)
        return response

    def _on_is_active(
        self,
        request: Trigger.Request,
        response: Trigger.Response,
    ) -> Trigger.Response:
        response.success = self._is_active
        return response
