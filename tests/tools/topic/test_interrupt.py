"""■ ends every endless tool without an error."""

from collections.abc import Callable

import pytest
from rclpy.node import Node

Run = Callable[[str], str]


@pytest.mark.parametrize(
    "line",
    [
        "topic echo /chatter",
        "topic hz /chatter",
        "topic hz /nope",
        "topic bw /chatter",
        "topic delay /place",
        "topic pub /a std_msgs/msg/String",
        "topic pub -w 3 /a std_msgs/msg/String",
    ],
)
def test_interrupt_ends_the_command_silently(
    run: Run, talker: Node, capsys: pytest.CaptureFixture[str], line: str
) -> None:
    def press() -> None:
        raise KeyboardInterrupt

    talker.create_timer(1.5, press)
    run(line)
    where = ", in test_interrupt.py, line 27: raise KeyboardInterrupt"  # of the running callback
    assert capsys.readouterr().out == f"Stopped after 1.5 s of robot time{where}.\n"
    assert talker.get_node_names() == ["talker"]
