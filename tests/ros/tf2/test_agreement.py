"""The kit's tf2 buffer agrees with the C++ implementation of tf2."""

import json
import os
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from course_lib.ros.tf2 import BufferCore, Transform, TransformException
from tests.patience import PATIENCE
from tests.ros.tf2.random_trees import random_case

DEBIAN = "/usr/bin/python3"
CASES = 10_000


def _answers(case: dict[str, Any]) -> list[list[Any]]:
    core = BufferCore()
    for parent, child, stamp_ns, pose, is_static in case["transforms"]:
        transform = Transform(parent, child, stamp_ns, tuple(pose[:3]), tuple(pose[3:]))
        core.set_transform(transform, "me", is_static)
    return [_ask(core, query) for query in case["queries"]]


def _ask(core: BufferCore, query: list[Any]) -> list[Any]:
    full = len(query) > 3
    can = (core.can_transform_full if full else core.can_transform)(*query) is None
    try:
        found = (core.lookup_full if full else core.lookup)(*query)
    except TransformException as error:
        return [can, type(error).__name__, str(error)]
    return [can, found.stamp_ns, [*found.translation, *found.rotation]]


def _as_in_jazzy(text: str) -> str:
    """Convert an error text of Debian's ROS 1 to Jazzy's format: no span, six decimals, other name errors."""
    text = re.sub(r"extrapolation \S+s into", "extrapolation into", text)
    text = re.sub(r"(\d+\.\d{6})000", r"\1", text)
    bad_name = re.fullmatch(r"Invalid argument (?:(\".*\") )?passed to (.*?) in tf2 .*", text)
    if bad_name:
        name, argument = bad_name[1] or '""', bad_name[2]
        reason = "start with a '/'" if bad_name[1] else "be empty"
        return f"Invalid argument {name} passed to {argument} - in tf2 frame_ids cannot {reason}"
    return text


@pytest.fixture(scope="module")
def answered(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[Any, Any, Any]]:
    """Questions with the C++ answers and ours."""
    # A launch file that another test runs adds the stand-ins to this path.
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    imports = [DEBIAN, "-c", "import rospy, tf2_py"]
    there = (
        Path(DEBIAN).exists()
        and not subprocess.run(imports, check=False, env=environment, timeout=PATIENCE).returncode
    )
    if not there:
        pytest.skip("Debian's package python3-tf2-ros, with tf2's C++ buffer, is not installed")
    folder = tmp_path_factory.mktemp("tf2")
    chance = np.random.default_rng(4)
    cases = [random_case(chance) for _ in range(CASES)]
    (folder / "cases.json").write_text(json.dumps(cases))
    script = Path(__file__).with_name("debian_buffer.py")
    subprocess.run(
        [DEBIAN, script, folder / "cases.json", folder / "answers.json"],
        check=True,
        capture_output=True,
        env=environment,
        timeout=PATIENCE,
    )
    theirs = json.loads((folder / "answers.json").read_text())
    return [
        (query, their, our)
        for case, answers in zip(cases, theirs, strict=True)
        for query, their, our in zip(case["queries"], answers, _answers(case), strict=True)
    ]


@pytest.mark.slow
def test_exceptions_agree_with_ros_in_class_and_text(answered: list[tuple[Any, Any, Any]]) -> None:
    seen = set()
    for query, their, our in answered:
        assert their[0] == our[0], query
        if isinstance(their[1], str):
            assert [their[1], _as_in_jazzy(their[2])] == our[1:], query
            seen.add(their[1])
        else:
            assert isinstance(our[1], int), (query, our)
    names = {"Lookup", "Connectivity", "Extrapolation", "InvalidArgument"}
    assert seen == {f"{name}Exception" for name in names}


@pytest.mark.slow
def test_transforms_agree_with_ros_to_1e_9(answered: list[tuple[Any, Any, Any]]) -> None:
    found = [(their, our) for _, their, our in answered if isinstance(their[1], int)]
    assert len(found) > CASES
    assert [their[1] for their, _ in found] == [our[1] for _, our in found]
    theirs, ours = (np.array([answer[side][2] for answer in found]) for side in (0, 1))
    np.testing.assert_allclose(ours[:, :3], theirs[:, :3], atol=1e-9)
    # Both signs of a quaternion are the same rotation; Jazzy's conversion through a matrix selects
    # one.
    signs = np.sign(np.sum(ours[:, 3:] * theirs[:, 3:], axis=1))
    np.testing.assert_allclose(ours[:, 3:] * signs[:, None], theirs[:, 3:], atol=1e-9)
