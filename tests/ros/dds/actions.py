"""Programs with an action for both links, and how one runs in a kit whose network loses datagrams."""

import os
import sys
from pathlib import Path
from typing import Literal

# The feedback of a goal, each in one message. A publisher of feedback keeps ten.
FEEDBACK = 10
GOALS = 2
SERVER = f"""
import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer

rclpy.init()
node = rclpy.create_node("server")


def execute(goal):
    # The topic of the feedback may be discovered later than the services.
    while not node.count_subscribers("fib/_action/feedback"):
        time.sleep(0.05)
    for number in range({FEEDBACK}):
        goal.publish_feedback(Fibonacci.Feedback(sequence=[number]))
        time.sleep(0.1)
    goal.succeed()
    return Fibonacci.Result(sequence=[goal.request.order])


server = ActionServer(node, Fibonacci, "fib", execute)
print("up", flush=True)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
"""
CLIENT = f"""
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient

rclpy.init()
node = rclpy.create_node("client")
client = ActionClient(node, Fibonacci, "fib")


def wait(future):
    rclpy.spin_until_future_complete(node, future)
    return future.result()


client.wait_for_server()
for order in range({GOALS}):
    feedback = []
    goal = wait(client.send_goal_async(
        Fibonacci.Goal(order=order), lambda one: feedback.append(one.feedback.sequence[0])
    ))
    # Feedback that arrives after the result is dropped.
    while len(feedback) < {FEEDBACK}:
        rclpy.spin_once(node, timeout_sec=0.1)
    result = wait(goal.get_result_async())
    print(result.status, list(result.result.sequence), feedback, flush=True)
"""
# Its process ends while a goal is executed: by an exception, or by a signal in place of END.
DYING_SERVER = """
import os
import signal

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer

rclpy.init()
node = rclpy.create_node("server")


def execute(goal):
    goal.publish_feedback(Fibonacci.Feedback(sequence=[1]))
    END


server = ActionServer(node, Fibonacci, "fib", execute)
print("up", flush=True)
rclpy.spin(node)
"""
WAITING_CLIENT = """
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient

rclpy.init()
node = rclpy.create_node("client")
client = ActionClient(node, Fibonacci, "fib")
client.wait_for_server()
sent = client.send_goal_async(Fibonacci.Goal(order=1))
rclpy.spin_until_future_complete(node, sent)
goal = sent.result()
result = goal.get_result_async()
print("accepted", goal.accepted, flush=True)
while client.server_is_ready():
    rclpy.spin_once(node, timeout_sec=0.1)
rclpy.spin_until_future_complete(node, result, timeout_sec=0.5)
print("result", result.done(), client.wait_for_server(timeout_sec=0.1), flush=True)
cancel = goal.cancel_goal_async()
rclpy.spin_until_future_complete(node, cancel, timeout_sec=0.5)
print("canceled", cancel.done(), flush=True)
"""
ENDS = {"exits": "raise SystemExit", "is killed": "os.kill(os.getpid(), signal.SIGKILL)"}
ENDED = "accepted True\nresult False False\ncanceled False\n"
EXPECTED = "".join(f"4 [{order}] {list(range(FEEDBACK))}\n" for order in range(GOALS))
LOSSY = """
import random, sys
from course_lib.ros.dds.participant import Participant

chance, send, receive = random.Random(int(sys.argv[1])), Participant.send, Participant.receive


def lossy_send(self, submessages, locators, destination=b""):
    send(self, submessages, [one for one in locators if chance.random() > 0.3], destination)


def lossy_receive(self, data, host=""):
    if chance.random() > 0.3:
        receive(self, data)


Participant.send = lossy_send
# Another kit loses the datagrams that it sends itself.
if sys.argv[2] == "real":
    Participant.receive = lossy_receive
sys.argv[1:] = sys.argv[3:]
from course_lib.__main__ import main

main()
"""

# The kit restarts Python for a fixed hash seed, which undoes the replacements of LOSSY.
FIXED_SEED = os.environ | {"PYTHONHASHSEED": "0"}


def in_kit(
    program: Path, *options: str, seed: int | None = None, peer: Literal["kit", "real"] = "kit"
) -> list[str]:
    """Return the command that runs a program in a kit, linked to a peer on this computer.

    With a seed, 30 % of the datagrams in each direction are lost.
    """
    kit = ["-m", "course_lib"] if seed is None else ["-c", LOSSY, str(seed), peer]
    link = ["--robot", "dds/127.0.0.1", "--call", "/fib"]
    return [sys.executable, *kit, "run", str(program), *link, *options]
