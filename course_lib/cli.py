"""`course …`: every command calls one function of the library."""

import sys
from math import inf
from pathlib import Path
from typing import Annotated, NoReturn

import typer
from typer.exceptions import TyperException

from course_lib.cli_robot import Call, Domain, Robot, Send, address, robots
from course_lib.cli_staff import need_fork_for, staff
from course_lib.errors import CourseError

NOT_PASSED, UNUSABLE, INTERRUPTED = 1, 2, 130  # exit codes
RUN_SECONDS = 5.0  # [s] of robot time, where no --seconds says otherwise
LONG = 1e6  # [s] of robot time, where something else ends the run

app = typer.Typer(
    no_args_is_help=True, rich_markup_mode=None, add_completion=False, pretty_exceptions_enable=False
)
bag = typer.Typer(help="Look into recordings.", rich_markup_mode=None)
app.add_typer(bag, name="bag")
app.add_typer(staff)
app.add_typer(robots)

ShowArgs = Annotated[bool, typer.Option("--show-args", help="Only list a launch file's arguments.")]
Browser = Annotated[bool, typer.Option(help="Open a browser.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]


@app.callback()
def course(context: typer.Context, debug: Debug = False) -> None:
    """Learn robot visualization and ROS 2 tooling in JupyterLab, with nothing but pip."""
    need_fork_for(context.invoked_subcommand or "")


@app.command()
def lab(
    work_dir: Annotated[Path, typer.Argument(help="Your folder; made if missing.")] = Path("my_course"),
    port: Annotated[int | None, typer.Option(help="The port to listen on.")] = None,
    browser: Browser = True,
    server: Annotated[bool, typer.Option(help="Start JupyterLab; without, the folder is all.")] = True,
) -> None:
    """Open JupyterLab on your course folder."""
    from course_lib.course.lab import lab as open_lab

    open_lab(work_dir, port=port, browser=browser, serves=server)


@app.command()
def demo(
    out: Annotated[Path, typer.Option(help="Where the picture and the page go.")] = Path("course_demo"),
) -> None:
    """Show the whole idea in 20 seconds, without a browser."""
    from course_lib.demo import demo as show

    show(out)


@app.command()
def run(
    context: typer.Context,
    files: Annotated[
        list[Path],
        typer.Argument(
            help="rclpy programs, PACKAGE_DIR:executable, launch files with name:=value, notebooks; "
            "they share a graph."
        ),
    ],
    seconds: Annotated[
        float | None, typer.Option(min=0, help="Robot time to run; default 5, notebooks: to their end.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seeds every source of chance.")] = 0,
    bag: Annotated[Path | None, typer.Option(help="Record everything into this new folder.")] = None,
    params_file: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="Parameters of the nodes, YAML.")
    ] = None,
    real_time: Annotated[bool, typer.Option("--real-time", help="As fast as the wall clock.")] = False,
    show_args: ShowArgs = False,
    robot: Robot = None,
    domain: Domain = None,
    send: Send = None,
    call: Call = None,
) -> None:
    """Run programs on robot time, or on a robot. What follows `--` is passed on to them."""
    from course_lib.tools.run import run as run_programs
    from course_lib.tools.run import show_arguments, with_fixed_hashes

    with_fixed_hashes()
    args = _arguments(files, params_file) + context.obj
    files = [file for file in files if ":=" not in str(file)]
    if show_args:
        typer.echo(show_arguments(files))
        return
    if seconds is None and not (real_time or robot) and all(file.suffix != ".ipynb" for file in files):
        seconds = RUN_SECONDS
    to = address(robot, domain, send, call)
    code = run_programs(files, seconds=seconds, seed=seed, bag=bag, args=args, real_time=real_time, robot=to)
    raise typer.Exit(code)


def _arguments(words: list[Path], params_file: Path | None) -> list[str]:
    """Return the arguments of programs: a file of parameters, and the settings among the words."""
    for_ros = ["--ros-args", "--params-file", str(params_file), "--"] if params_file else []
    return for_ros + [str(word) for word in words if ":=" in str(word)]


@app.command(context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
def ros2(
    words: Annotated[list[str] | None, typer.Argument(help="What follows `ros2`: topic list -t")] = None,
    run: Annotated[list[Path] | None, typer.Option(help="A program to run; may be given again.")] = None,
    bag: Annotated[Path | None, typer.Option(help="A recording to look into instead.")] = None,
    seconds: Annotated[
        float | None, typer.Option(min=0, help="Robot time to run; default 5, robots: to its end.")
    ] = None,
    robot: Robot = None,
    domain: Domain = None,
    send: Send = None,
    call: Call = None,
) -> None:
    """Do what `ros2` does, over programs, a recording or a robot; options for `course` come first."""
    from course_lib.tools.run import ros2_over, with_fixed_hashes

    if run:
        with_fixed_hashes()
    if seconds is None and robot is None:
        seconds = RUN_SECONDS
    to = address(robot, domain, send, call)
    raise typer.Exit(ros2_over(words or [], files=run or [], bag=bag, seconds=seconds, robot=to))


@app.command()
def render(
    bag: Annotated[Path, typer.Option(help="The recording to draw.")],
    rviz: Annotated[Path | None, typer.Option(help="The layout to draw it through.")] = None,
    at: Annotated[
        float | None, typer.Option(help="Seconds after the first message; default: its end.")
    ] = None,
    size: Annotated[str, typer.Option(help="Width x height in pixels.")] = "800x600",
    png: Annotated[Path | None, typer.Option(help="Write a picture.")] = None,
    html: Annotated[Path | None, typer.Option(help="Write a page that opens offline.")] = None,
) -> None:
    """Draw a recording as RViz would, into a picture or a page."""
    from course_lib.displays.render import render_bag

    width, _, height = size.partition("x")
    if not (width.isdigit() and height.isdigit() and 0 < int(width) <= 8192 and 0 < int(height) <= 8192):
        raise CourseError(f"--size {size}: write width x height in pixels, like --size 800x600.")
    if at is not None and not 0 <= at < inf:
        raise CourseError(f"--at {at:g}: write seconds after the first message, like --at 2.5.")
    for file, kind in ((png, ".png"), (html, ".html")):
        if file is not None and file.suffix.lower() != kind:
            raise CourseError(f"{file} would hold something else; call it {file.with_suffix(kind).name}.")
    if (png is None) == (html is None):
        raise CourseError("Say what to write: --png picture.png or --html page.html.")
    typer.echo(render_bag(bag, rviz=rviz, at=at, size=(int(width), int(height)), png=png, html=html))


@app.command()
def view(
    bag: Annotated[Path | None, typer.Option(help="The recording to play.")] = None,
    rviz: Annotated[Path | None, typer.Option(help="The layout to show it through.")] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="The port; 0: any that is free.")] = 0,
    token: Annotated[str | None, typer.Option(help="The address's secret part; default: by chance.")] = None,
    browser: Browser = True,
    robot: Robot = None,
    domain: Domain = None,
    send: Send = None,
    use_sim_time: Annotated[bool, typer.Option(help="Follow the robot's /clock.")] = False,
) -> None:
    """Show a layout, play a recording or see a robot through it, in a browser's tab."""
    from course_lib.displays import render, robot_view

    to = address(robot, domain, send, None)
    if to is None and not use_sim_time:
        render.view(bag, rviz, port=port, token=token, browser=browser)
    elif to is None or bag is not None:  # --use-sim-time follows a robot's /clock
        raise CourseError("Say what to show: --bag folder, or --robot tcp/HOST:7447, for --use-sim-time too.")
    else:
        robot_view.view_robot(to, rviz, port=port, token=token, browser=browser, use_sim_time=use_sim_time)


@bag.command()
def info(folder: Annotated[Path, typer.Argument(help="The recording's folder.")]) -> None:
    """Show the content of a recording."""
    from course_lib.recording import bag_info

    typer.echo(bag_info(folder))


@bag.command(context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
def play(
    words: Annotated[list[str], typer.Argument(help="The recording's folder, then as in `ros2 bag play`.")],
    run: Annotated[
        list[Path] | None, typer.Option(help="A program that listens; may be given again.")
    ] = None,
) -> None:
    """Play a recording to programs, which end with it."""
    from course_lib.tools.run import ros2_over, with_fixed_hashes

    with_fixed_hashes()
    nobody = None if run else Path(words[0])
    raise typer.Exit(ros2_over(["bag", "play", *words], files=run or [], bag=nobody, seconds=LONG))


@app.command()
def check(file: Annotated[Path, typer.Argument(help="Your exercise notebook.")]) -> None:
    """Run the public checks of an exercise."""
    from course_lib.grading.check_file import check_file

    raise typer.Exit(0 if check_file(file) else NOT_PASSED)


@app.command()
def submit(
    file: Annotated[Path, typer.Argument(help="Your exercise notebook.")],
    out: Annotated[Path | None, typer.Option(help="Where the file to hand in goes.")] = None,
) -> None:
    """Pack an exercise into one file to hand in, with a receipt."""
    from course_lib.grading.handin.submit import submit as pack

    typer.echo(pack(file, out).text())


@app.command()
def status(
    work_dir: Annotated[Path | None, typer.Argument(help="Your folder; default: ./my_course.")] = None,
) -> None:
    """Show how far you are, and what comes next."""
    from rich.console import Console

    from course_lib.course.progress import status as look

    table, then = look(work_dir)
    Console().print(table)
    typer.echo(then)


@app.command()
def export(
    file: Annotated[Path | None, typer.Argument(help="A notebook, or a Python file.")] = None,
    package: Annotated[str, typer.Option(help="The package's name.")] = "",
    out: Annotated[Path | None, typer.Option(help="The folder that the package's folder goes into.")] = None,
    node: Annotated[
        list[str] | None, typer.Option(help="A class to start; default: all nodes that can be.")
    ] = None,
    extra: Annotated[
        list[Path] | None, typer.Option("--with", help="A .rviz, .yaml, .urdf or launch file to go along.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite what is there.")] = False,
    check: Annotated[Path | None, typer.Option(help="Only say what this package lacks.")] = None,
) -> None:
    """Export the nodes in a notebook as a ROS 2 package: of cells marked # export, or of all."""
    from course_lib.export.check import lacks
    from course_lib.export.export import export as write

    if check is not None:
        report = lacks(check)
        typer.echo("\n".join(report.lines()))
        raise typer.Exit(0 if report.complete else NOT_PASSED)
    if file is None or out is None or not package:
        raise CourseError("write: course export FILE --package NAME --out DIR, or: course export --check DIR")
    typer.echo(write(file, package, out, nodes=node or (), extra=extra or (), force=force))


def main() -> None:
    """Run the command line; an error is one line that says what to type next."""
    arguments, for_programs = _split(sys.argv[1:])
    debug = "--debug" in arguments
    try:
        code = app(args=arguments or ["--help"], obj=for_programs, standalone_mode=False, prog_name="course")
    except CourseError as error:
        _fail(str(error), debug)
    except TyperException as error:  # wrong words on the command line
        context = getattr(error, "ctx", None)
        what = error.format_message().rstrip(".").replace("Input should be", "expected")
        depth = 2 if arguments[:1] == ["bag"] else 1  # words of a command
        words = ["course", *(word for word in arguments if not word.startswith("-"))][: depth + 1]
        _fail(f"{what}. See: {context.command_path if context else ' '.join(words)} --help", debug)
    except OSError as error:
        _fail(f"{error.filename}: {error.strerror}. Correct that, or name another file or folder.", debug)
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(INTERRUPTED)
    sys.exit(code or 0)


def _split(arguments: list[str]) -> tuple[list[str], list[str]]:
    """Part what is for the command from what is for its programs: behind `--`, or from `--ros-args` on."""
    starts = ("--", "--ros-args") if arguments[:1] == ["run"] else ("--",)
    place = next((at for at, word in enumerate(arguments) if word in starts), len(arguments))
    rest = arguments[place:]
    return arguments[:place], rest[rest[:1] == ["--"] :]


def _fail(message: str, debug: bool) -> NoReturn:
    if debug:
        raise
    typer.echo(f"error: {' '.join(message.split())}", err=True)
    sys.exit(UNUSABLE)
