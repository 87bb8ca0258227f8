"""Runs typical mistakes under the real rclpy: `each_mistake.py PRELUDE.py MISTAKES.json OUTCOMES.json`.

Each mistake runs in a process of its own, as some of them abort it or wait for ever. The outcome is
what is written to standard error and the last line of the traceback.
"""

import faulthandler
import json
import os
import signal
import sys
import tempfile
import traceback
from pathlib import Path

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

TIME_LIMIT = 4  # [s]


def transform(parent: str, child: str, second: int) -> TransformStamped:
    """Create a transform for the programs."""
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp.sec = parent, second
    return message


def run(imported: dict[str, object], program: str) -> None:
    """Run one program, and write its error to standard error."""
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    names = imported | {"rclpy": rclpy, "node": Node("robot"), "transform": transform}
    signal.alarm(TIME_LIMIT)
    try:
        exec(compile(program, "program.py", "exec"), names)
    except BaseException as error:
        sys.stderr.write("".join(traceback.format_exception_only(error)))


def outcome(imported: dict[str, object], program: str) -> str:
    """Return the standard error and the exit code of a program."""
    with tempfile.TemporaryFile() as file:
        child = os.fork()
        if child == 0:
            os.dup2(file.fileno(), 2)
            try:
                run(imported, program)
                sys.stderr.flush()
            finally:
                # Neither exit handlers nor threads of the middleware may change the outcome.
                os._exit(0)
        _, status = os.waitpid(child, 0)
        file.seek(0)
        text = file.read().decode(errors="replace")
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        text += "waits for ever\n" if number == signal.SIGALRM else f"{signal.Signals(number).name}\n"
    return text


def main() -> None:
    """Run all mistakes."""
    faulthandler.disable()  # the name of the signal is enough, and addresses differ
    prelude, mistakes, outcomes = (Path(word) for word in sys.argv[1:4])
    programs = json.loads(mistakes.read_text(encoding="utf-8"))
    # Imported once: types without a wheel take seconds.
    imported: dict[str, object] = {"__name__": "__main__"}
    exec(compile(prelude.read_text(encoding="utf-8"), "program", "exec"), imported)
    outcomes_by_program = {program: outcome(imported, program) for program in programs}
    outcomes.write_text(json.dumps(outcomes_by_program), encoding="utf-8")


if __name__ == "__main__":
    main()
