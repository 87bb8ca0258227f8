"""DDS domains for the links of tests.

Workers of pytest-xdist run at the same time, so each has domains of its own, outside of those that
`course run --ros` chooses from. Another run of the tests on this computer has the same ones, and
its robot would be listed in this one: a domain is taken only if it has no participant.
"""

import itertools
import os
import socket

from course_lib.real.process import PORT, PORTS_OF_A_DOMAIN

WORKERS = 5
WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")) % WORKERS


class Domains:
    """Domains without participants, of a range that the workers share.

    Args:
        first: The first domain of the range.
        count: The number of domains of each worker.
    """

    def __init__(self, first: int, count: int) -> None:
        own = range(first + count * WORKER, first + count * (WORKER + 1))
        self._own, self._following = own, itertools.cycle(own)

    def next(self) -> int:
        """Return another domain without participants."""
        for domain in itertools.islice(self._following, len(self._own)):
            if is_free(domain):
                return domain
        raise AssertionError(f"Other programs use all DDS domains of {self._own}.")


def is_free(domain: int) -> bool:
    """Return whether no participant of this computer has the first port of a domain."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("", PORT + PORTS_OF_A_DOMAIN * domain))
        except OSError:
            return False
        return True
