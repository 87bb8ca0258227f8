"""The report agrees with `ros2 topic hz`, `bw` and `delay`, and lists blocking callbacks."""

import re
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Image, PointCloud2
from std_msgs.msg import String

from course_lib import performance_report
from course_lib.errors import CourseError
from course_lib.recording import record, write_bag
from course_lib.ros.graph.graph import Graph, Sample, use_graph
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import RosMessage, serialize, type_name
from course_lib.ros.time import virtual_time
from course_lib.ros.time.driving import running_nodes, spin_for
from course_lib.tools.performance import PerformanceReport, header_stamp
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    monkeypatch.setenv("COURSE_PACE", "fast")
    virtual_time.install()
    with use_graph(Graph(notebook=True)) as graph:
        rclpy.init()
        yield graph


class Camera(Node):
    """Ten images a second."""

    def __init__(self) -> None:
        super().__init__("camera")
        self._images = self.create_publisher(Image, "/image", 10)
        self.create_timer(0.1, self._take)

    def _take(self) -> None:
        image = Image(data=bytes(1000))
        image.header.stamp = self.get_clock().now().to_msg()
        self._images.publish(image)


class Detector(Node):
    """A node that works 80 ms per image, and on a timer four times a second."""

    def __init__(self) -> None:
        super().__init__("detector")
        self._detections = self.create_publisher(PointCloud2, "/detections", 10)
        self._words = self.create_publisher(String, "/words", 10)
        self.create_subscription(Image, "/image", self._detect, 10)
        self.create_timer(0.25, lambda: self._words.publish(String(data="alive")))

    def _detect(self, image: Image) -> None:
        time.sleep(0.08)
        self._detections.publish(PointCloud2(header=image.header))


def measured(seconds: float = 2.0) -> PerformanceReport:
    return performance_report(seconds, Camera(), Detector())


def test_report_without_messages_and_callbacks_asks_for_a_running_node(graph: Graph) -> None:
    report = performance_report(2.0, Node("idle"))
    line = "No topic had a message and no callback ran in 2 s of robot time: does a node run?"
    assert repr(report).strip() == line
    assert report._repr_html_() == f"<p>{line}</p>"


def test_topics_have_rates_sizes_and_latencies(graph: Graph) -> None:
    report = measured()
    rows = {row.topic: row for row in report.topics}
    assert list(rows) == ["/detections", "/image", "/words"]
    assert rows["/image"].rate == pytest.approx(10.0)
    assert rows["/image"].latency == pytest.approx(0.001)  # delivery
    assert rows["/detections"].latency == pytest.approx(0.001 + 0.08 + 0.001)
    assert rows["/words"].latency is None
    assert rows["/image"].jitter == pytest.approx(0.0, abs=1e-9)
    size = len(serialize(Image(data=bytes(1000))))
    assert rows["/image"].size == size
    assert rows["/image"].bandwidth == pytest.approx(10 * size)


def test_rates_and_delays_agree_with_the_command_line(graph: Graph) -> None:
    report = measured(3.0)
    running_nodes().extend([Camera(), Detector()])
    for row in report.topics:
        for verb, number in (("hz", row.rate), ("delay", row.latency)):
            if number is None:
                continue
            output: list[str] = []
            ros2(["topic", verb, row.topic], GraphSource(graph), output.append)
            said = re.findall(r"average (?:rate|delay): ([\d.]+)", "".join(output))
            assert float(said[-1]) == pytest.approx(number, rel=0.01)


def test_slow_callback_is_reported_with_delayed_callbacks(graph: Graph) -> None:
    report = measured(2.05)
    rows = {(row.node, row.callback): row for row in report.callbacks}
    assert set(rows) == {
        ("/camera", "timer 0.1 s"),
        ("/detector", "/image"),
        ("/detector", "timer 0.25 s"),
    }
    slow, held_up = rows["/detector", "/image"], rows["/detector", "timer 0.25 s"]
    assert slow.calls == 20
    assert slow.longest == pytest.approx(0.08)
    assert slow.busy == pytest.approx(0.08 * 20 / 2.05, abs=0.02)
    assert held_up.longest_wait == pytest.approx(0.031)  # due at 0.25 s, free at 0.201 + 0.08 s
    assert 0 < slow.load < 1
    assert report.busy == {"/camera": 0.0, "/detector": pytest.approx(slow.busy)}


def test_all_figures_except_the_processor_load_are_in_robot_time(graph: Graph) -> None:
    one = measured().to_plain()
    with use_graph(Graph(notebook=True)):
        rclpy.init()
        assert measured().to_plain() == one
    assert "load" not in str(one)


def test_bag_and_recording_are_measured_like_a_live_run(graph: Graph, tmp_path: Path) -> None:
    with record(graph) as recorder:
        spin_for(2.0, Camera())
    write_bag(recorder.recording(), tmp_path / "bag")
    from_bag, direct = performance_report(tmp_path / "bag"), performance_report(recorder.recording())
    assert from_bag.to_plain() == direct.to_plain()
    (row,) = from_bag.topics
    assert row.rate == pytest.approx(10.0)
    assert row.latency == 0.0
    assert not from_bag.callbacks
    assert "Processor" not in str(from_bag)


def test_report_is_a_table_in_text_and_in_a_cell(graph: Graph) -> None:
    report = measured()
    text, html = str(report), report._repr_html_()
    for words in ("Topics in 2 s of robot time", "Rate (Hz)", "/detector", "Longest wait (ms)"):
        assert words in text
        assert f">{words}</" in html.replace("<wbr>", "")
    assert ">/<wbr>detector<" in html, "a long name cannot wrap"
    assert "* processor time on this machine" in text
    assert str(report) == text


def test_cell_displays_one_table(
    graph: Graph, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("rich.console._is_jupyter", lambda: True)
    assert "Rate (Hz)" in repr(measured())
    assert capsys.readouterr().out == ""


@pytest.mark.slow
def test_timeline_shows_running_and_waiting_callbacks(graph: Graph) -> None:
    chart = measured().timeline(0.0, 1.0)
    assert chart.alt.startswith("Callback timeline from 0 to 1 s of robot time. ")
    assert "/detector timer 0.25 s: 4 calls, the longest 0 ms, the longest wait 31 ms." in chart.alt
    labels = [label.get_text() for label in chart.figure.axes[0].get_yticklabels()]
    assert sorted(labels) == ["/camera timer 0.1 s", "/detector /image", "/detector timer 0.25 s"]
    assert chart._repr_html_().startswith('<img alt="Callback timeline')
    assert chart.png().startswith(b"\x89PNG")


def test_timeline_without_callbacks_is_omitted(graph: Graph, tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="No callback ran from 7 to 8 s"):
        measured().timeline(7.0, 8.0)


@pytest.mark.slow
def test_overview_contains_the_figures_of_the_report(graph: Graph, tmp_path: Path) -> None:
    chart = measured().figure()
    assert re.search(r"Rate \[Hz\]: /detections 10, /image 10, /words \d", chart.alt)
    assert "Mean latency [ms]: /detections 82, /image 1." in chart.alt
    chart.save(tmp_path / "overview.png")
    assert (tmp_path / "overview.png").stat().st_size > 1000


def test_overview_of_many_topics_fits_into_a_window(graph: Graph) -> None:
    report = measured()
    topics = [replace(report.topics[0], topic=f"/topic_{number}") for number in range(15)]
    callbacks = [replace(report.callbacks[0], callback=f"timer {number} s") for number in range(10)]
    chart = replace(report, topics=tuple(topics), callbacks=tuple(callbacks)).figure()
    # PNG stores the height there.
    assert int.from_bytes(chart.png()[20:24], "big") < 700  # [px]


@pytest.mark.parametrize(
    ("message", "stamp"),
    [
        (PointCloud2(), None),
        (String(), None),
        (Image(), 12 * 10**9 + 5),
    ],
)
def test_stamps_are_read_from_the_serialized_bytes(message: RosMessage, stamp: int | None) -> None:
    if stamp is not None:
        message.header.stamp.sec, message.header.stamp.nanosec = 12, 5  # type: ignore[attr-defined]
    assert header_stamp(Sample(0, "/x", type_name(type(message)), serialize(message), Qos(), 0)) == stamp


def test_invalid_arguments_are_reported(graph: Graph, tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="is not a node"):
        performance_report(1.0, "camera")  # type: ignore[arg-type]
    with pytest.raises(CourseError, match="There is no bag"):
        performance_report(tmp_path / "nowhere")
    assert not graph.callback_listeners
