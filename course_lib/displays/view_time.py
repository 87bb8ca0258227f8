"""The time of a view: robot time paces its frames, and its displays live in ROS time."""

from collections.abc import Callable

from course_lib.displays.frames import NS

_HIDDEN_RATE = 10  # [Hz]: films have no gaps, and queues of messages do not overflow


class ViewTime:
    """Robot time [ns], and ROS time: the same, or with `use_sim_time` what was last heard on /clock.

    Args:
        start_ns: Robot time, [ns].
        use_sim_time: Whether ROS time follows /clock.
    """

    def __init__(self, start_ns: int, use_sim_time: bool) -> None:
        self.use_sim_time = use_sim_time
        self.frame_rate = 30  # [Hz] of robot time
        self.is_hidden: Callable[[], bool] = lambda: False  # whether all pages are behind others
        self.robot_ns = start_ns
        self._sim_ns = 0  # 0 until /clock was heard
        self._heard_ns = start_ns  # of the last message
        self._frame_ns = start_ns  # of the last frame
        self._due_ns: int | None = None  # when the next frame must be, if anything waits for it

    @property
    def now_ns(self) -> int:
        """ROS time when something happened last, [ns]."""
        return self.ros_ns(self.robot_ns)

    def ros_ns(self, robot_ns: int) -> int:
        """Return ROS time at a robot time that is now, [ns]."""
        return self._sim_ns if self.use_sim_time else robot_ns

    def has_passed(self, stamp_ns: int) -> bool:
        """Return whether a message is older than the last one: a recording was wound back."""
        return stamp_ns < self._heard_ns

    def hear(self, stamp_ns: int) -> None:
        """Note the robot time of a message."""
        self.robot_ns = self._heard_ns = stamp_ns

    def follow(self, sim_ns: int) -> bool:
        """Set the time of /clock; returns whether it jumped back."""
        jumped, self._sim_ns = sim_ns < self._sim_ns, sim_ns
        return jumped

    def restart(self) -> None:
        """Forget all times: the next message says where they begin."""
        self.robot_ns, self._sim_ns, self._due_ns = 0, 0, None

    def request_frame(self) -> None:
        """Schedule a frame after its interval, unless one is due before."""
        if self._due_ns is None:
            self._due_ns = self.robot_ns + self._interval_ns

    def overdue_ns(self, robot_ns: int) -> int | None:
        """Return when a frame was due that something waits for, up to a robot time; None if there is none."""
        return self._due_ns if self._due_ns is not None and self._due_ns <= robot_ns else None

    def is_frame_due(self, robot_ns: int) -> bool:
        """Return whether a frame is due, also if nothing waits for it: things expire without a message."""
        return robot_ns >= (self._frame_ns + self._interval_ns if self._due_ns is None else self._due_ns)

    def begin_frame(self, robot_ns: int) -> None:
        """Note the robot time of a frame."""
        self.robot_ns = self._frame_ns = max(robot_ns, self.robot_ns)
        self._due_ns = None

    @property
    def _interval_ns(self) -> int:
        return NS // (min(self.frame_rate, _HIDDEN_RATE) if self.is_hidden() else self.frame_rate)
