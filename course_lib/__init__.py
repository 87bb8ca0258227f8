"""Learn robot visualization and ROS 2 tooling in JupyterLab, with nothing but pip.

In a notebook: `%load_ext course_lib`, then plain ROS 2 code. The names that every lesson uses are
here, those of one subject in `course_lib.displays`, `robots`, `sensors`, `grading` and `export`; each
is loaded when it is first used. Importing any of these modules puts the kit's own ROS packages first on
`sys.path`.
"""

from typing import TYPE_CHECKING

import lazy_loader

from course_lib.ros import standin_path

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

standin_path.install()
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def load_ipython_extension(shell: "InteractiveShell") -> None:
    """Prepare a kernel; IPython calls this on `%load_ext course_lib`."""
    from course_lib.extension import load

    load(shell)
