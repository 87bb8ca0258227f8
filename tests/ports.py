"""Free ports for the servers of tests.

A port that the system chooses (port 0) is in the range from which it takes ports for outgoing
connections. Such a connection of another test can take it before its server listens on it, or while
a server is restarted. So these ports lie below that range, which begins at 32768 on Linux.
"""

import random
import socket
from contextlib import suppress

PORTS = range(20_000, 32_000)
# Not the generator of the module `random`, which hypothesis seeds equally in all workers.
_random = random.SystemRandom()


def free_ports(count: int) -> list[int]:
    """Return different ports of this machine on which nothing listens."""
    ports: list[int] = []
    for port in _random.sample(PORTS, len(PORTS)):
        if len(ports) == count:
            break
        with suppress(OSError), socket.socket() as probe:
            probe.bind(("127.0.0.1", port))
            ports.append(port)
    return ports


def free_port() -> int:
    """Return a port of this machine on which nothing listens."""
    (port,) = free_ports(1)
    return port
