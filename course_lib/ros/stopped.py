"""What ends a thread that goes on waiting after the end of the run."""


class StoppedProgram(KeyboardInterrupt):
    """Ends a program's main thread."""


class StoppedThread(SystemExit):
    """Ends another thread, without a word."""
