"""rosbag2_py: the options of writers, and the errors for unsupported ones."""

from pathlib import Path
from typing import Any

import pytest
import rosbag2_py
from rclpy.serialization import serialize_message
from std_msgs.msg import String

from tests.ros.test_rosbag2_py import NO_CONVERSION, reader_of, rest, topic


def filled(folder: Path, *, writer: rosbag2_py.SequentialWriter | None = None, **options: Any) -> str:
    """Write messages 0 to 9 at 100 to 109 ns with these options. Return the contents of the bag."""
    writer = writer or rosbag2_py.SequentialWriter()
    writer.open(rosbag2_py.StorageOptions(uri=str(folder), **options), NO_CONVERSION)
    writer.create_topic(topic("/a"))
    for number in range(10):
        writer.write("/a", serialize_message(String(data=str(number))), 100 + number)
        if options.get("snapshot_mode") and number == 7:
            assert writer.take_snapshot()
    writer.close()
    return rest(reader_of(folder))


SIZE = len(serialize_message(String(data="0")))


@pytest.mark.parametrize(
    ("options", "digits"),
    [
        ({"start_time_ns": 103, "end_time_ns": 105}, "345"),
        ({"snapshot_mode": True, "max_cache_size": 3 * SIZE}, "567"),
        ({"storage_preset_profile": "zstd_small"}, "0123456789"),
        ({"storage_id": "sqlite3", "storage_preset_profile": "resilient"}, "0123456789"),
    ],
)
def test_writer_options_select_the_written_messages(
    tmp_path: Path, options: dict[str, Any], digits: str
) -> None:
    assert filled(tmp_path / "bag", **options) == digits


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize("mode", ["FILE", "MESSAGE"])
def test_compressed_bag_survives_a_round_trip(tmp_path: Path, storage: str, mode: str) -> None:
    chosen = rosbag2_py.compression_mode_from_string(mode.lower())
    writer = rosbag2_py.SequentialCompressionWriter(rosbag2_py.CompressionOptions("zstd", chosen))
    assert filled(tmp_path / "bag", writer=writer, storage_id=storage) == "0123456789"
    about = rosbag2_py.Info().read_metadata(str(tmp_path / "bag"), storage)
    assert (about.compression_format, about.compression_mode) == ("zstd", mode.lower())


def test_custom_data_are_stored_in_the_metadata(tmp_path: Path) -> None:
    filled(tmp_path / "bag", custom_data={"robot": "ten"})
    assert rosbag2_py.Info().read_metadata(str(tmp_path / "bag"), "mcap").custom_data == {"robot": "ten"}


def test_bag_splitting_option_prints_a_notice_that_the_bag_is_one_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert filled(tmp_path / "bag", max_bagfile_size=10) == "0123456789"
    assert capsys.readouterr().out == "A bag of the kit is one file. max_bagfile_size=10 changes nothing.\n"


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"snapshot_mode": True}, "Max cache size must be greater than 0 when snapshot mode is enabled"),
        ({"storage_preset_profile": "fast"}, r"unknown storage preset profile \(valid options are none, "),
        ({"storage_config_uri": "mcap.yaml"}, "The kit reads no storage_config_uri"),
    ],
)
def test_unsupported_option_is_rejected(tmp_path: Path, options: dict[str, Any], text: str) -> None:
    with pytest.raises(RuntimeError, match=text):
        filled(tmp_path / "bag", **options)
    assert not (tmp_path / "bag").exists()


@pytest.mark.parametrize(
    ("use", "text"),
    [
        (rosbag2_py.Player, r"The kit has no rosbag2_py\.Player\. Instead: ros2 bag play"),
        (rosbag2_py.RecordOptions, r"no rosbag2_py\.RecordOptions\. Instead: ros2 bag record"),
        (rosbag2_py.bag_rewrite, "Instead: SequentialReader and SequentialWriter"),
        (lambda: rosbag2_py.CompressionOptions("lz4", rosbag2_py.CompressionMode.FILE).checked(), "zstd"),
        (lambda: rosbag2_py.compression_mode_from_string("x"), "Choose NONE, FILE or MESSAGE"),
        (
            lambda: rosbag2_py.SequentialCompressionWriter(rosbag2_py.CompressionOptions()),
            "requires a CompressionMode that is not NONE!",
        ),
    ],
)
def test_unsupported_feature_is_rejected_with_an_alternative(use: Any, text: str) -> None:
    with pytest.raises(RuntimeError, match=text):
        use()
