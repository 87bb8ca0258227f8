"""`course run` and `course ros2`: unmodified programs on robot time, recorded, or with a tool beside them."""

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.recording import Recording, read_bag, recorded
from course_lib.ros import standin_path
from course_lib.ros.graph import Graph, use_graph
from course_lib.ros.pace import WallPace
from course_lib.ros.process import Function
from course_lib.ros.program import run_files
from course_lib.ros.program_thread import AtEnd
from course_lib.ros.zenoh.connect import RobotAddress, link_to
from course_lib.tools.ros2 import EXECUTABLES, HELP, find_verb, ros2
from course_lib.tools.sources import DISCOVERY, GraphSource, RecordingSource

HASH_SEED = "0"
_WHERE = ("--run program.py", "--bag folder", "--robot tcp/HOST:7447")


def run(
    files: Sequence[Path],
    *,
    seconds: float | None,
    seed: int,
    bag: Path | None,
    args: Sequence[str],
    real_time: bool,
    robot: RobotAddress | None = None,
) -> int:
    """Run programs that share one graph, in their start order; return their exit code.

    Args:
        files: Python files, launch files, notebooks.
        seconds: Robot time to run, [s]; None runs until the programs end.
        seed: Seeds every source of chance.
        bag: Folder of the recording, which must not exist.
        args: `sys.argv` of each program, behind its name.
        real_time: Keep the wall clock's pace instead of running at full speed.
        robot: The robot that they are linked to; robot time is the wall clock then.

    Raises:
        CourseError: If a file cannot be run, the recording cannot be written or the robot not be reached.
    """
    if bag is not None and bag.exists():
        raise CourseError(f"{bag} is there already. Give the recording another folder, or remove that one.")
    graph = Graph() if robot is None else link_to(robot)
    graph.end_ns = None if seconds is None else graph.now_ns + round(seconds * 1e9)
    if real_time:
        graph.pace = WallPace(graph)
    with nullcontext() if bag is None else recorded(graph, bag):
        with use_graph(graph):
            code = run_files(files, seed=seed, args=args, own=EXECUTABLES)
        graph.close()
    return code


def show_arguments(files: Sequence[Path]) -> str:
    """Describe the arguments that launch files declare; raises a CourseError for other files."""
    standin_path.install()
    from course_lib.ros.launch_program import arguments_of

    return "\n".join(arguments_of(file) for file in files)


def ros2_over(
    words: Sequence[str],
    *,
    files: Sequence[Path],
    bag: Path | None,
    seconds: float | None,
    robot: RobotAddress | None = None,
) -> int:
    """Run `ros2 <words>` beside programs, over a recording or a robot; return the exit code of the programs.

    Raises:
        CourseError: None or several of the three; otherwise as `ros2`.
    """
    standin_path.install()  # verbs import rclpy
    verb = find_verb(words)
    needs_nothing = not words or bool(HELP & set(words)) or (verb is not None and not verb.looks)
    starts = verb is not None and verb.words[0] in ("launch", "run") and bag is None
    if bool(files) + (bag is not None) + (robot is not None) != 1 and not (needs_nothing or starts):
        ways = (f"course ros2 {where} {words[0]} …" for where in _WHERE)
        raise CourseError(f"Say where to look: {', or '.join(ways)}")
    if (files or starts or robot) and not needs_nothing:
        tool = partial(ros2, words, write=sys.stdout.write)
        graph = Graph() if robot is None else link_to(robot)
        source = GraphSource(graph, discovery=DISCOVERY)
        return run_beside(files, lambda _: tool(source), seconds=seconds, graph=graph)
    ros2(words, RecordingSource(Recording(()) if bag is None else read_bag(bag)), sys.stdout.write)
    return 0


def run_beside(
    files: Sequence[Path], tool: Callable[[Graph], None], *, seconds: float | None, graph: Graph | None = None
) -> int:
    """Run programs, and a tool as soon as each of them waits; return their exit code. They end with the tool.

    None for `seconds` lets the tool run to its end; a graph that is passed is closed.

    Raises:
        CourseError: If a file cannot be run, or the tool raises it.
        BrokenPipeError: The reader of the tool's output is gone.
    """
    graph, wrong = graph or Graph(), list[Exception]()
    graph.end_ns = None if seconds is None else graph.now_ns + round(seconds * 1e9)

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
        tools = Function("ros2", beside, (), at_end=AtEnd.RETURN)  # a verb says what it lacked
        code = run_files(files, seed=0, beside=[tools], own=EXECUTABLES)
    graph.close()
    if wrong:
        raise wrong[0]
    return code


def with_fixed_hashes() -> None:
    """Restart this command with a fixed hash seed, so that sets keep their order from run to run."""
    if os.environ.get("PYTHONHASHSEED") == HASH_SEED:
        return
    command = [sys.executable, "-m", "course_lib", *sys.argv[1:]]
    environment = os.environ | {"PYTHONHASHSEED": HASH_SEED}
    if os.name == "posix":
        sys.stdout.flush()
        os.execve(sys.executable, command, environment)
    sys.exit(subprocess.run(command, env=environment, check=False).returncode)
