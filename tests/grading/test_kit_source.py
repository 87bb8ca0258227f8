"""The kit in an autograder, by the way in which it was installed."""

import json
import re
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.grading.platforms.gradescope import kit_source

COMMIT = "0123456789abcdef0123456789abcdef01234567"


def installed(folder: Path, direct: dict[str, Any] | None) -> metadata.Distribution:
    """Return the kit as it is found in site-packages, version 9.8."""
    folder = folder / "course_lib-9.8.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: course-lib\nVersion: 9.8\n")
    if direct is not None:
        (folder / "direct_url.json").write_text(json.dumps(direct))
    return metadata.PathDistribution(folder)


@pytest.mark.parametrize(
    ("direct", "words"),
    [
        (None, "course-lib==9.8"),
        (
            {"url": "https://git.example/kit.git", "vcs_info": {"vcs": "git", "commit_id": COMMIT}},
            f"'course-lib @ git+https://git.example/kit.git@{COMMIT}'",
        ),
        (
            {"url": "https://x.example/kit.whl?a='b';c", "archive_info": {}},
            """'course-lib @ https://x.example/kit.whl?a='"'"'b'"'"';c'""",
        ),
    ],
    ids=["index", "repository", "address"],
)
def test_kit_from_a_public_origin_is_required_by_version(
    tmp_path: Path, direct: dict[str, Any] | None, words: str
) -> None:
    source = kit_source(installed(tmp_path, direct))
    assert (source.pip_arguments, source.files) == (words, {})


def test_local_wheel_of_the_kit_is_included(tmp_path: Path) -> None:
    wheel = tmp_path / "the wheels" / "course_lib-9.8-py3-none-any.whl"
    wheel.parent.mkdir()
    wheel.write_bytes(b"PK")
    source = kit_source(installed(tmp_path, {"url": wheel.as_uri(), "archive_info": {}}))
    assert source.pip_arguments == f'"$root/source/kit/{wheel.name}"'
    assert source.files == {f"kit/{wheel.name}": b"PK"}


def test_checkout_of_the_kit_is_included_without_answers(tmp_path: Path) -> None:
    checkout = Path(__file__).parents[2]
    direct = {"url": checkout.as_uri(), "dir_info": {"editable": True}}
    source = kit_source(installed(tmp_path, direct))
    assert source.pip_arguments == '-e "$root/source/kit"'
    assert {"kit/pyproject.toml", "kit/course_lib/__init__.py"} <= source.files.keys()
    assert not [name for name in source.files if name.startswith(("kit/solutions", "kit/tests"))]


def test_missing_kit_source_files_are_reported(tmp_path: Path) -> None:
    gone = installed(tmp_path, {"url": (tmp_path / "gone").as_uri(), "dir_info": {}})
    with pytest.raises(
        CourseError, match=re.escape(f"from {(tmp_path / 'gone').as_uri()}, which no longer exists")
    ):
        kit_source(gone)
