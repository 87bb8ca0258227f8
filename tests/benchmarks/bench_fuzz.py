"""100,000 hostile streams into the evidence parser and the judge: no exception escapes, memory stays flat."""

import resource
import sys
import time
from pathlib import Path

from hypothesis import HealthCheck, given, settings

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.hostile.fuzzing import streams, swallow

EXAMPLES = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000


def peak_megabytes() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


@settings(max_examples=EXAMPLES, deadline=None, suppress_health_check=list(HealthCheck), database=None)
@given(streams)
def fuzz(stream: bytes) -> None:
    swallow(stream)


if __name__ == "__main__":
    swallow(b"")
    before, start = peak_megabytes(), time.perf_counter()
    fuzz()
    seconds, grown = time.perf_counter() - start, peak_megabytes() - before
    print(f"{EXAMPLES} streams in {seconds:.0f} s, none escaped; the peak of memory grew by {grown:.0f} MB")
