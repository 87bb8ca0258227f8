import os
import subprocess
import sys

import pytest

from tests.checkout import ROOT
from tests.patience import PATIENCE

BEGUN_BEHIND_AMPERSAND = """\
import signal
signal.signal(signal.SIGINT, signal.SIG_IGN)  # as a shell without job control does for "command &"
import tests.conftest
print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="only POSIX hands ignored signals on")
def test_background_test_processes_can_be_interrupted() -> None:
    command = (sys.executable, "-c", BEGUN_BEHIND_AMPERSAND)
    process = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, timeout=PATIENCE)
    assert process.stdout == "True\n"
