"""A scene that changes at 40 Hz for long: `python tests/benchmarks/bench_soak.py --minutes 30`.

Fails if the memory of either side, the page's elements or its GPU objects grow, or a message is
lost.
"""

import argparse
import sys
import time
from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields

import numpy as np
import psutil
from playwright.sync_api import CDPSession, Page

from course_lib.viewer.drawables import Lines, Mesh, Points, Solids, Text
from course_lib.viewer.page_server import PageServer
from course_lib.viewer.scene import Scene
from tests.browser.fake_host import chromium

OBJECTS, RATE = 200, 40  # moving, [Hz]
SAMPLES = 12
COUNT_GPU = """
globalThis.gpu = 0;
const gl = WebGL2RenderingContext.prototype;
for (const kind of ["Buffer", "Texture", "Program", "VertexArray", "Framebuffer"]) {
  const [make, remove] = [gl["create" + kind], gl["delete" + kind]];
  gl["create" + kind] = function () { gpu++; return make.call(this); };
  gl["delete" + kind] = function (it) { if (it) gpu--; return remove.call(this, it); };
}"""


@dataclass(frozen=True)
class Sample:
    """Figures that must not grow."""

    kernel_mb: float
    page_mb: float
    elements: float
    gpu_objects: float
    resyncs: float  # because of lost messages


def main() -> None:
    """Print samples, and fail if something grew by more than a tenth in the second half."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=30.0)
    minutes = parser.parse_args().minutes
    scene = Scene()
    server = PageServer(scene)
    resyncs = counted_resyncs(server)
    server.start()
    with chromium() as browser:
        page = browser.new_page(viewport={"width": 640, "height": 360})
        page.add_init_script(COUNT_GPU)
        page.goto(server.url)
        page.wait_for_selector("canvas")
        session = page.context.new_cdp_session(page)
        print("minutes " + "".join(f"{field.name:>14}" for field in fields(Sample)))
        samples = []
        for elapsed in changes(scene, 60 * minutes):
            samples.append(sample(page, session, resyncs))
            print(f"{elapsed / 60:7.1f} " + "".join(f"{v:14.1f}" for v in astuple(samples[-1])), flush=True)
        page.wait_for_timeout(1000)
        behind = server.link.number - max(p.number for p in server.link._flow.pages.values())
    server.close()
    print(f"{server.link.number} batches, the page is {behind} behind")
    sys.exit(verdict(samples))


def changes(scene: Scene, seconds: float) -> Iterator[float]:
    """Change everything that can change. Yield the time [s] regularly."""
    start, due = time.perf_counter(), 0.0
    for turn in range(int(seconds * RATE)):
        for number in range(OBJECTS):
            scene.set_transform(f"moving/{number}", at(number / 10 + turn / RATE))
        scene.set_object(f"moving/{turn % OBJECTS}", Solids("box", [np.eye(4) * 0.1], (1, 0, 0, 1)))
        scene.set_object("anew/text", Text(f"turn {turn}", 0.3))
        cloud = np.random.default_rng(turn).random((500, 3))
        scene.set_object("anew/points", Points(cloud, (0, 1, 0, 1), (0.02, 0.02)))
        scene.set_object("anew/mesh", Mesh(np.eye(3), None, (0, 0, 1, 1)))
        scene.set_object(f"trail/{turn % 50}", Lines(np.eye(3) * turn % 3, (1, 1, 0, 1)))
        if turn % 50 == 49:
            scene.delete("trail")
        elapsed = time.perf_counter() - start
        if elapsed >= due:
            due += seconds / SAMPLES
            yield elapsed
        time.sleep(max(0.0, start + (turn + 1) / RATE - time.perf_counter()))


def at(angle: float) -> np.ndarray:
    """Return a pose on a circle, shape (4, 4)."""
    transform_node_to_parent = np.eye(4)
    transform_node_to_parent[:2, 3] = 3 * np.cos(angle), 3 * np.sin(angle)  # [m]
    return transform_node_to_parent


def counted_resyncs(server: PageServer) -> list[str]:
    """Collect the times that a page has asked for the scene, as it had lost a message."""
    asked: list[str] = []
    server.link.listen("resync", lambda content: asked.append(str(content)))
    return asked


def sample(page: Page, session: CDPSession, resyncs: list[str]) -> Sample:
    """Measure both sides."""
    session.send("HeapProfiler.collectGarbage")
    heap = session.send("Runtime.getHeapUsage")["usedSize"]
    elements = session.send("Memory.getDOMCounters")["nodes"]
    kernel = psutil.Process().memory_info().rss
    return Sample(kernel / 1e6, heap / 1e6, elements, page.evaluate("gpu"), len(resyncs))


def verdict(samples: list[Sample]) -> str | int:
    """Compare the most in the third quarter with that in the last; the first half warms up.

    GPU objects come and go with what is drawn at the moment, so that two samples alone say little.
    """
    half = len(samples) // 2
    third, last = samples[half : half + half // 2], samples[half + half // 2 :]
    most = [[max(values) for values in zip(*map(astuple, part), strict=True)] for part in (third, last)]
    grown = [
        f"{field.name}: {before:.1f} -> {after:.1f}"
        for field, before, after in zip(fields(Sample), *most, strict=True)
        if after > before * 1.1 + 2
    ]
    lost = [f"{samples[-1].resyncs:.0f} resyncs"] if samples[-1].resyncs else []
    return "grew: " + ", ".join(grown + lost) if grown + lost else 0


if __name__ == "__main__":
    main()
