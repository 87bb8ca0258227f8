"""Every source of chance that a student may reach for, and the order of a set."""

import os
import random
import secrets
import uuid

import numpy as np
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Dice(Node):
    def __init__(self) -> None:
        super().__init__("dice")
        self.publisher = self.create_publisher(String, "throw", 10)
        self.create_timer(0.2, self.throw)

    def throw(self) -> None:
        throws = (
            random.random(),
            random.Random().random(),
            secrets.token_hex(4),
            np.random.rand(),
            np.random.default_rng().integers(1000),
            uuid.uuid4(),
            os.urandom(4).hex(),
            list({"red", "green", "blue"}),
        )
        self.publisher.publish(String(data=str(throws)))


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Dice())
