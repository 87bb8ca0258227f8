"""A bag of a graph while it runs: at its end, or as it goes where a robot's images would fill the memory."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.recording.bag import check_free, write_bag
from course_lib.recording.bag_writer import BagWriter
from course_lib.recording.recording import Recording, record
from course_lib.ros.graph import Graph, Sample, Wanted
from course_lib.ros.sim_time import ticked

Chosen = Callable[[str, str], bool]  # topic, type
Stamped = Callable[[Sample], list[Sample]]


def _all(topic: str, type_name: str) -> bool:
    return True


@contextmanager
def recorded(
    graph: Graph,
    folder: Path,
    chosen: Chosen = _all,
    wanted: Wanted | None = None,
    *,
    in_sim_time: bool = False,
) -> Iterator[None]:
    """Record a graph into a bag for the length of a `with` block.

    Args:
        graph: The bag of a linked one is written as it goes; others at their end, so that equal runs give
            equal bytes.
        folder: The bag's folder.
        chosen: Selects topics.
        wanted: The topics that a robot has to send for it, in sim time /clock as well; None means all.
        in_sim_time: Whether messages get the time on /clock. Of what came before, only latched ones are kept.

    Raises:
        CourseError: The bag can't be written.
    """
    stamped = _SimTime().stamped if in_sim_time else partial(_from, graph.now_ns)
    if graph.keeps_wall_time:
        growing = _GrowingBag(graph, folder, chosen, wanted, stamped)
        try:
            yield
        finally:
            growing.close()
        return
    with record(graph) as recorder:
        yield
    samples = [one for sample in recorder.recording().samples for one in stamped(sample)]
    samples.sort(key=lambda sample: sample.stamp_ns)  # a simulation may have been reset
    write_bag(Recording(tuple(s for s in samples if chosen(s.topic, s.type_name))), folder)


def _from(start_ns: int, sample: Sample) -> list[Sample]:
    """Return a sample; what was latched before comes as the recording begins."""
    return [sample if sample.stamp_ns >= start_ns else replace(sample, stamp_ns=start_ns)]


class _SimTime:
    """Stamps samples by the last message on /clock."""

    def __init__(self) -> None:
        self._now_ns: int | None = None
        self._latched: list[Sample] = []  # before the first message on /clock

    def stamped(self, sample: Sample) -> list[Sample]:
        """Return the samples that can be stamped now that one more has come."""
        time_ns = ticked(sample)
        self._now_ns = self._now_ns if time_ns is None else time_ns
        if self._now_ns is None:
            self._latched += [sample] if sample.qos.durability == "transient_local" else []
            return []
        ready, self._latched = [*self._latched, sample], []
        return [replace(one, stamp_ns=self._now_ns) for one in ready]


class _GrowingBag:
    """A bag that is written as messages come; what can't be written ends it, and is told at the end."""

    def __init__(
        self, graph: Graph, folder: Path, chosen: Chosen, wanted: Wanted | None, stamped: Stamped
    ) -> None:
        check_free(folder.absolute(), force=False)
        self._folder, self._chosen, self._stamped = folder, chosen, stamped
        self._known = dict[tuple[str, str], bool]()  # topic and type -> whether it is recorded
        self._problem: CourseError | None = None
        try:
            folder.absolute().parent.mkdir(parents=True, exist_ok=True)
            if folder.exists():
                folder.rmdir()  # an empty one; the writer makes its own
            self._writer = BagWriter(folder)
        except OSError as error:
            raise self._told(error) from error
        for sample in graph.latched():
            self._hear(sample)
        self._untap = graph.tap(self._hear, wanted)

    def close(self) -> None:
        """Complete the bag; raises a CourseError if it could not be written."""
        self._untap()
        if self._problem is None:
            try:
                self._writer.close()
            except OSError as error:
                self._problem = self._told(error)
        if self._problem is not None:
            raise self._problem

    def _hear(self, sample: Sample) -> None:
        for one in self._stamped(sample):
            self._take(one)

    def _take(self, sample: Sample) -> None:
        if self._problem is not None:
            return
        name = sample.topic, sample.type_name
        try:
            if name not in self._known:
                self._known[name] = self._chosen(*name)
                if self._known[name]:
                    self._writer.add(*name, [sample.qos])
            if self._known[name]:
                self._writer.write(*name, sample.stamp_ns, sample.cdr)
        except OSError as error:
            self._problem = self._told(error)
            self._writer.abort()

    def _told(self, error: OSError) -> CourseError:
        return CourseError(f"Can't write the bag {self._folder}: {error.strerror}. Choose another folder.")
