"""100,000 hostile streams into the evidence parser and the judge: no exception escapes, memory stays flat.

The streams are made here and swallowed in a process of its own, whose memory hypothesis has no part in.
"""

import gc
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from hypothesis import HealthCheck, given, settings

sys.path.insert(0, str(Path(__file__).parents[2]))

from course_lib.ros.standin_path import install
from tests.hostile.fuzzing import streams, swallow

install()  # here and in the process that swallows

EXAMPLES = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
BATCH = 500
WARM_UP = 5  # batches, until every import and every cache of bounded size is there


def swallow_all(batch: list[bytes]) -> float:
    """Swallow streams; returns the memory [MB] that this process has then."""
    for stream in batch:
        swallow(stream)
    gc.collect()
    status = Path("/proc/self/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


if __name__ == "__main__":
    batch: list[bytes] = []
    memory: list[float] = []
    start = time.perf_counter()
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:

        @settings(
            max_examples=EXAMPLES, deadline=None, suppress_health_check=list(HealthCheck), database=None
        )
        @given(streams)
        def fuzz(stream: bytes) -> None:
            batch.append(stream)
            if len(batch) == BATCH:
                memory.append(pool.submit(swallow_all, batch).result())
                batch.clear()

        fuzz()
        memory.append(pool.submit(swallow_all, batch).result())
    seconds = time.perf_counter() - start
    after = memory[min(WARM_UP, len(memory) - 1)]
    print(
        f"{EXAMPLES} streams in {seconds:.0f} s, none escaped; {after:.1f} MB after {WARM_UP * BATCH}, "
        f"{memory[-1]:.1f} MB at the end, {max(memory):.1f} MB at most"
    )
