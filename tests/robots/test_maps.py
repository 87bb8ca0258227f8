"""Map files, and nav2's nodes that load, save and manage them."""

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from nav_msgs.msg import OccupancyGrid
from PIL import Image

from course_lib.robots.nav2 import MapImageError, MapYamlError, read_map, write_map
from tests.ros.launch.run import recorded

YAML = {
    "image": "hall.pgm",
    "resolution": "0.05",
    "origin": "[-1.0, -2.0, 0.0]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}
# Free, occupied and unknown as nav2_map_server saves them; the first row of an image is the upper
# one.
GRAY = np.array([[254, 0, 205], [254, 254, 254]], np.uint8)


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Write a map whose YAML file differs from YAML by some keys, None for a missing one."""

    def write(gray: Any = GRAY, name: str = "hall.pgm", **changes: str | None) -> Path:
        Image.fromarray(gray).save(tmp_path / name)
        content = {**YAML, "image": name, **changes}
        file = tmp_path / "hall.yaml"
        file.write_text("".join(f"{k}: {v}\n" for k, v in content.items() if v is not None))
        return file

    return write


def cells(grid: OccupancyGrid) -> list[list[int]]:
    return np.array(grid.data).reshape(grid.info.height, grid.info.width).tolist()


def test_map_has_the_cells_and_the_pose_of_its_files(write: Callable[..., Path]) -> None:
    grid = read_map(write(origin="[-1, -2, 1.5707963]"))
    assert cells(grid) == [[0, 0, 0], [0, 100, -1]]
    assert grid.info.resolution == pytest.approx(0.05)
    assert grid.info.origin.position.x == -1.0
    assert grid.info.origin.orientation.z == pytest.approx(0.7071068)


@pytest.mark.parametrize(
    ("gray", "name", "changes", "expected"),
    [
        ([[0, 254, 128]], "m.pgm", {"mode": "scale"}, [[100, 0, 67]]),
        ([[0, 100, 101]], "m.pgm", {"mode": "raw"}, [[0, 100, -1]]),
        ([[0, 254, 205]], "m.pgm", {"negate": "1"}, [[0, 100, 100]]),
        ([[0, 254, 205]], "m.bmp", {"negate": "false"}, [[100, 0, -1]]),
        ([[0, 65535, 52685]], "m.png", {}, [[100, 0, -1]]),
        ([[[0, 0, 0, 255], [254, 254, 254, 255], [0, 0, 0, 0]]], "m.png", {}, [[100, 0, -1]]),
        ([[0, 254, 205]], "m.pgm", {"resolution": "5e-2"}, [[100, 0, -1]]),
    ],
)
def test_modes_and_image_formats_have_the_cells_of_nav2(
    write: Callable[..., Path], gray: Any, name: str, changes: dict[str, str], expected: Any
) -> None:
    array = np.array(gray, np.uint16 if np.max(gray) > 255 else np.uint8)
    assert cells(read_map(write(array, name, **changes))) == expected


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"origin": "[1, 2]"}, "origin: [1, 2], expected [x, y, yaw] in m and rad."),
        ({"origin": "[1, 2, east]"}, "origin: 'east', expected a number."),
        ({"resolution": None}, "the key 'resolution' is missing."),
        ({"resolution": "0"}, "resolution: 0.0, expected the size of a cell in m, > 0."),
        ({"occupied_thresh": "much"}, "occupied_thresh: 'much', expected a number."),
        ({"image": "3"}, "image: 3, expected the name of an image file."),
        ({"mode": "ternary"}, "mode: 'ternary', expected trinary, scale or raw."),
        ({"negate": "[a"}, "not YAML: while parsing a flow sequence"),
    ],
)
def test_malformed_map_yaml_is_rejected_with_its_key(
    write: Callable[..., Path], changes: dict[str, str | None], text: str
) -> None:
    file = write(**changes)
    with pytest.raises(MapYamlError) as caught:
        read_map(file)
    assert str(caught.value).startswith(f"{file}: {text}")


@pytest.mark.parametrize("content", [b"", b"P5\n3 2\n255\n\xff", b"P5 -1 9 255\n", b"P6", b"not a map"])
def test_malformed_map_image_is_rejected_with_its_path(write: Callable[..., Path], content: bytes) -> None:
    file = write()
    image = file.with_name("hall.pgm")
    image.write_bytes(content)
    with pytest.raises(MapImageError) as caught:
        read_map(file)
    assert str(caught.value).startswith(f"{image}: not an image of a map: ")


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("/home/ann/maps/hall.pgm", "It is next to hall.yaml: write image: hall.pgm"),
        ("room.pgm", "Write the name of an image next to hall.yaml."),
    ],
)
def test_missing_map_image_is_rejected_with_the_image_next_to_the_map(
    write: Callable[..., Path], name: str, advice: str
) -> None:
    file = write(image=name)
    with pytest.raises(MapImageError) as caught:
        read_map(file)
    assert str(caught.value) == f"{file}: image: {file.parent / name} does not exist. {advice}"


@pytest.mark.parametrize("mode", ["trinary", "scale", "raw"])
def test_saved_map_is_read_with_equal_cells(write: Callable[..., Path], tmp_path: Path, mode: str) -> None:
    grid = read_map(write())
    image, file = write_map(grid, str(tmp_path / "saved"), mode=mode, image_format="png")
    assert image.name == "saved.png"
    again = read_map(file)
    assert (cells(again), again.info.origin) == (cells(grid), grid.info.origin)


def test_full_disk_leaves_the_saved_map_unchanged(
    write: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    grid = read_map(write())
    name = str(tmp_path / "saved")
    contents = {file: file.read_bytes() for file in write_map(grid, name)}
    write_bytes = Path.write_bytes

    def write_until_full(path: Path, data: bytes) -> int:
        write_bytes(path, data[:9])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", write_until_full)
    grid.data[0] = 100
    with pytest.raises(OSError, match="No space left"):
        write_map(grid, name)
    assert {file: file.read_bytes() for file in contents} == contents
    assert not list(tmp_path.glob(".*"))


LAUNCH = """
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        Node(package="nav2_map_server", executable="map_server", name="map_server",
             parameters=[{"yaml_filename": "FILE", "frame_id": "hall"}]),
        Node(package="nav2_amcl", executable="amcl", name="amcl"),
        Node(package="nav2_lifecycle_manager", executable="lifecycle_manager", name="manager",
             parameters=[{"autostart": True, "node_names": ["map_server", "amcl"]}]),
        Node(package="nav2_map_server", executable="map_saver_cli", arguments=["-f", "FOLDER/copy"]),
    ])
"""


@pytest.fixture
def launch(tmp_path: Path) -> Callable[[Path], Path]:
    """Write a launch file with the map server, the saver and the lifecycle manager of nav2."""

    def write(yaml_file: Path) -> Path:
        file = tmp_path / "map.launch.py"
        file.write_text(LAUNCH.replace("FILE", str(yaml_file)).replace("FOLDER", str(tmp_path)))
        return file

    return write


def test_launched_map_server_publishes_and_the_saver_copies_the_map(
    write: Callable[..., Path],
    launch: Callable[[Path], Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    recording, code = recorded(launch(write()))
    assert code == 0
    ((_, message),) = recording.messages("/map")
    grid = cast("OccupancyGrid", message)
    assert (grid.header.frame_id, cells(grid)) == ("hall", [[0, 0, 0], [0, 100, -1]])
    assert (tmp_path / "copy.pgm").read_bytes() == (tmp_path / "hall.pgm").read_bytes()
    output = "".join(capsys.readouterr())
    assert "'amcl' cannot run here: the other nodes are managed without it." in output
    assert "[manager]: Managed nodes are active" in output


def test_map_server_without_its_file_stays_unconfigured_and_logs_the_reason(
    launch: Callable[[Path], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = tmp_path / "none.yaml"
    recorded(launch(missing), seconds=3.0)
    output = "".join(capsys.readouterr())
    assert f"for reason: {missing}: not readable: No such file or directory." in output
    assert "[manager]: Failed to change state for node: map_server" in output
    assert "No map was published on 'map' within 2.0 s." in output
