from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.recording import Recording, write_bag
from course_lib.ros.graph.graph import START_NS, Graph
from course_lib.ros.time import pace, wall
from course_lib.ros.time.driving import running_nodes
from course_lib.tools.ros2 import ros2
from course_lib.tools.run import ros2_over
from course_lib.tools.sources import RecordingSource

Run = Callable[[str], str]
Received = list[tuple[float, str, str]]


@pytest.fixture
def received_messages(graph: Graph) -> Received:
    """Return the messages that a live node receives: seconds since its start, topic, string."""
    received: Received = []
    node = Node("ear")

    def hear(topic: str) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            received.append(((graph.now_ns - START_NS) * 1e-9, topic, message.data))

        return take

    for topic in ("/a", "/b", "/c"):
        node.create_subscription(String, topic, hear(topic), 10)
    running_nodes().append(node)
    return received


def texts(received_messages: Received) -> str:
    return "".join(text for _, _, text in received_messages)


def test_bag_is_played_in_order_and_at_its_rate(bag: Path, run: Run, received_messages: Received) -> None:
    output = run("play five")
    assert [(topic, text) for _, topic, text in received_messages] == [
        (("/a", "/b")[i % 2], str(i)) for i in range(6)
    ]
    assert [at for at, _, _ in received_messages] == pytest.approx([i + 0.001 for i in range(6)])
    at = "[INFO] [1700000000.000000000] [rosbag2_player]: "
    assert output == f"{at}Set rate to 1\n{at}Playback until timestamp: -1\n"


def test_delay_is_logged_before_the_messages(bag: Path, run: Run) -> None:
    assert run("play five -d 2").splitlines()[-1].endswith("[rosbag2_player]: Sleep 2000000000 ns")


@pytest.mark.parametrize(
    ("options", "played", "first"),
    [
        ("--rate 2", "012345", 0.0),
        ("-d 3", "012345", 3.0),
        ("--start-offset 2.5", "345", 0.5),
        ("--playback-duration 2", "012", 0.0),
        ("--start-offset 1 --playback-duration 2.5", "123", 0.0),
        ("--playback-duration -1", "012345", 0.0),
        ("--topics /b", "135", 1.0),
        ("-e /[ax]", "024", 0.0),
        ("-x .*b", "024", 0.0),
        ("--exclude-topics /a", "135", 1.0),
    ],
)
def test_options_select_topics_and_times_to_play(
    bag: Path, run: Run, received_messages: Received, options: str, played: str, first: float
) -> None:
    run(f"play five {options}")
    assert texts(received_messages) == played
    assert received_messages[0][0] == pytest.approx(first + 0.001)


def test_rate_option_scales_the_pauses(bag: Path, run: Run, received_messages: Received) -> None:
    run("play five -r 4")
    assert [at for at, _, _ in received_messages] == pytest.approx([i / 4 + 0.001 for i in range(6)])


def test_topics_are_remapped(bag: Path, run: Run, received_messages: Received) -> None:
    run("play five --topics /b --remap /b:=/c")
    assert {topic for _, topic, _ in received_messages} == {"/c"}


def test_loop_ends_without_a_page(bag: Path, run: Run, received_messages: Received) -> None:
    output = run("play five --loop -r 2")
    assert texts(received_messages) == "012345" * 2
    assert output.endswith("No page is watching: ros2 bag play stopped after 5 s of robot time.\n")


def test_latched_topics_are_played_latched(bag: Path, graph: Graph, run: Run) -> None:
    observed: list[Any] = []
    node = Node("watch")
    node.create_timer(
        2.0, lambda: observed.extend(node.get_publishers_info_by_topic("/b")) if not observed else None
    )
    running_nodes().append(node)
    run("play five")
    (info,) = observed
    assert isinstance(info.qos_profile, QoSProfile)
    assert (info.node_name, info.qos_profile.durability.name) == ("rosbag2_player", "TRANSIENT_LOCAL")
    assert "rosbag2_player" not in {node.name for node in graph.nodes()}


def test_bag_without_messages_is_named_as_the_reason(tmp_path: Path, run: Run) -> None:
    write_bag(Recording(()), tmp_path / "none")
    with pytest.raises(CourseError, match=r"none has no messages\. `ros2 bag info` shows"):
        run("play none")


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("play nowhere", "argument bag_path: Bag path 'nowhere' does not exist!"),
        ("play five -r 0", "argument -r/--rate: Value must be positive"),
        ("play five -m a:=b", "write /old_topic:=/new_topic"),
        ("play five --topics /z", r"The options select no message of five. `ros2 bag info`"),
    ],
)
def test_invalid_arguments_are_reported_in_one_line(bag: Path, run: Run, line: str, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        run(line)


def test_play_on_a_recording_is_rejected(bag: Path) -> None:
    with pytest.raises(
        CourseError, match=r"There is no subscription: course bag play --run program.py /.*five, or view"
    ):
        ros2(["bag", "play", str(bag)], RecordingSource(Recording(())), print)


def test_playback_ends_with_the_run(bag: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "ear.py").write_text(
        "import rclpy\n"
        "from rclpy.node import Node\n"
        "from std_msgs.msg import String\n"
        "rclpy.init()\n"
        "node = Node('ear')\n"
        "node.create_subscription(String, '/a', lambda message: print('heard', message.data), 10)\n"
        "rclpy.spin(node)\n"
    )
    assert ros2_over(["bag", "play", str(bag)], files=[tmp_path / "ear.py"], bag=None, seconds=3.0) == 0
    assert capfd.readouterr().err.splitlines() == ["heard 0", "heard 2"]


def test_start_paused_is_rejected_without_a_time_panel(bag: Path, run: Run) -> None:
    with pytest.raises(CourseError, match=r"^--start-paused needs JupyterLab"):
        run("play five --start-paused")


def test_start_paused_waits_for_the_time_panel(
    bag: Path, run: Run, received_messages: Received, graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "real")
    speed = pace.speed_of(graph)
    speed.rate = 1000.0

    def press(seconds: float) -> None:
        if speed.is_paused:  # otherwise it follows the pace of robot time
            assert received_messages == []
            speed.is_paused = False

    with monkeypatch.context() as waits:
        waits.setattr(wall, "sleep", press)
        run("play five -p --playback-duration 0")
    assert texts(received_messages) == "0"


def test_play_without_a_program_prints_the_command_that_runs_one() -> None:
    with pytest.raises(CourseError, match=r"course bag play my_bag --run program\.py"):
        ros2_over(["bag", "play", "my_bag", "--rate", "2"], files=[], bag=None, seconds=1.0)
