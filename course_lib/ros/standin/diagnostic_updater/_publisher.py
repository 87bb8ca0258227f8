"""Diagnostics of topics: their rate, and how old their stamps are."""

from typing import Any

from rclpy.publisher import Publisher
from rclpy.time import Time

from diagnostic_updater._diagnostic_updater import CompositeDiagnosticTask, Updater
from diagnostic_updater._update_functions import (
    FrequencyStatus,
    FrequencyStatusParam,
    TimeStampStatus,
    TimeStampStatusParam,
)


class HeaderlessTopicDiagnostic(CompositeDiagnosticTask):
    """Checks the rate of a topic; call `tick` for each message."""

    def __init__(self, name: str, diag: Updater, freq: FrequencyStatusParam) -> None:
        super().__init__(f"{name} topic status")
        self.diag = diag
        self.freq = FrequencyStatus(freq)
        self.addTask(self.freq)
        diag.add(self)

    def tick(self) -> None:
        """Count a message."""
        self.freq.tick()

    def clear_window(self) -> None:
        """Begin to count anew."""
        self.freq.clear()


class TopicDiagnostic(HeaderlessTopicDiagnostic):
    """Checks the rate of a topic and the age of its stamps."""

    def __init__(
        self, name: str, diag: Updater, freq: FrequencyStatusParam, stamp: TimeStampStatusParam
    ) -> None:
        super().__init__(name, diag, freq)
        self.stamp = TimeStampStatus(stamp)
        self.addTask(self.stamp)

    def tick(self, stamp: Time | float) -> None:  # type: ignore[override]  # ROS's signature
        """Count a message of this stamp."""
        self.stamp.tick(stamp)
        super().tick()


class DiagnosedPublisher(TopicDiagnostic):
    """A publisher whose messages are checked; they have a header."""

    def __init__(
        self,
        pub: Publisher[Any],
        diag: Updater,
        freq: FrequencyStatusParam,
        stamp: TimeStampStatusParam,
    ) -> None:
        super().__init__(pub.topic_name, diag, freq, stamp)
        self.publisher = pub

    def publish(self, message: Any) -> None:
        """Publish a message and count it."""
        self.tick(Time.from_msg(message.header.stamp))
        self.publisher.publish(message)
