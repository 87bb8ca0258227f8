"""A worker in the jail, with a channel and its printed text."""

import os
import threading
from collections.abc import Sequence
from select import select

from course_lib.course.course_file import Limits
from course_lib.grading.jail.launch import PIPE_HOLDS, START_SECONDS, TemplateProcess, WorkerError
from course_lib.grading.run.outcome import Usage
from course_lib.grading.run.waiting import Waiting
from course_lib.ros import wall
from course_lib.ros.channel import Channel, ChannelError

HEAVY = {  # what takes long to import, by the word that tells who needs it
    "matplotlib": "matplotlib.pyplot",
    "%matplotlib": "matplotlib_inline.backend_inline",
    "pinocchio": "pinocchio",
}


class WorkerProcess:
    """A worker in the jail, from its start until `close`.

    Args:
        template: What it is a fork of.
        limits: What it may use.
        cells: What it will run.

    Raises:
        WorkerError: It can't be put into the jail.
    """

    def __init__(self, template: TemplateProcess, limits: Limits, cells: Sequence[str]) -> None:
        self._template = template
        self.usage = Usage()  # known once it is closed
        imports = [module for word, module in HEAVY.items() if any(word in cell for cell in cells)]
        connection, output = template.start(limits, imports)
        self.channel = Channel(connection)
        self._output = Output(output, round(limits.output_kilobytes * 1000))
        self.waiting = Waiting(template.pid, limits.cell_seconds)  # its start counts, too
        self.channel.overtime = self.waiting.grow
        self.allow(START_SECONDS)
        try:
            problem = self.channel.receive()[1:]
        except ChannelError as error:
            problem = [str(error)]
        if problem != [""]:
            said = self.take_output()
            self.close()
            raise WorkerError(f"a worker can't be put into the jail: {problem} {said}")

    def allow(self, seconds: float) -> None:
        """Set the time [s] in which the worker must answer; what it waits for a processor does not count."""
        self.channel.deadline = wall.monotonic() + seconds

    def take_output(self) -> str:
        """Return the text printed since the last call."""
        return self._output.take()

    def close(self) -> None:
        """End the worker with all that it has started; its scratch folder is gone then."""
        self.usage = self._template.stop()
        self.channel.close()
        self._output.close()


class Output:
    """The text in a pipe, read continuously so that a flood can't block; the start of each step is kept."""

    def __init__(self, pipe: int, limit: int) -> None:
        self._pipe, self._limit = pipe, limit
        self._kept, self._cut, self._over = bytearray(), False, False
        self._lock = threading.Lock()
        os.set_blocking(pipe, False)
        self._reader = threading.Thread(target=self._read_on, daemon=True)
        self._reader.start()

    def take(self) -> str:
        """Return the text of the step that has just ended, including the part that is still in the pipe."""
        with self._lock:
            self._read()
            text = bytes(self._kept).decode("utf-8", "replace")
            text += f"\n… cut after {self._limit} bytes" if self._cut else ""
            self._kept, self._cut = bytearray(), False
        return text

    def close(self) -> None:
        """Stop reading; the process is dead."""
        self._over = True
        self._reader.join()
        os.close(self._pipe)

    def _read_on(self) -> None:
        while not self._over:
            if select([self._pipe], [], [], 0.1)[0]:
                with self._lock:
                    self._over = self._read() == 0 or self._over

    def _read(self) -> int | None:
        """Return the number of bytes read; 0 at the end of the pipe, None if there are none now."""
        try:
            chunk = os.read(self._pipe, PIPE_HOLDS)
        except BlockingIOError:
            return None
        room = max(self._limit - len(self._kept), 0)
        self._kept += chunk[:room]
        self._cut = self._cut or len(chunk) > room
        return len(chunk)
