"""`course run` and `course ros2` without typer, whose import takes a third of their start.

The usual options of both are parsed here. Everything else, including help and invalid command
lines, is left to `course_lib.cli`, which calls the same functions. A test compares both. This
module must not import large modules: `fix_hash_seed` restarts Python, so that they would be
imported twice.
"""

import os
import signal
import sys
from collections.abc import Callable, Sequence
from functools import partial
from math import inf
from pathlib import Path
from typing import Any, NoReturn

from course_lib.errors import CourseError

# Exit codes.
UNUSABLE, INTERRUPTED = 2, 130
# Robot time without --seconds [s].
RUN_SECONDS = 5.0


def run(
    files: Sequence[Path],
    for_programs: Sequence[str],
    *,
    seconds: float | None = None,
    params_file: Path | None = None,
    robot: Any = None,
    **options: Any,
) -> int:
    """Run programs for the time given on the command line, and return their exit code.

    Args:
        files: The programs, and `name:=value` for launch files.
        for_programs: The arguments after `--`.
        seconds: Robot time [s]; None for 5 s, or for notebooks and linked robots until the end.
        params_file: Parameters of the nodes.
        robot: The robot to link to.
        options: Options of `course_lib.tools.run.run`.
    """
    from course_lib.tools.run import run as run_programs

    settings = [str(word) for word in files if ":=" in str(word)]
    for_ros = ["--ros-args", "--params-file", str(params_file), "--"] if params_file else []
    files = [file for file in files if ":=" not in str(file)]
    by_the_wall = options.get("real_time") or robot
    if seconds is None and not by_the_wall and all(file.suffix != ".ipynb" for file in files):
        seconds = RUN_SECONDS
    options = {"seed": 0, "bag": None, "real_time": False, **options}
    args = [*for_ros, *settings, *for_programs]
    return run_programs(files, seconds=seconds, args=args, robot=robot, **options)


def ros2(
    words: Sequence[str],
    *,
    files: Sequence[Path] = (),
    bag: Path | None = None,
    seconds: float | None = None,
    robot: Any = None,
) -> int:
    """Run a `ros2` command over programs, a recording or a robot; return the programs' exit code."""
    from course_lib.tools.run import ros2_over

    if seconds is None and robot is None:
        seconds = RUN_SECONDS
    return ros2_over(words, files=files, bag=bag, seconds=seconds, robot=robot)


def find_usual_command(arguments: Sequence[str]) -> Callable[[], int] | None:
    """Return the call of a command line with usual options only; None for all others."""
    command, *remaining = arguments or [""]
    if command == "ros2" and "--" not in remaining:
        parsed = _parse(remaining, _ROS2, is_mixed=False)
        return None if parsed is None else partial(ros2, parsed[1], **parsed[0])
    starts = [index for index, word in enumerate(remaining) if word in ("--", "--ros-args")]
    end = starts[0] if starts else len(remaining)
    parsed = _parse(remaining[:end], _RUN, is_mixed=True)
    if command != "run" or parsed is None or not parsed[1]:
        return None
    for_programs = remaining[end:][remaining[end : end + 1] == ["--"] :]
    return partial(run, [Path(word) for word in parsed[1]], for_programs, **parsed[0])


def call(command: Callable[[], int]) -> NoReturn:
    """Run a command and exit with its code. Print an error as one line."""
    try:
        code = command()
    except CourseError as error:
        fail(str(error), error.exit_code)
    except OSError as error:
        fail(f"{error.filename}: {error.strerror}. Correct this, or choose another file or folder.")
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    sys.exit(code)


def fail(message: str, exit_code: int = UNUSABLE) -> NoReturn:
    """Print an error as one line, and exit."""
    sys.stderr.write(f"error: {' '.join(message.split())}\n")
    sys.exit(exit_code)


def _seconds(text: str) -> float:
    seconds = float(text)
    if not 0 <= seconds < inf:
        raise ValueError(text)
    return seconds


def _yaml_file(text: str) -> Path:
    if not Path(text).is_file():
        raise ValueError(text)
    return Path(text)


# The argument's name and the conversion of each option's text; True for a flag.
_RUN: dict[str, tuple[str, Callable[[str], Any] | bool]] = {
    "--seconds": ("seconds", _seconds),
    "--seed": ("seed", int),
    "--bag": ("bag", Path),
    "--params-file": ("params_file", _yaml_file),
    "--real-time": ("real_time", True),
    "--strict": ("is_strict", True),
}
_ROS2: dict[str, tuple[str, Callable[[str], Any] | bool]] = {
    "--run": ("files", Path),
    "--bag": ("bag", Path),
    "--seconds": ("seconds", _seconds),
}


def _parse(
    words: Sequence[str],
    table: dict[str, tuple[str, Callable[[str], Any] | bool]],
    *,
    is_mixed: bool,
) -> tuple[dict[str, Any], list[str]] | None:
    """Split arguments into options and others.

    Return None for an unknown option or an invalid value. `is_mixed` permits options after the
    first other argument.
    """
    options: dict[str, Any] = {}
    positional: list[str] = []
    waiting = list(words)
    while waiting:
        word = waiting.pop(0)
        if not word.startswith("-"):
            positional.append(word)
            if not is_mixed:
                return options, [*positional, *waiting]
            continue
        name, has_value, value = word.partition("=")
        argument, convert = table.get(name, ("", False))
        if isinstance(convert, bool):
            if not convert or has_value:
                return None
            options[argument] = True
            continue
        if not has_value and not waiting:
            return None
        try:
            converted = convert(value if has_value else waiting.pop(0))
        except ValueError:
            return None
        options[argument] = [*options.get(argument, ()), converted] if argument == "files" else converted
    return options, positional


HASH_SEED = "0"
# The commands that run programs, by the first words of the command line. `ros2` does so with a
# --run.
_RUNS = (["run"], ["bag", "play"])


def fix_hash_seed(arguments: list[str]) -> None:
    """Restart a command that runs programs with a fixed hash seed: the order of sets is reproducible.

    Python reads the seed only when it starts. This function is called first, because everything
    that is imported before it is imported twice.

    Args:
        arguments: The arguments of the command, without its name.
    """
    start = next((index for index, word in enumerate(arguments) if not word.startswith("-")), 0)
    command = arguments[start:]
    runs = any(command[: len(command_words)] == command_words for command_words in _RUNS)
    runs |= command[:1] == ["ros2"] and any(word.startswith("--run") for word in command)
    if not runs or os.environ.get("PYTHONHASHSEED") == HASH_SEED:
        return
    command_line = [sys.executable, "-P", "-m", "course_lib", *arguments]
    environment = os.environ | {"PYTHONHASHSEED": HASH_SEED}
    if os.name == "posix":
        # It is None if the command was started with a closed output: course run my_node.py >&-
        if sys.stdout is not None:
            sys.stdout.flush()
        # Python ends with a fatal error if it is interrupted while it starts. `main` unblocks it.
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        os.execve(sys.executable, command_line, environment)
    import subprocess

    sys.exit(subprocess.run(command_line, env=environment, check=False).returncode)
