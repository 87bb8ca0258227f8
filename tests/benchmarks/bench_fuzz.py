"""100,000 judgements, inputs of parsers and hand-ins: no exception escapes, and no hand-in has a wrong owner.

    python tests/benchmarks/bench_fuzz.py [JUDGEMENTS [INPUTS [HAND_INS]]]

Half of the judgements are every word of the vocabulary over made-up evidence, half are the course's
own checks over what its solutions published and returned, spoilt. A fifth of the inputs are streams
of a hostile process, swallowed, stored and judged; two fifths are spoilt notebooks, layouts,
parameters and evidence, two fifths zips and tables of platforms, class lists, records, requests and
course.toml.
"""

import gc
import random
import sys
import time
import warnings
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from hypothesis import HealthCheck, given, settings

sys.path.insert(0, str(Path(__file__).parents[2]))

from course_lib.ros.programs.import_path import install
from tests.hostile.fuzzing import streams, swallow
from tests.hostile.hand_ins import collect_class, read_class
from tests.hostile.judging import course_over, right_runs, words_over
from tests.hostile.parsing import STAFFS, STUDENTS, parse_any

JUDGEMENTS = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
INPUTS = int(sys.argv[2]) if len(sys.argv) > 2 else 100_000
HAND_INS = int(sys.argv[3]) if len(sys.argv) > 3 else 100_000
ROUNDS = 50
BATCH, WARM_UP = 500, 5  # streams; batches, until every import and every cache of bounded size is there


def until(count: int, judge: Callable[[int], int]) -> int:
    """Judge so often at least; `judge` gets a seed and returns how often it judged."""
    done = seed = 0
    while done < count:
        done += judge(seed)
        seed += 1
    return done


def memory() -> float:
    """Return the memory of this process [MB]."""
    return int(Path("/proc/self/status").read_text().split("VmRSS:")[1].split()[0]) / 1024


def swallow_all(batch: list[bytes]) -> float:
    """Swallow streams; returns the memory that this process holds then, [MB]."""
    install()
    for stream in batch:
        swallow(stream)
    gc.collect()
    return memory()


def swallow_streams(count: int) -> list[float]:
    """Read streams in a separate process. Return its memory [MB]."""
    batch: list[bytes] = []
    held: list[float] = []
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:

        @settings(max_examples=count, deadline=None, suppress_health_check=list(HealthCheck), database=None)
        @given(streams)
        def fuzz(stream: bytes) -> None:
            batch.append(stream)
            if len(batch) == BATCH:
                held.append(pool.submit(swallow_all, batch).result())
                batch.clear()

        fuzz()
        held.append(pool.submit(swallow_all, batch).result())
    return held


def hand_ins(count: int) -> str:
    """Read and collect submissions with file names that students chose; a fifth of them are archives."""
    start, chance, names, archives = time.perf_counter(), random.Random(1), 0, 0
    while names < count * 4 // 5:
        names += read_class(chance)
    while archives < count // 5:
        archives += collect_class(chance)
    took = time.perf_counter() - start
    return f"{names} names and {archives} collected hand-ins in {took:.0f} s, none with a wrong owner or time"


def main() -> None:
    install()
    if HAND_INS:
        print(hand_ins(HAND_INS))
    if not JUDGEMENTS and not INPUTS:
        return
    warnings.simplefilter("ignore", RuntimeWarning)  # numpy's, over infinite numbers
    start = time.perf_counter()
    words = until(JUDGEMENTS // 2, lambda seed: words_over(random.Random(seed), ROUNDS))
    before = memory()
    runs = right_runs()
    course = until(JUDGEMENTS // 2, lambda seed: course_over(random.Random(seed), runs, ROUNDS))
    took = time.perf_counter() - start
    print(
        f"{words + course} judgements in {took:.0f} s, none raised; {before:.0f} MB, then {memory():.0f} MB"
    )
    if not INPUTS:
        return
    start, slowest = time.perf_counter(), 0.0
    chance = random.Random(0)
    for number in range(INPUTS * 4 // 5):
        slowest = max(slowest, parse_any(chance, (STUDENTS, STAFFS)[number % 2]))
    took, holds = time.perf_counter() - start, memory()
    print(f"{INPUTS * 4 // 5} files in {took:.0f} s, the slowest {slowest:.2f} s of CPU; {holds:.0f} MB")
    held = swallow_streams(INPUTS // 5)
    print(f"{INPUTS} inputs in {time.perf_counter() - start:.0f} s, none escaped")
    first = held[min(WARM_UP, len(held) - 1)]
    print(f"streams: {first:.0f} MB, and {held[-1]:.0f} MB at last")


if __name__ == "__main__":
    main()
