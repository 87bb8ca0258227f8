"""A limit of processor time for a block of code, as what strangers send may be slow to look at."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

AGAIN = 1.0  # [s] of processor time: code that swallows the exception gets another one


class _OverError(BaseException):
    """The end of a time limit; no `except Exception` catches it."""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Bound the processor time of a block; for the main thread of a process.

    Raises:
        TimeoutError: The block took more than so many seconds.
    """

    def ring(*_: Any) -> None:
        raise _OverError

    if not hasattr(signal, "setitimer"):  # Windows, where nothing of a stranger's is judged
        yield
        return
    before = signal.signal(signal.SIGPROF, ring)
    try:
        signal.setitimer(signal.ITIMER_PROF, seconds, AGAIN)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
    except _OverError:
        raise TimeoutError(f"it takes more than {seconds:.3g} s") from None
    finally:
        signal.signal(signal.SIGPROF, before)
