"""The driver of a robot behind a gateway, and what that means for this kit's commands."""

from collections.abc import Callable, Sequence

from course_lib.ros.zenoh.login import Login


class Wheel:
    """The lines to a student on commands that the gateway does not pass on, once for each driver.

    Args:
        login: The student.
        tell: Prints a line.
    """

    def __init__(self, login: Login, tell: Callable[[str], None]) -> None:
        self._login, self._tell = login, tell
        self._driver: str | None = None  # None: not known, "": nobody
        self._topics: Sequence[str] = ()
        self._sent: dict[str, bool] = {}  # topic -> whether the student knows that it is not passed on

    def change(self, driver: str, topics: Sequence[str]) -> None:
        """Note who drives now, and by which topics."""
        changed, self._driver, self._topics = driver != self._driver, driver, topics
        for topic in tuple(self._sent) if changed else ():
            self._explain(topic)

    def sent(self, topic: str) -> None:
        """Note that a message of a topic has gone out."""
        if topic not in self._sent:
            self._sent[topic] = False
            self._explain(topic)

    def rows(self) -> list[tuple[str, object]]:
        """Return the driver as a row of `ros2 doctor`; none without a gateway."""
        if self._driver is None:
            return []
        return [("driver", "you" if self._driver == self._login.name else self._driver or "nobody")]

    def _explain(self, topic: str) -> None:
        outward = self._login.outward(topic)
        if self._driver is None or outward == topic:
            return
        if topic not in self._topics:
            if not self._sent[topic]:
                self._tell(f"The gateway does not pass {topic} on to the robot: others hear it as {outward}.")
            self._sent[topic] = True
        elif self._driver != self._login.name:
            self._tell(
                f"{self._driver or 'Nobody'} drives: your {topic} is not passed on to the robot. The "
                "instructor chooses the driver."
            )
            self._sent[topic] = True
        elif self._sent[topic]:
            self._tell(f"You drive now: your {topic} goes to the robot.")
            self._sent[topic] = False
