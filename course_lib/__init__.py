"""Learn robot visualization and ROS 2 tooling in JupyterLab, with nothing but pip.

In a notebook, use `%load_ext course_lib` and then plain ROS 2 code. This module contains the names
that all lessons use; other names are in `course_lib.displays`, `robots`, `sensors`, `grading` and
`export`. Each is loaded when it is first used. Importing any of these modules puts the kit's own
ROS packages first on `sys.path`.
"""

from typing import TYPE_CHECKING

import lazy_loader

from course_lib.ros.programs import import_path

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

import_path.install()
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def load_ipython_extension(shell: "InteractiveShell") -> None:
    """Prepare a kernel. IPython calls this on `%load_ext course_lib`."""
    from course_lib.extension import load

    load(shell)
