"""Compare the viewer with meshcat, viser and Rerun in real pages: `python -m tests.benchmarks.bench_viewer`.

Needs the extra `bench`. Absolute numbers depend on the machine; the ratios in one run are what
counts.
"""

import argparse
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, Page

from tests.benchmarks.table import Row, markdown
from tests.benchmarks.viewer_peers import PEERS, Floats, Ours
from tests.browser.fake_host import chromium

OBJECTS = 500
SECONDS = 2.0  # of each measurement of speed
PATIENCE = 90.0  # [s]
# How long [s] a page may settle before it is measured: Rerun compiles its shaders in software
# first.
SETTLE = {"rerun": 40.0}
NO_DRAWING = """for (const gl of [WebGLRenderingContext, WebGL2RenderingContext])
    for (const draw of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"])
        if (gl.prototype[draw]) gl.prototype[draw] = () => {};"""
FIRST_PICTURE = {
    "course_lib": """
import numpy as np
from course_lib.viewer.drawables import Solids
from course_lib.viewer.page_server import PageServer
from course_lib.viewer.scene import Scene
scene = Scene()
scene.set_object("box", Solids("box", [np.eye(4)], (1, 0, 0, 1)))
server = PageServer(scene); server.start(); print(server.url, flush=True)""",
    "meshcat": """
import meshcat, meshcat.geometry as g
vis = meshcat.Visualizer()
vis["box"].set_object(g.Box([1, 1, 1]), g.MeshLambertMaterial(color=0xFF0000))
print(vis.url(), flush=True)""",
    "viser": """
import viser
server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
server.scene.add_box("/box", (255, 0, 0), (1, 1, 1))
print(f"http://127.0.0.1:{server.get_port()}", flush=True)""",
    "rerun": """
import rerun as rr
from tests.benchmarks.viewer_peers import free_port
rr.init("box")
url, port = rr.serve_grpc(grpc_port=free_port()), free_port()
rr.serve_web_viewer(web_port=port, open_browser=False, connect_to=url)
rr.log("box", rr.Boxes3D(half_sizes=[[0.5] * 3], colors=[[255, 0, 0]], fill_mode="solid"))
print(f"http://127.0.0.1:{port}/?url={url}", flush=True)""",
}


@dataclass(frozen=True, slots=True)
class Measurement:
    """A number that each viewer is measured by."""

    what: str
    unit: str
    measure: Callable[[Browser, Any], float]
    less: bool = True  # is better


def measurements() -> Iterator[Measurement]:
    """Yield the measurements."""
    yield Measurement(
        "transforms, followed by a page, drawing stubbed", "1/s", partial(speed, drawn=False), False
    )
    yield Measurement("transforms, followed by a page, drawn", "1/s", partial(speed, drawn=True), False)
    each = partial(speed, drawn=True, how="move_each")
    yield Measurement("transforms, each one sent, drawn", "1/s", each, False)
    yield Measurement("Python CPU per transform", "µs", cpu)
    for robot in ("ur10", "talos"):
        yield Measurement(f"Pinocchio's display(q), {robot}", "1/s", partial(displays, name=robot), False)
    for count in (100_000, 1_000_000):
        yield Measurement(f"time to show {count:,} points", "s", partial(cloud, count=count))
    yield Measurement("frames of a moving robot of 80,000 triangles", "1/s", frames, False)
    yield Measurement("program start to first picture", "s", first_picture)
    yield Measurement("bytes for 20 viewers on a page", "kB", twenty)


def rows(only: str = "", repeats: int = 3) -> Iterator[Row]:
    """Yield a row per measurement whose name contains `only`: the best of `repeats` runs of each peer."""
    with chromium() as browser:
        for one in measurements():
            if only in one.what:
                runs = [[one.measure(browser, peer) for peer in PEERS] for _ in range(repeats)]
                best = min if one.less else max
                ours, *others = (best(values) for values in zip(*runs, strict=True))
                peers = dict(zip((peer.name for peer in PEERS[1:]), others, strict=True))
                yield Row(one.what, one.unit, ours, peers, one.less)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", default="", help="part of a row's name")
    parser.add_argument("--repeats", type=int, default=3, help="the best of so many runs counts")
    print(markdown(rows(**vars(parser.parse_args()))))


@contextmanager
def opened(browser: Browser, peer: Any, drawn: bool = True) -> Iterator[Page]:
    """Show a peer's page."""
    page = browser.new_page(viewport={"width": 768, "height": 400})
    try:
        if not drawn:
            page.add_init_script(NO_DRAWING)
        page.goto(peer.url)
        page.wait_for_selector("canvas", timeout=1000 * PATIENCE)
        page.wait_for_timeout(1000 * SETTLE.get(peer.name, 2.0))
        yield page
    finally:  # or meshcat's server stays
        page.close()
        peer.close()


def poses() -> Iterator[Floats]:
    """Return matrices for all objects, others at each call, shape (N, 4, 4)."""
    matrices = np.tile(np.eye(4), (OBJECTS, 1, 1))
    where = np.linspace(0, 30, OBJECTS)
    for turn in range(1_000_000):
        matrices[:, 0, 3], matrices[:, 1, 3] = np.cos(where + turn / 10), np.sin(where + turn / 10)
        yield matrices


def speed(browser: Browser, kind: Any, drawn: bool, how: str = "move") -> float:
    """Count the transforms set in a second, as fast as they go, until the page has the last of them."""
    peer = kind()
    peer.boxes(OBJECTS)
    with opened(browser, peer, drawn) as page:
        peer.watch(page)
        move = getattr(peer, how)
        before, start = peer.arrived(page), time.perf_counter()
        for matrices in poses():
            move(matrices)
            if time.perf_counter() - start > SECONDS:
                break
        arrived: int = peer.arrived(page) - before
        return arrived / (time.perf_counter() - start)


def cpu(browser: Browser, kind: Any) -> float:
    """CPU of this process for a transform that is set, at up to 40 Hz, in [us]; a server's is not counted."""
    peer = kind()
    peer.boxes(OBJECTS)
    with opened(browser, peer) as page:
        peer.watch(page)
        begin, start, rounds = time.process_time(), time.perf_counter(), 0
        for matrices in poses():
            peer.move(matrices)
            rounds += 1
            time.sleep(max(0.0, start + rounds / 40 - time.perf_counter()))
            if time.perf_counter() - start > SECONDS:
                break
        return 1e6 * (time.process_time() - begin) / (rounds * OBJECTS)


def displays(browser: Browser, kind: Any, name: str) -> float:
    """Count display(q) of Pinocchio's visualizer for a peer in a second, with a page that follows."""
    import pinocchio
    from example_robot_data import load

    if not kind.pinocchio_class:
        return float("nan")
    robot, peer = load(name), kind()
    visualizer = getattr(import_module("pinocchio.visualize"), peer.pinocchio_class)(
        robot.model, robot.collision_model, robot.visual_model
    )
    visualizer.initViewer(viewer=peer.visualizer)
    visualizer.loadViewerModel()
    configuration = pinocchio.neutral(robot.model)
    with opened(browser, peer):
        start, count = time.perf_counter(), 0
        while time.perf_counter() - start < SECONDS:
            configuration[-1] = np.sin(count / 30)
            visualizer.display(configuration)
            count += 1
        return count / (time.perf_counter() - start)


def cloud(browser: Browser, kind: Any, count: int) -> float:
    """Time from the call to red pixels, [s]."""
    points = np.random.default_rng(0).uniform(-1, 1, (count, 3)).astype(np.float32)
    peer = kind()
    with opened(browser, peer) as page:
        start = time.perf_counter()
        peer.cloud(points)
        wait_for_red(page)
        return time.perf_counter() - start


COUNT_PICTURES = """
    globalThis.pictures = 0;
    let isDrawn = false;
    for (const gl of [WebGLRenderingContext, WebGL2RenderingContext])
        for (const name of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"]) {
            const draw = gl.prototype[name];
            if (!draw) continue;
            gl.prototype[name] = function (...all) { isDrawn = true; return draw.apply(this, all); };
        }
    const count = () => { pictures += isDrawn; isDrawn = false; requestAnimationFrame(count); };
    requestAnimationFrame(count);"""


def frames(browser: Browser, kind: Any) -> float:
    """Count the frames of the page in a second in which something was drawn, while a robot moves at 40 Hz."""
    peer = kind()
    peer.mesh(*robot_mesh())
    page = browser.new_page(viewport={"width": 848, "height": 400})
    try:
        page.add_init_script(COUNT_PICTURES)
        page.goto(peer.url)
        page.wait_for_selector("canvas", timeout=1000 * PATIENCE)
        page.wait_for_timeout(1000 * SETTLE.get(peer.name, 4.0))
        where = np.eye(4)
        before, start, turn = int(page.evaluate("pictures")), time.perf_counter(), 0
        while time.perf_counter() - start < 3 * SECONDS:
            where[0, 3] = 0.3 * np.sin(turn / 10)
            peer.move_mesh(where)
            turn += 1
            page.wait_for_timeout(25)
        return (int(page.evaluate("pictures")) - before) / (time.perf_counter() - start)
    finally:
        page.close()
        peer.close()


def robot_mesh() -> tuple[Floats, NDArray[np.integer]]:
    """Return the dog of week 0 as one mesh: vertices, shape (N, 3), and faces, shape (M, 3)."""
    from course_lib.displays.viewer import Viewer
    from course_lib.robots import load_robot
    from course_lib.viewer.drawables import Mesh

    viewer = Viewer()
    viewer.show_robot(load_robot("go2"))
    vertices, faces, count = [], [], 0
    for path, thing in viewer.scene.objects().items():
        if isinstance(thing, Mesh):
            matrix = viewer.scene.world_transform(path)
            vertices.append(thing.vertices @ matrix[:3, :3].T + matrix[:3, 3])
            faces.append(thing.faces + count)
            count += len(thing.vertices)
    viewer.close()
    return np.concatenate(vertices), np.concatenate(faces)


def first_picture(browser: Browser, kind: Any) -> float:
    """Time from the start of a program that shows a red box to red pixels, [s]."""
    start = time.perf_counter()
    code = FIRST_PICTURE[kind.name] + "\nimport sys; sys.stdin.read()"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        url = next(line.strip() for line in process.stdout if line.startswith("http"))
        page = browser.new_page(viewport={"width": 768, "height": 400})
        page.goto(url)
        wait_for_red(page)
        took = time.perf_counter() - start
        page.close()
        process.stdin.close()  # it ends by itself: killed, it would leave meshcat's server behind
        try:
            process.wait(5)
        except subprocess.TimeoutExpired:
            process.kill()
    return took


def twenty(browser: Browser, kind: Any) -> float:
    """Return the data that 20 viewers of a box send [kB]: widget states, or WebSocket frames of the peers."""
    if kind is Ours:
        return widgets(20) / 1000
    peer = kind()
    peer.boxes(1)
    page = browser.new_page()
    session = page.context.new_cdp_session(page)
    sizes: list[float] = []
    session.on("Network.loadingFinished", lambda event: sizes.append(event["encodedDataLength"]))
    session.on("Network.webSocketFrameReceived", lambda e: sizes.append(len(e["response"]["payloadData"])))
    session.send("Network.enable")
    page.goto(peer.url)  # so that the frames are of the same site
    # Twenty Rerun viewers need more memory than most machines have: one is measured, which favours
    # Rerun.
    others = 0 if kind.name == "rerun" else 19
    page.evaluate(
        "([url, others]) => { for (let i = 0; i < others; i++) document.body.append(Object.assign("
        "document.createElement('iframe'), { src: url })) }",
        [peer.url, others],
    )
    page.wait_for_timeout(8000)
    page.close()
    peer.close()
    return sum(sizes) / 1000


def widgets(count: int) -> float:
    """Add up the bytes of the states of widgets that show a box each, with the code that they share."""
    from ipywidgets.widgets.widget import _instances

    from course_lib.viewer.drawables import Solids
    from course_lib.viewer.scene import Scene
    from course_lib.viewer.widget import SceneWidget

    states, shared = [], set[str]()
    for _ in range(count):
        scene = Scene()
        scene.set_object("box", Solids("box", [np.eye(4)], (1, 0, 0, 1)))
        widget = SceneWidget(scene)
        shared.add(widget.code)
        states.append(widget.get_state())
    states += [_instances[model].get_state() for model in shared]
    return sum(len(v) for state in states for v in state.values() if isinstance(v, bytes | str))


def wait_for_red(page: Page) -> None:
    """Wait until the page shows something red."""
    end = time.perf_counter() + PATIENCE
    while time.perf_counter() < end:
        pixels = np.asarray(Image.open(BytesIO(page.screenshot())).convert("RGB")).astype(int)
        if ((pixels[..., 0] > 90) & (pixels[..., 1:].max(axis=-1) < 60)).sum() > 100:
            return
    raise TimeoutError(f"Nothing red within {PATIENCE} s.")


if __name__ == "__main__":
    main()
