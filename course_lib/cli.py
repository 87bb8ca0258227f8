"""`course …`: the command line. Each command calls one function of the library.

The functions are imported inside the commands, because most commands need only a small part of the
kit and should start quickly.
"""

import os
import sys
from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer
from typer.exceptions import TyperException

from course_lib import usual_commands
from course_lib.errors import CourseError, format_count
from course_lib.usual_commands import fix_hash_seed

if TYPE_CHECKING:
    from course_lib.grading.jail.filters import Need
    from course_lib.ros.robot.connect import RobotAddress

Robot = Annotated[
    str | None,
    typer.Option(
        help="The address of the robot, dds/192.168.1.5, or of its Zenoh router, tcp/192.168.1.5:7447."
    ),
]
Domain = Annotated[int | None, typer.Option(help="The robot's ROS_DOMAIN_ID.")]
Send = Annotated[list[str] | None, typer.Option(help="A topic that may be sent to the robot.")]
Call = Annotated[list[str] | None, typer.Option(help="A service or action of the robot that may be called.")]

robots = typer.Typer()


def address(
    robot: str | None, domain: int | None, send: list[str] | None, call: list[str] | None
) -> "RobotAddress | None":
    """Return the robot's address and the topics to send, or None without a robot.

    Raises:
        CourseError: There are options for a robot, but no robot.
    """
    from course_lib.ros.robot.connect import RobotAddress

    if robot is not None:
        return RobotAddress(robot, domain, send or (), call or ())
    if domain is not None or send or call:
        raise CourseError(
            "--domain, --send and --call need a robot: add --robot dds/HOST or --robot tcp/HOST:7447."
        )
    return None


@robots.command()
def robot(
    kind: Annotated[
        str, typer.Argument(help="driving: a base with a laser scanner; unknown: the robot of week 6.")
    ] = "driving",
    listen: Annotated[str, typer.Option(help="Address for connections over Zenoh.")] = "tcp/127.0.0.1:7447",
    dds: Annotated[bool, typer.Option("--dds", help="Use DDS instead of Zenoh, without a router.")] = False,
    ros: Annotated[
        bool, typer.Option("--ros", help="Run it on the real ROS 2 (course ros --install), over DDS.")
    ] = False,
    domain: Annotated[
        int, typer.Option(min=0, max=232, envvar="ROS_DOMAIN_ID", help="The robot's ROS_DOMAIN_ID.")
    ] = 0,
    with_parent: Annotated[bool, typer.Option("--with-parent", hidden=True)] = False,
) -> None:
    """Run a simulated robot, whose topics, services and actions are available over the network."""
    from course_lib.gateway.robot import THIS_COMPUTER, SimulatedRobotAddress
    from course_lib.gateway.robot import robot as run_robot

    place = SimulatedRobotAddress(THIS_COMPUTER if dds or ros else listen, domain, ros)
    raise typer.Exit(run_robot(kind, place, typer.echo, with_parent=with_parent))


@robots.command()
def router(
    robot: Annotated[
        str,
        typer.Option(help="The robot's router, tcp/192.168.1.5:7447, or a robot over DDS, dds/192.168.1.5."),
    ] = "",
    send: Annotated[
        list[str] | None, typer.Option(help="A topic that the driver may publish; can be repeated.")
    ] = None,
    call: Annotated[
        list[str] | None,
        typer.Option(help="A service or an action that students may call; can be repeated."),
    ] = None,
    students: Annotated[
        Path | None, typer.Option(help="The platform's CSV; each student gets a token.")
    ] = None,
    id_column: Annotated[
        str, typer.Option(help="The heading of the IDs in --students; default: detected by its content.")
    ] = "",
    driver: Annotated[
        str, typer.Option(help="The student who drives, or nobody; also changes a running gateway.")
    ] = "",
    listen: Annotated[str, typer.Option(help="Address for the students' connections.")] = "tcp/0.0.0.0:7448",
    certificate: Annotated[Path | None, typer.Option(help="PEM file for --listen tls/…, with --key.")] = None,
    key: Annotated[Path | None, typer.Option(help="The certificate's private key, PEM.")] = None,
    domain: Annotated[
        int, typer.Option(min=0, max=232, envvar="ROS_DOMAIN_ID", help="The robot's ROS_DOMAIN_ID.")
    ] = 0,
    robot_port: Annotated[
        int, typer.Option(min=1, max=65535, help="Without --robot: the port for a robot on this computer.")
    ] = 7447,
    folder: Annotated[Path, typer.Option(help="The folder that stores the tokens.")] = Path("course_router"),
) -> None:
    """Run a gateway: all students receive a robot's messages, and one student at a time drives it."""
    from course_lib.ros.robot.connect import require_zenoh

    require_zenoh("A gateway needs them, because students connect to it over Zenoh.")
    from course_lib.gateway.gateway import Settings, relative_names
    from course_lib.gateway.gateway import router as run

    sends, calls = relative_names(send or (), "--send"), relative_names(call or (), "--call")
    there = f"tcp/127.0.0.1:{robot_port}"
    settings = Settings(listen, robot, sends, calls, domain, certificate, key, there)
    run(settings, folder, students, id_column, driver, typer.echo)


# Exit code.
NOT_READY = 1

authors = typer.Typer()


@authors.command()
def new(
    kind: Annotated[str, typer.Argument(help="A week like week09, or the word course.")],
    title: Annotated[str, typer.Argument(help='The title, such as "Occupancy maps".')] = "",
) -> None:
    """Write the files of a new week or of a new course, which already run."""
    from course_lib.authoring.new import new_course, new_week
    from course_lib.grading.store import this_course

    if not title:
        raise CourseError(f'{kind!r} needs a title, too. Write: course new {kind} "Occupancy maps"')
    if kind == "course":
        root = new_course(title, Path.cwd())
        typer.echo(
            f"{root} is a course. Continue there: pip install -e '.[test]' && course verify && course lab"
        )
        return
    for path in new_week(kind, title, this_course()):
        typer.echo(path)
    typer.echo(f"The files already run. Replace each REPLACE, and check your work with: course verify {kind}")


@authors.command()
def verify(
    weeks: Annotated[list[str] | None, typer.Argument(help="Weeks like week09; default: all.")] = None,
    jobs: Annotated[int | None, typer.Option(min=1, help="Number of notebooks that run in parallel.")] = None,
) -> None:
    """Test each week's answers, checks, quiz and lesson before students use them."""
    from rich.console import Console

    from course_lib.authoring.verify import lines, save_digests, table
    from course_lib.authoring.verify import verify as look
    from course_lib.grading.store import this_course

    course, reports = this_course(), []
    for report in look(course, weeks or (), jobs):
        typer.echo(f"{report.week}: {format_count(len(report.flaws), 'flaw')}", err=True)
        reports.append(report)
    save_digests(course, reports)
    Console().print(table(reports))
    typer.echo("\n".join(lines(reports, course)))
    raise typer.Exit(NOT_READY if any(report.flaws for report in reports) else 0)


@authors.command()
def release(
    out: Annotated[Path, typer.Argument(help="An empty or new folder.")],
    solution: Annotated[
        list[str] | None,
        typer.Option(help="A week like week01 whose solution is released, too; can be repeated."),
    ] = None,
) -> None:
    """Write the students' copy: installable, without solutions and hidden checks. Verify first.

    A solution is released only after the last submission of its week that can get points.
    """
    from course_lib.authoring.verify import reject_broken, report_placeholders
    from course_lib.course.release import free_folder, renew_exercises, require_closed_weeks
    from course_lib.course.release import release as write
    from course_lib.grading.store import this_course

    free_folder(out)
    require_closed_weeks(solution or ())
    renew_exercises()
    reject_broken(this_course(), lambda line: typer.echo(line, err=True))
    paths = write(out, solution or ())
    for line in report_placeholders(this_course()):
        typer.echo(f"note: {line}")
    typer.echo(f"Released {len(paths)} parts into {out}. Students run there: pip install -e . && course lab")


@authors.command()
def book(
    out: Annotated[Path, typer.Argument(help="A new or empty folder, or the folder of a previous book.")],
) -> None:
    """Build the course's lessons and guides, with their scenes, as web pages that work offline."""
    from course_lib.book.book import build

    built_book = build(out, typer.echo)
    typer.echo(f"{built_book.index}: {built_book.pages} pages")
    typer.echo("\n".join(built_book.warnings), err=True, nl=bool(built_book.warnings))
    raise typer.Exit(NOT_READY if built_book.warnings else 0)


# Exit code.
NOT_PASSED = 1

classes = typer.Typer()

RequireSandbox = Annotated[
    bool, typer.Option("--require-sandbox", help="Run submissions only in a full sandbox.")
]
Trust = Annotated[
    bool,
    typer.Option(
        "--i-trust-these-submissions", help="Run submissions with your permissions if no sandbox works."
    ),
]
Roster = Annotated[Path | None, typer.Option(help="The class list: id,name,email,section,group,login.")]
Graded = Annotated[Path, typer.Argument(help="The folder in which `course grade` wrote gradebook.csv.")]


@classes.command()
def feedback(
    out: Graded,
    lms: Annotated[str, typer.Option(help="The platform: moodle or canvas.")],
    exercise: Annotated[str, typer.Option(help="Only this exercise, week01_exercise.")] = "",
    section: Annotated[str, typer.Option(help="Only this section; with --roster.")] = "",
    roster: Roster = None,
) -> None:
    """Pack the reports for Moodle's or Canvas's bulk upload, as one zip per exercise."""
    from course_lib.grading.reports.report import feedback as write
    from course_lib.grading.submissions.roster import ids_of_section

    for line in write(out, lms, exercise=exercise, students=ids_of_section(roster, section)):
        typer.echo(line)


@classes.command()
def report(
    out: Graded,
    exercise: Annotated[str, typer.Option(help="The exercise of the reports, week01_exercise.")],
    final: Annotated[
        bool, typer.Option(help="Show hidden checks, as marks are final; --no-final hides them again.")
    ] = True,
) -> None:
    """Write the reports of an exercise again, with its hidden checks."""
    from course_lib.grading.reports.report import show_hidden_checks

    typer.echo(show_hidden_checks(out, exercise, is_final=final))


@classes.command()
def gradescope(
    week: Annotated[str, typer.Argument(help="A week like week01.")],
    out: Annotated[Path, typer.Option(help="The zip to upload to Gradescope.")] = Path("autograder.zip"),
    roster: Roster = None,
    hidden: Annotated[
        str, typer.Option(help="When students see hidden checks: after_published, after_due_date, hidden.")
    ] = "after_published",
    show_total: Annotated[
        bool,
        typer.Option("--show-total", help="Show the total at an upload, although it reveals hidden checks."),
    ] = False,
    run: Annotated[Path | None, typer.Option(help="Grade the submission in Gradescope's folder.")] = None,
    require_sandbox: RequireSandbox = False,
    trust: Trust = False,
) -> None:
    """Write an autograder for one week, for Gradescope."""
    from course_lib.grading.platforms.gradescope import grade_upload, write_autograder

    need: Need = "full" if require_sandbox else "any" if trust else "partial"
    if run is not None:
        typer.echo(f"Wrote {grade_upload(week, run, hidden=hidden, need=need, show_total=show_total)}")
        return
    for line in write_autograder(week, out, hidden=hidden, need=need, roster=roster, show_total=show_total):
        typer.echo(line)


@classes.command()
def classroom(
    copy: Annotated[
        Path | None, typer.Argument(help="The students' copy, which gets a workflow of GitHub Actions.")
    ] = None,
    clones: Annotated[Path | None, typer.Option(help="The clones of students' repositories.")] = None,
    roster: Roster = None,
    pushes: Annotated[Path | None, typer.Option(help="With --clones: JSON of GitHub's activity.")] = None,
    out: Annotated[Path, typer.Option(help="With --clones: the folder for the submissions.")] = Path(
        "submissions"
    ),
    check: Annotated[Path | None, typer.Option(help="Run the public checks of changed exercises.")] = None,
) -> None:
    """Check each push to GitHub, or sort clones into submissions."""
    from course_lib.grading.platforms.classroom import check_changed, collect_clones, write_workflow

    if check is not None and copy is None and clones is None:
        raise typer.Exit(0 if check_changed(check) else NOT_PASSED)
    if clones is not None and roster is not None and copy is None and check is None:
        lines = collect_clones(clones, out, roster, pushes)
    elif copy is not None and clones is None and check is None:
        lines = write_workflow(copy)
    else:
        raise CourseError(
            "write: course classroom COPY; or: course classroom --clones DIR --roster roster.csv "
            "--pushes pushes.json --out submissions"
        )
    for line in lines:
        typer.echo(line)
    raise typer.Exit(NOT_PASSED if any(line.startswith("rejected") for line in lines) else 0)


# Commands that run or store submissions, for which they fork processes.
_FORKING = {"check", "classroom", "collect", "grade", "mark", "verify"}

staff = typer.Typer()
staff.add_typer(authors)
staff.add_typer(classes)


@staff.command()
def collect(
    source: Annotated[Path, typer.Argument(help="The folder or zip downloaded from the learning platform.")],
    out: Annotated[Path, typer.Option(help="The folder for the submissions, with one folder per student.")],
    roster: Annotated[
        Path | None, typer.Option(help="The platform's CSV, which contains the students' IDs.")
    ] = None,
    id_column: Annotated[
        str, typer.Option(help="The heading of the IDs in --roster; default: detected by its content.")
    ] = "",
    times: Annotated[
        list[Path] | None,
        typer.Option(help="Further times of submission: a CSV, or JSON of Canvas's API; can be repeated."),
    ] = None,
    time_zone: Annotated[
        str, typer.Option(help="The time zone of the platform's times; default: the course's time zone.")
    ] = "",
    exercise: Annotated[
        str,
        typer.Option(help="The exercise to collect, week01_exercise; default: the only one in the download."),
    ] = "",
    layout: Annotated[
        str,
        typer.Option(
            help="The layout of the download's names; default: detected by the names. See the guide."
        ),
    ] = "",
) -> None:
    """Sort the download of a learning platform into submissions; unsafe files are rejected one by one."""
    from course_lib.course.course_file import find_zone, shipped_course_file
    from course_lib.course.material import reject_other_course
    from course_lib.grading.submissions.collect import collect as sort

    reject_other_course()
    course = shipped_course_file()
    zone = find_zone(time_zone) if time_zone else course.zone
    collection = sort(source, out, zone, roster, id_column, times or (), exercise=exercise, layout=layout)
    if course.zone_note and not time_zone:
        typer.echo(course.zone_note)
    for line in (
        *collection.rejected_lines,
        *collection.set_aside,
        *sorted(collection.notes),
        collection.summary(out),
    ):
        typer.echo(line)
    raise typer.Exit(NOT_PASSED if collection.rejected_lines else 0)


@staff.command()
def grade(
    submissions: Annotated[Path, typer.Argument(help="The folder with the submissions.")],
    out: Annotated[Path, typer.Option(help="The folder for results, gradebook and reports.")],
    jobs: Annotated[
        int | None, typer.Option(min=1, help="Number of submissions that run in parallel.")
    ] = None,
    only: Annotated[str, typer.Option(help="A pattern of the submissions to grade, like 'ada/*'.")] = "*",
    resume: Annotated[
        bool, typer.Option("--resume", help="Skip submissions that are already graded.")
    ] = False,
    rejudge: Annotated[
        bool, typer.Option("--rejudge", help="Judge stored evidence again, without running anything.")
    ] = False,
    dask: Annotated[str | None, typer.Option(help="Run on the workers of this Dask scheduler.")] = None,
    require_sandbox: RequireSandbox = False,
    trust: Trust = False,
) -> None:
    """Grade a folder of submissions: results, gradebook.csv and one report per student."""
    from course_lib.grading.grade import grade as grade_all
    from course_lib.grading.grade import second_interrupt_ends_process

    need: Need = "full" if require_sandbox else "any" if trust else "partial"
    with second_interrupt_ends_process():
        passed = grade_all(
            submissions, out, jobs=jobs, dask=dask, only=only, resume=resume, rejudge=rejudge, need=need
        )
    raise typer.Exit(0 if passed else NOT_PASSED)


@staff.command()
def mark(
    out: Annotated[Path, typer.Argument(help="The folder in which `course grade` wrote gradebook.csv.")],
    given: Annotated[
        list[str] | None,
        typer.Argument(metavar="[STUDENT EXERCISE TASK POINTS]", help="Points entered manually."),
    ] = None,
    row: Annotated[str, typer.Option(help="A row of the rubric: its number, or its first words.")] = "",
    comment: Annotated[str, typer.Option(help="A comment in the student's report.")] = "",
    withdraw: Annotated[
        bool, typer.Option("--withdraw", help="Withdraw the manual points of STUDENT EXERCISE TASK.")
    ] = False,
    without_file: Annotated[
        bool,
        typer.Option(
            "--without-file",
            help="Enter points for a whole exercise: for paper, an oral exam or a rejected file.",
        ),
    ] = False,
    lms: Annotated[
        Path | None, typer.Option(help="The CSV to fill, as exported by Canvas, Moodle or another platform.")
    ] = None,
    exercise: Annotated[
        str, typer.Option(help="With --lms: the exercise of the marks, week01_exercise.")
    ] = "",
    column: Annotated[str, typer.Option(help="With --lms: the heading of the column to fill.")] = "",
    id_column: Annotated[str, typer.Option(help="With --lms: the heading of the students' IDs.")] = "",
    to: Annotated[
        Path | None, typer.Option(help="With --lms: the file to write; its other columns are unchanged.")
    ] = None,
    raw: Annotated[bool, typer.Option("--raw", help="Fill in the scores before the late policy.")] = False,
    cap: Annotated[
        bool, typer.Option("--cap", help="Limit marks to the platform's maximum, if it rejects a bonus.")
    ] = False,
    comment_column: Annotated[
        str, typer.Option(help='With --lms: the heading for comments, "Feedback comments" of Moodle.')
    ] = "",
    section: Annotated[str, typer.Option(help="With --lms and --roster: only rows of this section.")] = "",
    roster: Annotated[
        Path | None, typer.Option(help="With --section: the class list: id,name,email,section,group,login.")
    ] = None,
    serve: Annotated[bool, typer.Option("--serve", help="Mark in the browser, on this machine.")] = False,
    port: Annotated[int | None, typer.Option(min=0, help="With --serve: the port.")] = None,
    browser: Annotated[bool, typer.Option(help="With --serve: open the page.")] = True,
) -> None:
    """Enter points by hand, which later grading keeps, or fill a column of a platform's CSV."""
    if serve and lms is None and not given:
        from course_lib.grading.marking.server import serve as serve_page

        serve_page(out, port=port, browser=browser)
        return
    if lms is not None and not given:
        from course_lib.grading.submissions.lms import fill_lms, require_options
        from course_lib.grading.submissions.roster import ids_of_section

        names = {"exercise": exercise, "column": column, "id_column": id_column}
        require_options(lms, {**names, "to": to})
        assert to is not None
        students = ids_of_section(roster, section)
        lines = fill_lms(
            out, lms, to, **names, raw=raw, cap=cap, comment_column=comment_column, students=students
        )
    else:
        is_lms = lms is not None and not without_file
        about = (given or (), row, comment)
        lines = [_mark(out, *about, withdraw=withdraw, without_file=without_file, is_lms=is_lms)]
    for line in lines:
        typer.echo(line)


def _mark(
    out: Path,
    given: Sequence[str],
    row: str,
    comment: str,
    *,
    withdraw: bool,
    without_file: bool,
    is_lms: bool,
) -> str:
    """Store the points of `course mark`, and return the line to print.

    Without points, update reports and gradebook from the stored marks.
    """
    from course_lib.grading.marking.by_hand import mark_by_hand, mark_without_file, update_reports

    if without_file:
        if row or len(given) != len(("STUDENT", "EXERCISE")) + (not withdraw):
            raise CourseError(
                "write: course mark OUT STUDENT EXERCISE POINTS --without-file [--comment TEXT]; "
                "or: course mark OUT STUDENT EXERCISE --without-file --withdraw"
            )
        return mark_without_file(out, *given, comment=comment, withdraw=withdraw)
    if not is_lms and not (given or row or comment or withdraw):
        return update_reports(out, waiting=typer.echo)
    if not is_lms and withdraw and not comment and len(given) == len(("STUDENT", "EXERCISE", "TASK")):
        return mark_by_hand(out, *given, row=row, withdraw=True)
    if not is_lms and not withdraw and len(given) == len(("STUDENT", "EXERCISE", "TASK", "POINTS")):
        return mark_by_hand(out, *given, row=row, comment=comment)
    raise CourseError(
        "write: course mark OUT --serve; or: course mark OUT STUDENT EXERCISE TASK POINTS [--row "
        "ROW] [--comment TEXT]; or: course mark OUT STUDENT EXERCISE TASK --withdraw [--row ROW]; "
        "or: course mark OUT --lms CSV --exercise E --column C --id-column I --to CSV"
    )


# Limit in robot time [s] for runs that another condition ends.
LONG = 1e6

app = typer.Typer(
    no_args_is_help=True, rich_markup_mode=None, add_completion=False, pretty_exceptions_enable=False
)
bag = typer.Typer(help="Inspect recordings.", rich_markup_mode=None)
app.add_typer(bag, name="bag")
app.add_typer(staff)
app.add_typer(robots)

ShowArgs = Annotated[bool, typer.Option("--show-args", help="Only list a launch file's arguments.")]
Browser = Annotated[bool, typer.Option(help="Open a browser.")]
Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")]


def _print_version(is_requested: bool) -> None:
    if is_requested:
        from importlib.metadata import version

        typer.echo(f"course_lib {version('course_lib')}, Python {sys.version.split()[0]}")
        raise typer.Exit


Version = Annotated[
    bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Show the version.")
]


@app.callback()
def course(context: typer.Context, debug: Debug = False, version: Version = False) -> None:
    """Learn robot visualization and ROS 2 tooling in JupyterLab, installed by pip alone."""
    command = context.invoked_subcommand or ""
    if command in _FORKING and not hasattr(os, "fork"):
        # Native Windows.
        instead = " In the exercise itself check() works without." if command == "check" else ""
        raise CourseError(
            f"course {command} needs Linux, macOS or WSL2: on this system ({sys.platform}) a "
            f"process can't fork.{instead}"
        )


@app.command()
def lab(
    work_dir: Annotated[Path, typer.Argument(help="Your folder; created if it is missing.")] = Path(
        "my_course"
    ),
    port: Annotated[int | None, typer.Option(help="The port to listen on.")] = None,
    browser: Browser = True,
    server: Annotated[bool, typer.Option(help="Start JupyterLab; otherwise only write the folder.")] = True,
) -> None:
    """Open JupyterLab on your course folder."""
    from course_lib.course.lab import lab as open_lab

    open_lab(work_dir, port=port, browser=browser, serves=server)


@app.command()
def demo(
    out: Annotated[Path, typer.Option(help="The folder for the picture and the page.")] = Path("course_demo"),
) -> None:
    """Demonstrate the kit in 20 seconds, without a browser."""
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
        float | None,
        typer.Option(min=0, help="Robot time to run [s]; default: 5, and no limit for notebooks."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of all random number generators.")] = 0,
    bag: Annotated[Path | None, typer.Option(help="Record everything into this new folder.")] = None,
    params_file: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="A YAML file with parameters of the nodes."),
    ] = None,
    real_time: Annotated[
        bool, typer.Option("--real-time", help="Run at the speed of the wall clock.")
    ] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="End a launch that contains unsupported parts.")
    ] = False,
    show_args: ShowArgs = False,
    robot: Robot = None,
    domain: Domain = None,
    send: Send = None,
    call: Call = None,
    ros: Annotated[bool, typer.Option("--ros", help="Run on the real rclpy: see course ros.")] = False,
    view: Annotated[
        bool | None,
        typer.Option(
            "--view/--no-view", help="With --ros: show the run in a browser; default: only without --seconds."
        ),
    ] = None,
) -> None:
    """Run programs in robot time, or with a robot. Arguments after `--` are for the programs."""
    if ros:
        from course_lib.real.process import run_on_ros

        if robot is not None or real_time or show_args or strict or seed or params_file:
            raise CourseError(
                "--ros runs programs on the real ROS 2 of this computer, in real time: leave out "
                "--robot, --seed, --params-file, --real-time, --strict and --show-args."
            )
        shows = seconds is None if view is None else view
        raise typer.Exit(run_on_ros(files, seconds=seconds, bag=bag, arguments=context.obj, shows=shows))
    if view is not None:
        raise CourseError("--view and --no-view need --ros. To view a recording, use: course view --bag DIR")
    if show_args:
        from course_lib.tools.run import show_arguments

        typer.echo(show_arguments([file for file in files if ":=" not in str(file)]))
        return
    code = usual_commands.run(
        files,
        context.obj,
        seconds=seconds,
        seed=seed,
        bag=bag,
        params_file=params_file,
        real_time=real_time,
        robot=address(robot, domain, send, call),
        is_strict=strict,
    )
    raise typer.Exit(code)


@app.command(context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
def ros2(
    words: Annotated[list[str] | None, typer.Argument(help="The arguments of `ros2`: topic list -t")] = None,
    run: Annotated[list[Path] | None, typer.Option(help="A program to run; can be repeated.")] = None,
    bag: Annotated[Path | None, typer.Option(help="A recording to use instead.")] = None,
    seconds: Annotated[
        float | None,
        typer.Option(min=0, help="Robot time to run [s]; default: 5, and no limit with a robot."),
    ] = None,
    robot: Robot = None,
    domain: Domain = None,
    send: Send = None,
    call: Call = None,
) -> None:
    """Run a `ros2` command on programs, a recording or a robot; options of `course` come first."""
    to = address(robot, domain, send, call)
    code = usual_commands.ros2(words or [], files=run or [], bag=bag, seconds=seconds, robot=to)
    raise typer.Exit(code)


def _find_packages_of(layout: Path | None) -> None:
    """Let `package://` find the packages of the layout's workspace from any working folder."""
    from course_lib.ros.programs.packages import source

    if layout is not None and layout.is_file():
        source(layout)


@app.command()
def render(
    bag: Annotated[Path, typer.Option(help="The recording to draw.")],
    rviz: Annotated[Path | None, typer.Option(help="The layout of the picture.")] = None,
    at: Annotated[
        float | None,
        typer.Option(help="Time after the first message [s]; default: the end of the recording."),
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
            raise CourseError(f"{file} has the wrong suffix; call it {file.with_suffix(kind).name}.")
    if (png is None) == (html is None):
        raise CourseError("Choose the output: --png picture.png or --html page.html.")
    _find_packages_of(rviz)
    typer.echo(render_bag(bag, rviz=rviz, at=at, size=(int(width), int(height)), png=png, html=html))


@app.command()
def view(
    bag: Annotated[Path | None, typer.Option(help="The recording to play.")] = None,
    rviz: Annotated[Path | None, typer.Option(help="The layout of the view.")] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="The port; 0: any free port.")] = 0,
    token: Annotated[
        str | None, typer.Option(help="The secret part of the address; default: random.")
    ] = None,
    browser: Browser = True,
    robot: Robot = None,
    domain: Domain = None,
    send: Send = None,
    use_sim_time: Annotated[bool, typer.Option(help="Follow the robot's /clock.")] = False,
) -> None:
    """Show a layout in a browser tab, by itself or with a recording or a robot."""
    from course_lib.displays import render

    to = address(robot, domain, send, None)
    _find_packages_of(rviz)
    if to is None and not use_sim_time:
        render.view(bag, rviz, port=port, token=token, browser=browser)
    # --use-sim-time uses the /clock of a robot.
    elif to is None or bag is not None:
        raise CourseError(
            "Nothing to display: add --bag folder, or --robot dds/HOST. --use-sim-time needs one, too."
        )
    else:
        render.view_robot(to, rviz, port=port, token=token, browser=browser, use_sim_time=use_sim_time)


@bag.command()
def info(folder: Annotated[Path, typer.Argument(help="The recording's folder.")]) -> None:
    """Show the content of a recording."""
    from course_lib.recording import bag_info

    typer.echo(bag_info(folder))


@bag.command(context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
def play(
    words: Annotated[
        list[str], typer.Argument(help="The recording's folder, then the options of `ros2 bag play`.")
    ],
    run: Annotated[
        list[Path] | None, typer.Option(help="A program that subscribes; can be repeated.")
    ] = None,
) -> None:
    """Play a recording to programs, and end them when it ends."""
    from course_lib.tools.run import ros2_over

    nobody = None if run else Path(words[0])
    raise typer.Exit(ros2_over(["bag", "play", *words], files=run or [], bag=nobody, seconds=LONG))


@app.command()
def check(
    file: Annotated[Path, typer.Argument(help="Your exercise notebook.")],
    ros: Annotated[
        bool, typer.Option("--ros", help="Check the messages that the nodes publish on the real rclpy.")
    ] = False,
) -> None:
    """Run the public checks of an exercise."""
    if ros:
        from course_lib.real.check import check_on_ros

        raise typer.Exit(0 if check_on_ros(file) else NOT_PASSED)
    from course_lib.grading.check_file import check_file

    raise typer.Exit(0 if check_file(file) else NOT_PASSED)


@app.command()
def ros(
    installs: Annotated[
        bool, typer.Option("--install", help="Install it into your data folder, separately from the course.")
    ] = False,
) -> None:
    """Show or install the real rclpy, on which run --ros and check --ros run your programs."""
    from course_lib.real import environment

    if installs:
        from course_lib.ros.time.interrupts import exit_at_signals

        # Without this, pip would continue after the terminal was closed.
        exit_at_signals()
        environment.install(typer.echo)
    else:
        installed = environment.find_environment()
        typer.echo(f"{installed} is in {installed.folder}. Run a program on it: course run my_node.py --ros")


@app.command()
def submit(
    file: Annotated[Path, typer.Argument(help="Your exercise notebook.")],
    out: Annotated[Path | None, typer.Option(help="The path of the file to hand in.")] = None,
) -> None:
    """Pack an exercise into one file to hand in, with a receipt."""
    from course_lib.grading.submissions.submit import submit as pack

    typer.echo(pack(file, out).text())


@app.command()
def status(
    work_dir: Annotated[Path | None, typer.Argument(help="Your folder; default: ./my_course.")] = None,
) -> None:
    """Show your progress and the next step."""
    from rich.console import Console

    from course_lib.course.progress import status as look

    table, then = look(work_dir)
    Console().print(table)
    typer.echo(then)


@app.command()
def export(
    file: Annotated[Path | None, typer.Argument(help="A notebook, or a Python file.")] = None,
    package: Annotated[str, typer.Option(help="The package's name.")] = "",
    out: Annotated[Path | None, typer.Option(help="The parent folder of the package.")] = None,
    node: Annotated[
        list[str] | None, typer.Option(help="A class to start; default: all startable nodes.")
    ] = None,
    extra: Annotated[
        list[Path] | None, typer.Option("--with", help="A .rviz, .yaml, .urdf or launch file to include.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite existing files.")] = False,
    check: Annotated[Path | None, typer.Option(help="Only list the missing parts of this package.")] = None,
) -> None:
    """Export a notebook's nodes as a ROS 2 package: from the cells marked # export, or from all."""
    from course_lib.export.export import check_package
    from course_lib.export.export import export as write

    if check is not None:
        report = check_package(check)
        typer.echo("\n".join(report.lines()))
        raise typer.Exit(0 if report.is_complete else NOT_PASSED)
    if file is None or out is None or not package:
        raise CourseError("write: course export FILE --package NAME --out DIR, or: course export --check DIR")
    typer.echo(write(file, package, out, nodes=node or (), extra=extra or (), force=force))


def main() -> None:
    """Run the command line. Print an error as one line with the next step."""
    words = sys.argv[1:]
    fix_hash_seed(words)
    # The arguments of a program follow `--` or begin at `--ros-args`.
    starts = ("--", "--ros-args") if words[:1] == ["run"] else ("--",)
    place = next((at for at, word in enumerate(words) if word in starts), len(words))
    arguments, for_programs = words[:place], words[place:]
    if for_programs[:1] == ["--"]:
        del for_programs[0]
    debug = "--debug" in arguments
    try:
        code = app(args=arguments or ["--help"], obj=for_programs, standalone_mode=False, prog_name="course")
    except CourseError as error:
        _fail(str(error), debug, error.exit_code)
    # An invalid option or argument.
    except TyperException as error:
        context = getattr(error, "ctx", None)
        problem = error.format_message().rstrip(".").replace("Input should be", "expected")
        # Number of words in the command's name.
        depth = 2 if arguments[:1] == ["bag"] else 1
        command_words = ["course", *(word for word in arguments if not word.startswith("-"))][: depth + 1]
        _fail(f"{problem}. See: {context.command_path if context else ' '.join(command_words)} --help", debug)
    except OSError as error:
        # Errors of a write, as on a full disk, have no file name.
        file = f"{error.filename}: " if error.filename else ""
        _fail(f"{file}{error.strerror}. Correct this, or choose another file or folder.", debug)
    except (KeyboardInterrupt, typer.Abort):
        sys.exit(usual_commands.INTERRUPTED)
    sys.exit(code or 0)


def _fail(message: str, debug: bool, exit_code: int = usual_commands.UNUSABLE) -> NoReturn:
    if debug:
        raise
    usual_commands.fail(message, exit_code)
