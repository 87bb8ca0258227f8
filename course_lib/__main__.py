"""`python -m course_lib` is the same as `course`."""

import sys

from course_lib.usual_commands import INTERRUPTED, fix_hash_seed


def main() -> None:
    """Run the command line, with a fixed hash seed if it runs programs."""
    try:
        fix_hash_seed(sys.argv[1:])
        # Imported here because these modules take longer to import than the restart above; typer
        # takes longest.
        from course_lib.usual_commands import call, find_usual_command

        command = find_usual_command(sys.argv[1:])
        if command is not None:
            call(command)
        from course_lib.cli import main as run_command

        run_command()
    except KeyboardInterrupt:
        # Commands handle it themselves; this is Ctrl+C during the imports.
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
