"""The kit's judgement of a launch file or a layout of a public repository; only `started` starts it."""

import multiprocessing
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Protocol

from course_lib.tools.ros2 import EXECUTABLES

LIMIT = 60.0  # [s] of the wall clock for one file
SUFFIXES = {"launch": (".py", ".xml", ".yaml", ".yml", ".launch"), "layout": (".rviz",)}
NO_FILES = {"build", "install", "log", "test", "tests"}
_PRELOADED = (
    *("course_lib.ros.programs.launch_program", "launch.frontend.elements", "nav2_common.launch", "xacro"),
    *("course_lib.displays.session", "course_lib.displays.writer"),
)
COMMON = {"TURTLEBOT3_MODEL": "burger", "USER": "student"}  # of the environment, in courses
_NEEDED = re.compile(r'Required launch argument "(\w+)"')
_MISSING = re.compile(  # the name of a package or program in a message that it is missing
    r"package '([\w.-]+)' not found|No module named '([\w-]+)|"
    r"`([\w./-]+)[^`]*` (?:would run outside|cannot run)"
)
_LEFT_OUT = re.compile(r" is left out: (?:.*?package '([\w.-]+)'|(.{1,80}))")
# The last lines of programs that the end of a run, which is Ctrl+C, ends on a robot, too.
AT_THE_END = (
    *("rcl_shutdown already called", "publisher's context is invalid"),
    "Context must be initialized before it can be shutdown",
)
_DIED = re.compile(r"^\[ERROR\] \[([\w.-]+)\]: process has died", re.MULTILINE)
_ABSENT = re.compile(r"No such file or directory|[Ff]ile not found|No such launch file")

Judged = tuple[str, str]  # the result and its reason


class Placed(Protocol):
    """A row of a table: the location of a file in its clone."""

    @property
    def path(self) -> str:
        """The path in the clone."""


def files_of(clone: Path, what: str) -> Iterator[Path]:
    """List the launch files or layouts of a clone; launch files have "launch" in their names."""
    for file in sorted(clone.rglob("*")):
        if file.suffix not in SUFFIXES[what] or not file.is_file() or file.name.startswith("test_"):
            continue
        if set(file.relative_to(clone).parts[:-1]) & NO_FILES:
            continue
        if what == "layout" or re.search(r"launch\.\w+$", file.name) or file.suffix == ".launch":
            yield file


def judgement(clone: Path, row: Placed, what: str) -> Judged:
    """Judge a file in a forked process, which reuses the modules imported here."""
    if not (clone / row.path).is_file():
        return "missing", "no such clone"
    _preload()
    context = multiprocessing.get_context("fork")
    results, sender = context.Pipe(duplex=False)
    process = context.Process(target=_child, args=(sender, clone.resolve() / row.path, clone.resolve(), what))
    process.start()
    sender.close()
    try:
        judged: Judged = results.recv() if results.poll(LIMIT) else ("fails", f"took more than {LIMIT:g} s")
    except EOFError:
        judged = "fails", "its process died"
    process.kill()
    process.join()
    return judged


def _preload() -> None:
    from course_lib.ros.programs import import_path

    import_path.install()
    for name in _PRELOADED:
        import_module(name)


def _child(sender: "Connection[Judged, Judged]", file: Path, clone: Path, what: str) -> None:
    with TemporaryDirectory() as folder:
        packages = sorted({str(path.parents[1]) for path in clone.rglob("package.xml")})
        os.environ |= {"HOME": folder, "ROS_PACKAGE_PATH": os.pathsep.join(packages), **COMMON}
        os.chdir(folder)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        try:
            judged = described(file) if what == "launch" else kept(file, Path(folder))
        except BaseException as error:  # the file may raise any exception
            judged = judged_error(error, clone)
        sender.send(judged)


def started(clone: Path, row: Placed) -> Judged:
    """Run a launch file for two seconds of robot time, as a student does in the clone's folder.

    The result is `starts`, `starts in part` where something was left out, `needs` where all of it
    was, or an argument is required, or `fails` with the last line.
    """
    file = clone / row.path
    if not file.is_file():
        return "missing", "no such clone"
    with TemporaryDirectory() as home:
        words = [sys.executable, "-m", "course_lib", "run", str(file.resolve()), "--seconds", "2"]
        environment = os.environ | {"HOME": home, **COMMON}
        try:
            done = subprocess.run(
                words,
                cwd=clone,
                env=environment,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=LIMIT,
            )
        except subprocess.TimeoutExpired:
            return "fails", f"took more than {LIMIT:g} s"
    has_started = "process started with pid" in done.stdout
    if has_started and (done.returncode == 0 or _died_at_the_end(done.stdout + done.stderr)):
        return "starts in part" if " is left out: " in done.stdout else "starts", ""
    if needed := _NEEDED.search(done.stdout):
        return "needs", f"argument {needed[1]}"
    left_out = _LEFT_OUT.search(done.stdout)
    if left_out is not None and "[ERROR]" not in done.stdout and "Traceback" not in done.stderr:
        return "needs", next(name for name in left_out.groups() if name)
    lines = [
        line for line in (done.stdout + done.stderr).splitlines() if line and not line.startswith("hint")
    ]
    return "fails", lines[-1].replace(f"{clone.resolve()}/", "")[:160] if lines else "it starts nothing"


def _died_at_the_end(output: str) -> bool:
    """Return whether processes died only because the run ended."""
    died = _DIED.findall(output)
    lines = {name: [line for line in output.splitlines() if line.startswith(f"[{name}]")] for name in died}
    return bool(died) and all(
        any(text in line for text in AT_THE_END for line in lines[name]) for name in died
    )


def judged_error(error: BaseException, clone: Path) -> Judged:
    """Return the result and the reason for a file's exception, without paths of this machine."""
    text = f"{type(error).__name__}: {error}".replace(f"{clone}/", "").strip()
    missing = _MISSING.search(text)
    if missing is not None:
        return "needs", next(name for name in missing.groups() if name)
    return "fails", "a file is missing" if _ABSENT.search(text) else text.splitlines()[0][:160]


def described(file: Path) -> Judged:
    """Visit all entities of a launch file. Required arguments are set to a string."""
    from launch.entities import LaunchContext
    from launch.launch_description_sources import AnyLaunchDescriptionSource

    from course_lib.ros.programs.launch_program import prepare_imports

    given: dict[str, str] = {}
    prepare_imports(file)
    while True:
        context = LaunchContext()
        context.file = str(file)
        context.launch_configurations |= given
        context.runner = dry = _Dry(context)
        try:
            dry.visit(AnyLaunchDescriptionSource(str(file)).get_launch_description(context))
            while dry.timers:
                dry.visit(dry.timers.pop(0))
        except RuntimeError as error:
            needed = _NEEDED.search(str(error))
            if needed is None or needed[1] in given:
                raise
            given[needed[1]] = "1"
        else:
            return "described", ""


class _Dry:
    """A runner that starts no processes; `timers` holds the entities of timers."""

    def __init__(self, context: Any) -> None:
        self._context = context
        self.timers: list[Any] = []

    def visit(self, entities: Any) -> None:
        """Visit entities and the entities that they return."""
        from launch.entities import as_entity_list

        for entity in as_entity_list(entities):
            self.visit(entity.visit(self._context))

    def start(self, action: Any, package: str, executable: str, words: Iterable[str]) -> None:
        """Evaluate the command line."""
        list(words)

    def start_component(self, action: Any, package: str, plugin: str, words: Iterable[str]) -> bool:
        """Evaluate the command line. The component is not started."""
        list(words)
        return False

    def has_executable(self, package: str, executable: str) -> bool:
        """Return whether the kit itself has an executable."""
        return (package, executable) in EXECUTABLES

    def start_file(self, action: Any, file: Path, words: Iterable[str]) -> None:
        """Evaluate the command line."""
        list(words)

    def start_function(self, action: Any, name: str, function: Any, words: Iterable[str]) -> None:
        """Evaluate the command line."""
        list(words)

    def later(self, seconds: float, entities: Any) -> None:
        """Schedule entities to be visited last."""
        self.timers.append(entities)

    def emit(self, event: Any) -> None:
        """Do nothing."""

    def log(self, level: str, name: str, text: str) -> None:
        """Write nothing."""


def kept(file: Path, folder: Path) -> Judged:
    """Load a layout, save it and load it again. Every value of the file must be kept."""
    from course_lib.displays.layout import read_layout
    from course_lib.displays.session import RvizSession
    from course_lib.displays.writer import save_rviz
    from course_lib.viewer.scene import Scene

    saved = [folder / f"{number}.rviz" for number in range(2)]
    for source, target in zip((file, saved[0]), saved, strict=True):
        session = RvizSession(Scene())
        session.apply(read_layout(source))
        save_rviz(session, target)
    if saved[0].read_text(encoding="utf-8") != saved[1].read_text(encoding="utf-8"):
        return "fails", "it is saved otherwise when it was loaded again"
    there = _places(saved[0])
    lost = sorted(place for place in _places(file) if place not in there)
    return ("fails", f"{len(lost)} values are lost: {', '.join(lost[:3])}") if lost else ("kept", "")


def _places(file: Path) -> set[str]:
    """Return the paths of all values of a YAML file; RViz 1 wrote some mappings as their Value."""
    import yaml

    def paths(data: Any, prefix: str) -> Iterator[str]:
        pairs = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
        for key, value in pairs:
            yield from paths(value, f"{prefix}/{key}")
            if key == "Value":
                yield prefix
        if not isinstance(data, dict | list):
            yield prefix

    return set(paths(yaml.safe_load(file.read_text(encoding="utf-8")), ""))
