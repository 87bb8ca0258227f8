from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.recording import bag_info
from course_lib.tools.run import ros2_over

Run = Callable[[str], str]


@pytest.mark.parametrize("options", ["", "-v", "-t -v"])
def test_info_output_equals_rosbag2_output(bag: Path, run: Run, options: str) -> None:
    text = bag_info(bag, digest=False)
    assert run(f"info five {options}").endswith(text)
    assert "Digest" not in text


def test_info_option_lists_only_topic_names(bag: Path, run: Run) -> None:
    assert run("info -t five") == "/a\n/b\n"


def test_info_requires_neither_a_program_nor_a_recording(
    bag: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert ros2_over(["bag", "info", str(bag)], files=[], bag=None, seconds=1.0) == 0
    assert capsys.readouterr().out == bag_info(bag, digest=False)


def test_path_that_is_not_a_bag_is_rejected(run: Run, tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="Bag path 'x' does not exist!"):
        run("info x")
    with pytest.raises(CourseError, match="is a folder but not a bag"):
        run(f"info {tmp_path}")
