"""`python -m course_lib` is the same as `course`."""

import os
import signal
import sys
from io import TextIOWrapper

from course_lib.usual_commands import HASH_SEED, INTERRUPTED, fix_hash_seed


def main() -> None:
    """Run the command line, with a fixed hash seed if it runs programs."""
    try:
        if os.environ.get("PYTHONHASHSEED") == HASH_SEED and os.name == "posix":
            # SIGINT was blocked during the restart, and is pending if it was sent.
            signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        fix_hash_seed(sys.argv[1:])
        # Where the output is not UTF-8, as in a file on Windows, a name must not end the command.
        if isinstance(sys.stdout, TextIOWrapper) and sys.stdout.encoding.lower() != "utf-8":
            sys.stdout.reconfigure(errors="replace")
        # Imported here because these modules take longer to import than the restart above; typer
        # takes longest.
        from course_lib.usual_commands import call, find_usual_command

        command = find_usual_command(sys.argv[1:])
        if command is not None:
            call(command)
        from course_lib.cli import main as run_command

        run_command()
    except KeyboardInterrupt:
        # Commands handle Ctrl+C themselves, so it was pressed during the imports.
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
