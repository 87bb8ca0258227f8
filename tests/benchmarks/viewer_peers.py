"""Adapters with a common interface for several viewers, each with its server and a real page."""

import logging
import socket
import threading
import time
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import Page

Floats = NDArray[np.floating]


class Ours:
    """course_lib's scene, its page on 127.0.0.1."""

    name = "course_lib"
    pinocchio_class = "MeshcatVisualizer"

    def __init__(self) -> None:
        from course_lib.viewer.page_server import PageServer
        from course_lib.viewer.scene import Scene
        from course_lib.viewer.visualizer import Visualizer

        self.scene = Scene()
        self.server = PageServer(self.scene)
        self.server.start()
        self.url = self.server.url
        self.visualizer: Any = Visualizer(self.scene)
        self.parts: list[Any] = []
        self.count = 0

    def boxes(self, count: int) -> None:
        """Add boxes."""
        add_boxes(self, count)

    def move(self, matrices: Floats) -> None:
        """Move all boxes through the public API."""
        for part, matrix in zip(self.parts, matrices, strict=True):
            part.set_transform(matrix)
        self.count += len(self.parts)

    def move_each(self, matrices: Floats) -> None:
        """Move all boxes and flush the messages; only the sent bytes are measured."""
        self.move(matrices)
        number = self._number()
        self.server.link.flush()
        self.count -= len(self.parts) * (self._number() == number)
        time.sleep(0.0001)  # let the server's thread run, too

    def arrived(self, page: Page) -> int:
        """Count the transforms that were set, once the page has answered for the last of each."""
        last, matrix = self._number() + 1, np.eye(4)
        while max((page.number for page in self.server.link._flow.pages.values()), default=last) < last:
            # An equal transform would not be sent.
            matrix[0, 3] += 1
            self.parts[0].set_transform(matrix)
            self.server.link.flush()
            page.wait_for_timeout(5)
        return self.count

    def _number(self) -> int:
        return self.server.link.number

    def cloud(self, points: Floats) -> None:
        """Show a red cloud."""
        from course_lib.viewer.drawables import Points

        self.scene.set_object("cloud", Points(points, (1, 0, 0, 1), (0.05, 0.05)))

    def watch(self, page: Page) -> None:
        """Do nothing: the page answers by itself."""

    def mesh(self, vertices: Floats, faces: NDArray[np.integer]) -> None:
        """Show a mesh."""
        from course_lib.viewer.drawables import Mesh

        self.scene.set_object("mesh", Mesh(vertices, faces, (0.8, 0.8, 0.8, 1)))

    def move_mesh(self, matrix: Floats) -> None:
        """Place the mesh."""
        self.scene.set_transform("mesh", matrix)

    def close(self) -> None:
        """Stop the server."""
        self.server.close()


class Meshcat:
    """meshcat.Visualizer with its server process."""

    name = "meshcat"
    pinocchio_class = "MeshcatVisualizer"

    def __init__(self) -> None:
        import meshcat

        self.visualizer: Any = meshcat.Visualizer()
        self.url = self.visualizer.url()
        self.parts: list[Any] = []

    def boxes(self, count: int) -> None:
        """Add boxes."""
        add_boxes(self, count)

    def move(self, matrices: Floats) -> None:
        """Place all boxes."""
        for part, matrix in zip(self.parts, matrices, strict=True):
            part.set_transform(matrix)

    move_each = move

    def watch(self, page: Page) -> None:
        """Count the messages in the page."""
        page.evaluate("""() => {
            globalThis.arrived = 0;
            const act = viewer.set_transform;
            viewer.set_transform = function (...all) { arrived++; return act.apply(this, all); }; }""")

    def arrived(self, page: Page) -> int:
        """Count the transforms that the page has carried out."""
        return int(page.evaluate("arrived"))

    def cloud(self, points: Floats) -> None:
        """Show a red cloud."""
        import meshcat.geometry as g

        colors = np.zeros_like(points.T)
        colors[0] = 1
        self.visualizer["cloud"].set_object(g.PointCloud(points.T, colors, size=0.05))

    def mesh(self, vertices: Floats, faces: NDArray[np.integer]) -> None:
        """Show a mesh."""
        import meshcat.geometry as g

        shape = g.TriangularMeshGeometry(vertices, faces)
        self.visualizer["mesh"].set_object(shape, g.MeshLambertMaterial(color=0xCCCCCC))

    def move_mesh(self, matrix: Floats) -> None:
        """Place the mesh."""
        self.visualizer["mesh"].set_transform(matrix)

    def close(self) -> None:
        """Stop the server."""
        self.visualizer.window.server_proc.kill()


class Viser:
    """viser. Sent bytes are counted when they are written, which favours viser."""

    name = "viser"
    pinocchio_class = "ViserVisualizer"

    def __init__(self) -> None:
        import viser
        from viser import _messages

        logging.getLogger("websockets").setLevel(logging.CRITICAL)
        self.visualizer = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
        self.url = f"http://127.0.0.1:{self.visualizer.get_port()}"
        self.parts: list[Any] = []
        self.count = 0
        lock = threading.Lock()
        message_type: Any = _messages.SetPositionMessage
        write = message_type.as_serializable_dict

        def counted(message: Any, *args: Any) -> Any:
            with lock:
                self.count += 1
            return write(message, *args)

        message_type.as_serializable_dict = counted

    def boxes(self, count: int) -> None:
        """Add boxes."""
        for number in range(count):
            part = self.visualizer.scene.add_box(f"/part{number}", (255, 0, 0), (0.05, 0.05, 0.05))
            self.parts.append(part)

    def move(self, matrices: Floats) -> None:
        """Place all boxes: position and quaternion."""
        from viser.transforms import SO3

        turns = SO3.from_matrix(matrices[:, :3, :3]).wxyz
        for part, matrix, turn in zip(self.parts, matrices, turns, strict=True):
            part.position = matrix[:3, 3]
            part.wxyz = turn
        self.visualizer.flush()

    move_each = move

    def watch(self, page: Page) -> None:
        """Begin to count."""
        self.count = 0

    def arrived(self, _: Page) -> int:
        """Count the transforms that were written for the page."""
        return self.count

    def cloud(self, points: Floats) -> None:
        """Show a red cloud."""
        self.visualizer.scene.add_point_cloud(
            "/cloud", points, (255, 0, 0), point_size=0.05, precision="float32", point_shading="flat"
        )

    def mesh(self, vertices: Floats, faces: NDArray[np.integer]) -> None:
        """Show a mesh."""
        self.shown = self.visualizer.scene.add_mesh_simple("/mesh", vertices, faces, color=(204, 204, 204))

    def move_mesh(self, matrix: Floats) -> None:
        """Place the mesh."""
        self.shown.position = matrix[:3, 3]
        self.visualizer.flush()

    def close(self) -> None:
        """Stop the server."""
        self.visualizer.stop()


def add_boxes(peer: Any, count: int) -> None:
    """Add boxes through meshcat's calls."""
    import meshcat.geometry as g

    for number in range(count):
        part = peer.visualizer[f"part{number}"]
        part.set_object(g.Box([0.05, 0.05, 0.05]), g.MeshLambertMaterial(color=0xFF0000))
        peer.parts.append(part)


class Rerun:
    """Rerun's web viewer. Sent bytes are counted when they are logged, which favours Rerun."""

    name = "rerun"
    pinocchio_class = ""

    def __init__(self) -> None:
        import rerun

        self.rerun = rerun
        self.stream = rerun.RecordingStream("benchmark")
        connect_to = self.stream.serve_grpc(grpc_port=free_port())
        port = free_port()
        rerun.serve_web_viewer(web_port=port, open_browser=False, connect_to=connect_to)
        self.url = f"http://127.0.0.1:{port}/?url={connect_to}"
        self.count = 0
        self.parts = 0

    def boxes(self, count: int) -> None:
        """Add boxes."""
        box = self.rerun.Boxes3D(half_sizes=[[0.025] * 3], colors=[[255, 0, 0]], fill_mode="solid")
        for number in range(count):
            self.stream.log(f"part{number}", box)
        self.parts = count

    def move(self, matrices: Floats) -> None:
        """Place all boxes: position and rotation."""
        for number, matrix in enumerate(matrices):
            place = self.rerun.Transform3D(translation=matrix[:3, 3], mat3x3=matrix[:3, :3])
            self.stream.log(f"part{number}", place)
        self.stream.flush()
        self.count += len(matrices)

    move_each = move

    def watch(self, page: Page) -> None:
        """Do nothing, because logged bytes are counted."""

    def arrived(self, _: Page) -> int:
        """Count the transforms that were logged for the page."""
        return self.count

    def cloud(self, points: Floats) -> None:
        """Show a red cloud."""
        self.stream.log("cloud", self.rerun.Points3D(points, colors=[[255, 0, 0]], radii=0.025))
        self.stream.flush()

    def mesh(self, vertices: Floats, faces: NDArray[np.integer]) -> None:
        """Show a mesh."""
        shape = self.rerun.Mesh3D(
            vertex_positions=vertices, triangle_indices=faces, albedo_factor=[204, 204, 204]
        )
        self.stream.log("mesh", shape)

    def move_mesh(self, matrix: Floats) -> None:
        """Place the mesh."""
        self.stream.log("mesh", self.rerun.Transform3D(translation=matrix[:3, 3]))
        self.stream.flush()

    def close(self) -> None:
        """Disconnect; its servers end with this process."""
        self.stream.disconnect()


def free_port() -> int:
    """Return a port that nothing listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


PEERS: tuple[Any, ...] = (Ours, Meshcat, Viser, *((Rerun,) if find_spec("rerun") else ()))
