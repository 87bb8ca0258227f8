"""The frozen outcomes of probes and small programs, against the real rclpy itself."""

import os
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.real_ros.renew import AT_ONCE, frozen_outcomes, outcomes_after_interrupt, outcomes_of_probes

HERE = Path(__file__).parent
PYTHON = os.environ.get("REAL_ROS_PYTHON", "")
FILES = sorted(file.stem for file in (HERE / "probes").glob("*.py") if file.stem != "probing")
PROGRAMS = sorted(file.stem for file in (HERE / "programs").glob("*.py"))
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON, reason="REAL_ROS_PYTHON names no Python with the real rclpy"),
]


Running = dict[str, Future[dict[str, str]]]


@pytest.fixture(scope="module")
def running(request: pytest.FixtureRequest) -> Iterator[Running]:
    """The outcomes of the selected files, of which several run at a time: most probes wait."""
    selected = [item.name.partition("[")[2].rstrip("]") for item in request.session.items]
    with ThreadPoolExecutor(AT_ONCE) as threads:
        yield {
            file: threads.submit(outcomes_of_probes, PYTHON, HERE / "probes" / f"{file}.py")
            for file in FILES
            if file in selected
        }


@pytest.mark.parametrize("file", FILES)
def test_real_rclpy_gives_the_frozen_outcomes(file: str, running: Running) -> None:
    frozen, outcomes = frozen_outcomes(file), running[file].result()
    assert outcomes.keys() == frozen.keys()
    different = {name for name in frozen if outcomes[name] != frozen[name]}
    # Probes that measure times may fail while other files run, so they get a second run.
    again = outcomes_of_probes(PYTHON, HERE / "probes" / f"{file}.py") if different else {}
    assert {name: again[name] for name in different if again[name] != frozen[name]} == {}


def test_real_rclpy_ends_programs_as_in_the_frozen_outcomes() -> None:
    frozen = frozen_outcomes("programs")
    different: dict[str, object] = dict.fromkeys(PROGRAMS)
    # How far a program is when the interrupt arrives varies, so the real rclpy gets three runs.
    for _ in range(3):
        outcomes = outcomes_after_interrupt(PYTHON, (HERE / "programs" / f"{name}.py" for name in different))
        different = {name: outcomes[name] for name in different if outcomes[name] != frozen[name]}
    assert different == {}
