"""Loggers of launch files, which write as launch does: `[INFO] [name]: text`."""

import logging
import sys

_MAIN = "launch"  # the logger of launch itself


class _Shown(logging.Handler):
    """Writes to what is standard output at the time."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write one line."""
        name = record.name.removeprefix(f"{_MAIN}.")
        sys.stdout.write(f"[{record.levelname}] [{name}]: {record.getMessage()}\n")


def get_logger(name: str | None = None) -> logging.Logger:
    """Return the logger of a name, by default that of launch."""
    logger = logging.getLogger(_MAIN if name is None else f"{_MAIN}.{name}")
    main = logging.getLogger(_MAIN)
    if not main.handlers:
        main.addHandler(_Shown())
        main.propagate = False
        main.setLevel(logging.INFO)
    return logger
