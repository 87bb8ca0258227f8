"""Routers that are killed and started again 20 times each: `python tests/benchmarks/bench_restarts.py`.

A student's viewer must show a new marker, and a late subscription the robot's old map, after each.
It fails where one does not come back, and where a kit does not end.
"""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))
TIMES = 20

from course_lib.ros.programs import import_path  # noqa: E402  # finds the checkout

import_path.install()

from tests.gateway.test_restarts import Gateways, View, restarted  # noqa: E402
from tests.ros.zenoh.conftest import Routers  # noqa: E402

Killed = tuple[View, Routers | Gateways]


@contextmanager
def chain(direct: bool, kills_gateway: bool) -> Iterator[Killed]:
    """Run a robot, its router and a student's kit. Yield the processes to kill."""
    routers = Routers()
    place = f"tcp/127.0.0.1:{routers.port}"
    with TemporaryDirectory() as folder:
        gateways = None if direct else Gateways(Path(folder), place)
        view = View(place, gateways.address if gateways else place)
        view.comes_back()
        yield view, gateways if gateways and kills_gateway else routers
        view.close()
        if gateways:
            gateways.kill()
    routers.kill()


def main() -> None:
    """Print a row for each way."""
    for name, direct, kills_gateway in (
        ("direct, router", True, False),
        ("gateway, robot's router", False, False),
        ("gateway, itself", False, True),
    ):
        begun = time.monotonic()
        with chain(direct, kills_gateway) as (view, killed):
            times = sorted(restarted(view, killed, TIMES))
        half, most = times[len(times) // 2], times[-1]
        seconds = time.monotonic() - begun
        back = f"{len(times)} of {TIMES} came back, p50 {half:.1f} s, most {most:.1f} s"
        print(f"{name:24} {back}, in {seconds:.0f} s")


if __name__ == "__main__":
    main()
