"""Malformed messages, URDFs and launch files: no exception leaves a display, no traceback shows the kit.

    python -m tests.benchmarks.bench_malformed [MESSAGES [URDFS [LAUNCH_FILES]]]

The defaults are 100,000 messages over all displays, 20,000 URDFs and 5,000 launch files in Python,
XML and YAML. Each fault is printed, and the number of faults is the exit code.
"""

import sys
import time
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from course_lib.displays.registry import REGISTRY
from tests.displays.fuzzing import show_mutations, show_urdfs
from tests.ros.launch.fuzzing import run_mutations

DEFAULTS = (100_000, 20_000, 5_000)
BATCH = 1_000  # per session, whose robot time advances


def main() -> int:
    """Run all three; return the number of faults, at most 100."""
    given = [int(word) for word in sys.argv[1:]]
    messages, urdfs, launch_files = (*given, *DEFAULTS[len(given) :])
    with TemporaryDirectory() as folder:
        each = -(-messages // len(REGISTRY))
        faults = report("messages", each * len(REGISTRY), show_mutations(1, each, pictures=200))
        faults += report("URDFs", urdfs, in_batches(urdfs))
        faults += report("launch files", launch_files, run_mutations(1, launch_files, Path(folder)))
    return min(faults, 100)


def in_batches(count: int) -> Iterator[str]:
    """Display `count` URDFs in batches, each with its own seed."""
    for seed, start in enumerate(range(0, count, BATCH), start=1):
        yield from show_urdfs(seed, min(BATCH, count - start))


def report(what: str, count: int, faults: Iterator[str]) -> int:
    """Print the faults and a line about all of them; return how many there were."""
    start, found = time.perf_counter(), 0
    for fault in faults:
        found += 1
        print(f"--- {what}: {fault}", flush=True)
    print(f"{count} {what} in {time.perf_counter() - start:.0f} s, {found} faults", flush=True)
    return found


if __name__ == "__main__":
    sys.exit(main())
