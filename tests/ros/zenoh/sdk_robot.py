"""A robot of zenoh-ros2-sdk, which shares no code with the kit: `sdk_robot.py PORT MESSAGES`.

It publishes, hears /cmd_vel and serves /add_two_ints; a line on stdin starts what comes later. What
it hears is printed, a line each.
"""

import logging
import sys
import threading
import time
from typing import Any

import numpy as np
import zenoh_ros2_sdk as sdk
from zenoh_ros2_sdk.message_registry import get_registry
from zenoh_ros2_sdk.qos import QosDurability, QosProfile

logging.disable(logging.WARNING)
PORT = int(sys.argv[1])
LATCHED = QosProfile(durability=QosDurability.TRANSIENT_LOCAL, history_depth=1)
get_registry(sys.argv[2])


def say(*words: object) -> None:
    sys.stdout.write(f"{' '.join(map(str, words))}\n")
    sys.stdout.flush()


def class_of(type_name: str) -> Any:
    sdk.load_message_type(type_name)
    return sdk.get_message_class(type_name)


def header(frame: str) -> Any:
    seconds, rest = divmod(time.time_ns(), 10**9)
    stamp = class_of("builtin_interfaces/msg/Time")(sec=seconds, nanosec=rest)
    return class_of("std_msgs/msg/Header")(stamp=stamp, frame_id=frame)


def transform(parent: str, child: str) -> Any:
    way = class_of("geometry_msgs/msg/Vector3")(x=0.5, y=0.0, z=0.0)
    turn = class_of("geometry_msgs/msg/Quaternion")(x=0.0, y=0.0, z=0.0, w=1.0)
    moved = class_of("geometry_msgs/msg/Transform")(translation=way, rotation=turn)
    return class_of("geometry_msgs/msg/TransformStamped")(
        header=header(parent), child_frame_id=child, transform=moved
    )


def publisher(topic: str, type_name: str) -> Any:
    name = "sdk" + topic.replace("/", "_")
    return sdk.ROS2Publisher(topic, type_name, node_name=name, router_port=PORT)


def subscribe(topic: str, type_name: str, text: Any, **settings: Any) -> Any:
    def heard(message: Any) -> None:
        say("heard", topic, text(message))

    name = "sdk_hears" + topic.replace("/", "_")
    return sdk.ROS2Subscriber(topic, type_name, heard, node_name=name, router_port=PORT, **settings)


def add(request: Any) -> Any:
    return sdk.get_message_class("example_interfaces/srv/AddTwoInts_Response")(sum=request.a + request.b)


def publish_for_ever() -> None:
    chatter = publisher("/chatter", "std_msgs/msg/String")
    tf = publisher("/tf", "tf2_msgs/msg/TFMessage")
    scan = publisher("/scan", "sensor_msgs/msg/LaserScan")
    image = publisher("/image", "sensor_msgs/msg/Image")
    ranges, none = np.linspace(1.0, 2.0, 90, dtype=np.float32), np.array([], np.float32)
    angles = {"angle_min": -1.5, "angle_max": 1.5, "angle_increment": 0.03}
    times = {"time_increment": 0.0, "scan_time": 0.1, "range_min": 0.1, "range_max": 9.0}
    pixels = np.arange(640 * 480 * 3).astype(np.uint8)
    while True:
        chatter.publish(data="hello from the SDK")
        tf.publish(transforms=[transform("odom", "base_link")])
        scan.publish(header=header("laser"), ranges=ranges, intensities=none, **angles, **times)
        size = {"height": 480, "width": 640, "step": 1920}
        image.publish(header=header("camera"), encoding="rgb8", is_bigendian=0, data=pixels, **size)
        time.sleep(0.05)


def call() -> None:
    client = sdk.ROS2ServiceClient("/set_bool", "std_srvs/srv/SetBool", timeout=10.0, router_port=PORT)
    answer = client.call(data=True)
    say("answer", answer.success, answer.message)


kept = [
    subscribe("/cmd_vel", "geometry_msgs/msg/Twist", lambda message: message.linear.x),
    subscribe("/early", "std_msgs/msg/String", lambda message: message.data, qos=LATCHED),
    sdk.ROS2ServiceServer(
        "/add_two_ints", "example_interfaces/srv/AddTwoInts", add, node_name="sdk_adder", router_port=PORT
    ),
]
threading.Thread(target=publish_for_ever, daemon=True).start()
say("up")
for line in sys.stdin:
    if line.strip() == "late":
        kept.append(subscribe("/late", "std_msgs/msg/String", lambda message: message.data, qos=LATCHED))
    else:
        threading.Thread(target=call, daemon=True).start()
sdk.ZenohSession.get_instance().close()
