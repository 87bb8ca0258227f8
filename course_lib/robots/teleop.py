"""teleop_twist_keyboard: drives a base by keys, which are buttons in a notebook cell."""

from collections import deque
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from ipywidgets import GridBox

# Polling period of the keys [s].
PERIOD = 0.02
# Forward and turning speed as factors of the two maximum speeds. All other keys stop the base.
MOVES = {
    "u": (1, 1), "i": (1, 0), "o": (1, -1),
    "j": (0, 1), "l": (0, -1),
    "m": (-1, -1), ",": (-1, 0), ".": (-1, 1),
}  # fmt: skip
# Factors by which keys change the two maximum speeds.
FASTER = {
    "q": (1.1, 1.1), "w": (1.1, 1.0), "e": (1.0, 1.1),
    "z": (0.9, 0.9), "x": (0.9, 1.0), "c": (1.0, 0.9),
}  # fmt: skip
KEYS = ("u", "i", "o", "j", "k", "l", "m", ",", ".", "q", "w", "e", "z", "x", "c")


class TwistTeleop(Node):
    """Publishes a Twist on `cmd_vel` for each key, like the ROS program of this name."""

    def __init__(self) -> None:
        super().__init__("teleop_twist_keyboard")
        # In [m/s] and [rad/s].
        self.declare_parameter("speed", 0.5)
        self.declare_parameter("turn", 1.0)
        self._speed, self._turn = (float(self.get_parameter(name).value) for name in ("speed", "turn"))
        self._twists = self.create_publisher(Twist, "cmd_vel", QoSProfile(depth=10))
        self._pressed: deque[str] = deque()
        self.create_timer(PERIOD, self._work)

    def press(self, key: str) -> None:
        """Press a key."""
        self._pressed.append(key)

    def _work(self) -> None:
        while self._pressed:
            key = self._pressed.popleft()
            if key in FASTER:
                speed, turn = FASTER[key]
                self._speed, self._turn = self._speed * speed, self._turn * turn
                self.get_logger().info(f"currently:\tspeed {self._speed:.2f}\tturn {self._turn:.2f}")
                continue
            forward, turn = MOVES.get(key, (0, 0))
            self._twists.publish(
                Twist(linear=Vector3(x=forward * self._speed), angular=Vector3(z=turn * self._turn))
            )


def key_buttons(press: Callable[[str], None], keys: Sequence[str], columns: int = 3) -> "GridBox":
    """Return keys as buttons for a cell, row by row. An empty name leaves a gap."""
    import ipywidgets

    def button(key: str) -> Any:
        made = ipywidgets.Button(description=key.upper(), tooltip=f"The key {key.upper()}")
        made.layout.width, made.layout.visibility = "3.2em", "visible" if key else "hidden"
        made.on_click(lambda _: press(key))
        return made

    grid = {"grid_template_columns": f"repeat({columns}, 3.6em)"}
    return ipywidgets.GridBox([button(key) for key in keys], layout=grid)
