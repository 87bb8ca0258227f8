"""`course run`: unmodified programs on robot time, recorded if asked for."""

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.recording import record, write_bag
from course_lib.ros import standin_path
from course_lib.ros.graph import Graph, use_graph
from course_lib.ros.pace import WallPace
from course_lib.ros.process import Function
from course_lib.ros.program import run_files
from course_lib.tools.executables import EXECUTABLES

HASH_SEED = "0"


def run(
    files: Sequence[Path],
    *,
    seconds: float | None,
    seed: int,
    bag: Path | None,
    args: Sequence[str],
    real_time: bool,
) -> int:
    """Run programs that share one graph, in their start order; returns their exit code.

    Args:
        files: Python files, launch files, notebooks.
        seconds: Robot time to run, [s]; None runs until the programs end.
        seed: Seeds every source of chance.
        bag: Folder of the recording, which must not be there yet.
        args: What each program finds in `sys.argv`.
        real_time: Keep the wall clock's pace instead of running at full speed.

    Raises:
        CourseError: If a file cannot be run or the recording cannot be written.
    """
    if bag is not None and bag.exists():
        raise CourseError(f"{bag} is there already. Give the recording another folder, or remove that one.")
    graph = Graph()
    graph.end_ns = None if seconds is None else graph.now_ns + round(seconds * 1e9)
    if real_time:
        graph.pace = WallPace(graph)
    with use_graph(graph), record(graph) as recorder:
        code = run_files(files, seed=seed, args=args, own=EXECUTABLES)
    if bag is not None:
        write_bag(recorder.recording(), bag)
    return code


def show_arguments(files: Sequence[Path]) -> str:
    """Say which arguments launch files declare; raises a CourseError where a file is none."""
    standin_path.install()
    from course_lib.ros.launch_program import arguments_of

    return "\n".join(arguments_of(file) for file in files)


def run_beside(files: Sequence[Path], tool: Callable[[Graph], None], *, seconds: float) -> int:
    """Run programs, and, once each waits, a tool beside them; they end with it. Returns their exit code.

    Raises:
        CourseError: If a file cannot be run, or what the tool finds wrong.
        BrokenPipeError: Nobody reads what the tool writes.
    """
    graph, wrong = Graph(), list[Exception]()
    graph.end_ns = graph.now_ns + round(seconds * 1e9)

    def beside() -> None:
        import rclpy

        rclpy.init(args=[], signal_handler_options=rclpy.SignalHandlerOptions.NO)
        try:
            tool(graph)
        except (CourseError, BrokenPipeError) as error:
            wrong.append(error)
        finally:
            rclpy.try_shutdown()
            graph.end_ns = graph.now_ns

    with use_graph(graph):
        code = run_files(files, seed=0, beside=[Function("ros2", beside, ())], own=EXECUTABLES)
    if wrong:
        raise wrong[0]
    return code


def with_fixed_hashes() -> None:
    """Start this command again with a fixed hash seed, so that sets keep their order from run to run."""
    if os.environ.get("PYTHONHASHSEED") == HASH_SEED:
        return
    command = [sys.executable, "-m", "course_lib", *sys.argv[1:]]
    environment = os.environ | {"PYTHONHASHSEED": HASH_SEED}
    if os.name == "posix":
        sys.stdout.flush()
        os.execve(sys.executable, command, environment)
    sys.exit(subprocess.run(command, env=environment, check=False).returncode)
