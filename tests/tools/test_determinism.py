"""The same program gives the same recording, byte for byte."""

import hashlib
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from course_lib.recording import read_bag

PROGRAMS = Path(__file__).parents[1] / "programs"
PROCESSES, FORKS = 4, 5  # as much memory differs from process to process; its forks need no imports
SCRIPT = """
import os
import sys
from pathlib import Path
from course_lib.ros.standin_path import install
from course_lib.tools.run import run
install()
import rclpy.action, rclpy.node, sensor_msgs.msg, std_msgs.msg, tf2_ros, visualization_msgs.msg
folder, forks, *programs = sys.argv[1:]
for number in range(int(forks)):
    child = os.fork()
    if not child:
        for program in map(Path, programs):
            bag = Path(folder, str(number), program.stem)
            run([program], seconds=3.0, seed=1, bag=bag, args=(), real_time=False)
        break
    if os.waitpid(child, 0)[1]:
        sys.exit("a run failed")
"""


@pytest.mark.slow
def test_twenty_runs_of_each_program_give_one_digest_and_equal_bytes(tmp_path: Path) -> None:
    programs = sorted(PROGRAMS.glob("*.py"))
    digests: dict[str, str] = {}

    def run(number: int) -> list[dict[str, tuple[str, str]]]:
        folder = tmp_path / str(number)
        for fork in range(FORKS):
            (folder / str(fork)).mkdir(parents=True)
        command = [sys.executable, "-c", SCRIPT, str(folder), str(FORKS), *map(str, programs)]
        subprocess.run(command, env=os.environ | {"PYTHONHASHSEED": "0"}, check=True, capture_output=True)
        places = [folder / str(fork) for fork in range(FORKS)]
        return [{p.stem: _facts(place / p.stem, digests) for p in programs} for place in places]

    with ThreadPoolExecutor(2) as pool:
        runs = [facts for made in pool.map(run, range(PROCESSES)) for facts in made]
    assert len(runs) == 20
    assert len(runs[0]) == len(programs) > 6
    for program, facts in runs[0].items():
        assert {other[program] for other in runs} == {facts}, program


def _facts(bag: Path, digests: dict[str, str]) -> tuple[str, str]:
    """Return the digest of a recording and that of its bytes; equal bytes are read once."""
    data = hashlib.sha256((bag / "recording.mcap").read_bytes()).hexdigest()
    if data not in digests:
        recording = read_bag(bag)
        assert len(recording.samples) > 10
        digests[data] = recording.digest()
    return digests[data], data
