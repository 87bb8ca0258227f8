"""IPython without a kernel: runs a notebook's cells in this process."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell


def make_shell() -> "InteractiveShell":
    """An IPython shell without history, colours or a page."""
    from IPython.core.displayhook import DisplayHook
    from IPython.core.interactiveshell import InteractiveShell
    from traitlets.config import Config

    class Quiet(DisplayHook):
        def write_output_prompt(self) -> None:
            """Results stand alone, without `Out[1]:`."""

    class Shell(InteractiveShell):
        displayhook_class = Quiet

        def enable_gui(self, gui: Any = None) -> None:
            """There is no window to be had; `%matplotlib inline` is no mistake."""

    config = Config()
    config.HistoryManager.enabled = False
    config.InteractiveShell.colors = "nocolor"
    InteractiveShell.clear_instance()  # that of another notebook in this process
    return Shell.instance(config=config)
