"""Code that IPython runs at the start of each kernel of `course lab`; PYTHONSTARTUP is its path.

Until a notebook's first cell has loaded the kit, an undefined name, magic or module of ROS is most
often a cell that was run too early, and the kit's own hints are not there yet. `%load_ext
course_lib` replaces this handler.
"""


def _watch_for_early_cells() -> None:
    import re
    import sys
    from types import TracebackType
    from typing import Any

    from IPython.core.error import UsageError
    from IPython.core.getipython import get_ipython

    shell = get_ipython()
    hint = (
        "run the cells above first, beginning with the first one, %load_ext course_lib "
        "(Run → Run All Above Selected Cell). Faster after a restart: write "
        "`from course_lib import resume; resume()` above this cell's first line."
    )
    ros_names = re.compile(
        r"(rclpy|rosbag2|ros2|tf2|launch|ament|builtin_interfaces|message_filters)|\w+_(msgs|srvs|interfaces)\b"
    )
    resume_hint = "write `from course_lib import resume` above it and run this cell again."

    def show(
        shell: Any,
        kind: type[BaseException],
        error: BaseException,
        trace: TracebackType,
        tb_offset: int | None = None,
    ) -> None:
        is_early = not isinstance(error, ModuleNotFoundError) or ros_names.match(error.name or "")
        if isinstance(error, UsageError):
            shell.show_usage_error(error)
            print(f"hint: {hint}", file=sys.stderr)  # noqa: T201  where IPython prints the error
        else:
            is_resume = isinstance(error, NameError) and error.name == "resume"
            if is_early:
                error.add_note(f"hint: {resume_hint if is_resume else hint}")
            shell.showtraceback((kind, error, trace), tb_offset=tb_offset)

    if shell is not None:
        shell.set_custom_exc((NameError, UsageError, ModuleNotFoundError), show)


# A plain Python in a terminal of JupyterLab runs this file, too.
if "get_ipython" in globals():
    _watch_for_early_cells()
del _watch_for_early_cells
