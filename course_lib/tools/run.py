"""`course run` and `course ros2`: run unmodified programs in robot time, record them or apply a ros2 tool."""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext, redirect_stdout
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.programs import import_path
from course_lib.ros.programs.process import FunctionProcess
from course_lib.ros.programs.program import run_files
from course_lib.ros.time.pace import WallPace
from course_lib.ros.time.time_lock import EndBehavior, time_lock

if TYPE_CHECKING:
    from course_lib.ros.robot.connect import RobotAddress

# Verbs, recordings and links to robots are imported where they are used, because a small program
# needs none of them.
_WHERE = ("--run program.py", "--bag folder", "--robot dds/HOST")


def run(
    files: Sequence[Path],
    *,
    seconds: float | None,
    seed: int,
    bag: Path | None,
    args: Sequence[str],
    real_time: bool,
    robot: "RobotAddress | None" = None,
    is_strict: bool = False,
) -> int:
    """Run programs that share one graph, in the order of their start.

    Args:
        files: Python files, launch files, notebooks.
        seconds: Robot time to run, [s]; None runs until the programs end.
        seed: Seed of all random numbers.
        bag: Folder of the recording, which must not exist.
        args: The arguments in `sys.argv` of each program.
        real_time: Whether robot time runs in real time instead of at full speed.
        robot: The robot to link to. Its robot time is real time.
        is_strict: Whether a launch fails if it refers to something that cannot run here, which is
            otherwise ignored.

    Returns:
        The exit code of the programs.

    Raises:
        CourseError: A file cannot be run, the recording cannot be written, or the robot cannot be
            reached.
    """
    if bag is not None and bag.exists():
        raise CourseError(f"{bag} already exists. Choose another folder for the recording, or remove it.")
    graph = _graph(robot)
    graph.end_ns = None if seconds is None else graph.now_ns + round(seconds * 1e9)
    if real_time:
        graph.pace = WallPace(graph)
    recording: AbstractContextManager[object] = nullcontext()
    if bag is not None:
        from course_lib.recording import record_to_bag

        recording = record_to_bag(graph, bag)
    with recording:
        with use_graph(graph), time_lock.report_busy_main_thread(graph):
            code = run_files(
                files, seed=seed, args=args, kit_executables=_KitExecutables(), is_strict=is_strict
            )
        graph.close()
    return code


class _KitExecutables(Mapping[tuple[str, str], Callable[[], object]]):
    """The kit's executables, which are imported when a launch file refers to one."""

    def __getitem__(self, name: tuple[str, str]) -> Callable[[], object]:
        return _executables()[name]

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return iter(_executables())

    def __len__(self) -> int:
        return len(_executables())


def _executables() -> Mapping[tuple[str, str], Callable[[], object]]:
    from course_lib.tools.ros2 import EXECUTABLES

    return EXECUTABLES


def _graph(robot: "RobotAddress | None") -> Graph:
    if robot is None:
        return Graph()
    from course_lib.ros.robot.connect import link_to

    return link_to(robot)


def show_arguments(files: Sequence[Path]) -> str:
    """Describe the arguments that launch files declare, or raise a CourseError for other files."""
    import_path.install()
    from course_lib.ros.programs.launch_program import arguments_of

    return "\n".join(arguments_of(file) for file in files)


def ros2_over(
    words: Sequence[str],
    *,
    files: Sequence[Path],
    bag: Path | None,
    seconds: float | None,
    robot: "RobotAddress | None" = None,
) -> int:
    """Run `ros2 <words>` on programs, a recording or a robot, and return the programs' exit code.

    Raises:
        CourseError: None or several of the three are given, or `ros2` raises it.
    """
    # The verbs import rclpy.
    import_path.install()
    from course_lib.tools.ros2 import HELP, find_verb, ros2
    from course_lib.tools.sources import DISCOVERY, GraphSource, RecordingSource

    verb = find_verb(words)
    is_file = bool(words) and Path(words[0]).is_file()
    # The error for an unknown command needs no source.
    is_unknown = verb is None and not is_file
    needs_nothing = is_unknown or bool(HELP & set(words)) or (verb is not None and not verb.needs_nodes)
    starts = verb is not None and verb.words[0] in ("launch", "run") and bag is None
    if bool(files) + (bag is not None) + (robot is not None) != 1 and not (needs_nothing or starts):
        if is_file:
            raise CourseError(
                f"{words[0]} is not a command of ros2. Pass a program with --run: course ros2 "
                f"--run {' '.join(words) if len(words) > 1 else f'{words[0]} topic list'}"
            )
        if words[:2] == ["bag", "play"]:
            folder = next((word for word in words[2:] if not word.startswith("-")), "FOLDER")
            raise CourseError(
                f"A bag is played to programs that subscribe: course bag play {folder} --run "
                f"program.py, or in a notebook %ros2 bag play {folder}"
            )
        examples = (f"course ros2 {where} {words[0]} …" for where in _WHERE)
        raise CourseError(f"Nothing to inspect. Write: {', or '.join(examples)}")
    if (files or starts or robot) and not needs_nothing:
        tool = partial(ros2, words, write=sys.stdout.write)
        graph = _graph(robot)
        source = GraphSource(graph, discovery=DISCOVERY)
        # The output of the programs goes to stderr, so that the output of the verb can be piped.
        with redirect_stdout(sys.stderr) if files else nullcontext():
            return run_with_tool(files, lambda _: tool(source), seconds=seconds, graph=graph)
    from course_lib.recording import Recording, read_bag

    ros2(words, RecordingSource(Recording(()) if bag is None else read_bag(bag)), sys.stdout.write)
    return 0


def run_with_tool(
    files: Sequence[Path],
    tool: Callable[[Graph], None],
    *,
    seconds: float | None,
    graph: Graph | None = None,
) -> int:
    """Run programs, and a tool as soon as all programs wait. The programs end with the tool.

    Args:
        files: The programs.
        tool: The function to call with the graph.
        seconds: Limit of robot time, [s]; None lets the tool run to its end.
        graph: The graph of the programs, which is closed; by default a new one.

    Returns:
        The exit code of the programs.

    Raises:
        CourseError: A file cannot be run, or the tool raises it.
        BrokenPipeError: The reader of the tool's output has closed the pipe.
    """
    graph, errors = graph or Graph(), list[Exception]()
    graph.end_ns = None if seconds is None else graph.now_ns + round(seconds * 1e9)

    def run_tool() -> None:
        import rclpy

        rclpy.init(args=[], signal_handler_options=rclpy.SignalHandlerOptions.NO)
        try:
            tool(graph)
        except (CourseError, BrokenPipeError) as error:
            errors.append(error)
        finally:
            rclpy.try_shutdown()
            graph.end_ns = graph.now_ns

    with use_graph(graph):
        # At the limit the tool returns, so that a verb can report missing messages.
        tool_process = FunctionProcess("ros2", run_tool, (), at_end=EndBehavior.RETURN)
        code = run_files(files, seed=0, extra_processes=[tool_process], kit_executables=_KitExecutables())
    graph.close()
    if errors:
        raise errors[0]
    return code
