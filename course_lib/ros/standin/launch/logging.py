"""Loggers for launch files, which write lines in launch's format: `[INFO] [name]: text`."""

import logging
import sys

# The name of launch's own logger.
_MAIN = "launch"


class _StdoutHandler(logging.Handler):
    """Writes to the current value of `sys.stdout`."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write a log record as one line."""
        name = record.name.removeprefix(f"{_MAIN}.")
        sys.stdout.write(f"[{record.levelname}] [{name}]: {record.getMessage()}\n")


def get_logger(name: str | None = None) -> logging.Logger:
    """Return the logger with this name; default: launch's own logger."""
    logger = logging.getLogger(_MAIN if name is None else f"{_MAIN}.{name}")
    main = logging.getLogger(_MAIN)
    if not main.handlers:
        main.addHandler(_StdoutHandler())
        main.propagate = False
        main.setLevel(logging.INFO)
    return logger
