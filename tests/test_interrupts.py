import os
import subprocess
import sys

import pytest

from tests.checkout import ROOT

BEGUN_BEHIND_AMPERSAND = """\
import signal
signal.signal(signal.SIGINT, signal.SIG_IGN)  # as a shell without job control does for "command &"
import tests.conftest
print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)
"""


@pytest.mark.skipif(os.name != "posix", reason="only POSIX hands ignored signals on")
def test_what_tests_start_can_be_interrupted_although_they_run_in_the_background() -> None:
    command = (sys.executable, "-c", BEGUN_BEHIND_AMPERSAND)
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"
