import signal
from pathlib import Path

import pytest

from tests.patience import PATIENCE
from tests.ros.dds.actions import CLIENT, EXPECTED, SERVER
from tests.ros.zenoh.test_connecting import course


@pytest.mark.slow
def test_action_server_of_one_kit_executes_the_goals_of_another(router: str, tmp_path: Path) -> None:
    (tmp_path / "server.py").write_text(SERVER)
    (tmp_path / "client.py").write_text(CLIENT)
    link = ("--robot", router, "--call", "/fib")
    server = course("run", str(tmp_path / "server.py"), *link)
    try:
        assert server.read_line() == "up\n"
        client = course("run", str(tmp_path / "client.py"), *link)
        output = client.communicate(timeout=PATIENCE)
    finally:
        server.send_signal(signal.SIGINT)
        server.communicate(timeout=PATIENCE)
    assert output == (EXPECTED, "")
