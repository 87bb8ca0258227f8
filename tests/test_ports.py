from pathlib import Path

import pytest

from tests.ports import free_ports

OUTGOING = Path("/proc/sys/net/ipv4/ip_local_port_range")


def test_free_ports_differ() -> None:
    assert len(set(free_ports(100))) == 100


@pytest.mark.skipif(not OUTGOING.exists(), reason="the range is read from Linux's /proc")
def test_free_ports_are_outside_the_range_of_outgoing_connections() -> None:
    first, last = map(int, OUTGOING.read_text().split())
    assert [port for port in free_ports(100) if first <= port <= last] == []
